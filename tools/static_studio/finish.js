/** Finish: what the network painted at the drawing's size and place, as normalgan.painting does it in Python. */

import { Unpaintable, shrunk } from "./prepare.js";
import { boxOf, distance, extreme, part, quantile, resized, thicker, where } from "./raster.js";

/** @typedef {import("./prepare.js").Prepared} Prepared @typedef {import("./prepare.js").Frame} Frame */

const [PRESENT, LEAST, CLOSED] = [0.6, 0.02, 0.8];
const [BARRIER, FINEST, INK, ENLARGED] = [6, 3, 0.35, 1.2];
const SWEEPS = 6;

/**
 * Returns normals, x, y, z for each pixel, the mask, and what is to be said of it.
 * @param {Prepared} prepared
 * @param {Float32Array} painted three planes, vectors as long as an object is probable
 * @param {Int8Array | null} [hand] 1 where a hand has added to the object, -1 where it has cut
 */
export function finish(prepared, painted, hand = null) {
  const { width, height, frame } = prepared;
  const area = frame.size ** 2;
  const [normals, length] = [new Float32Array(3 * area), new Float32Array(area)];
  for (let i = 0; i < area; i++) {
    const vector = [painted[i], painted[area + i], painted[2 * area + i]];
    length[i] = Math.hypot(...vector);
    if (length[i] > 1e-8) normals.set(vector.map((value) => value / length[i]), 3 * i);
  }
  const present = where(restored(length, prepared, 1), (value) => value > 0.5);
  const { mask: found, said } = chosen(prepared, present);
  // The hand has the last word.
  const mask = hand ? found.map((value, i) => (hand[i] ? (hand[i] > 0 ? 1 : 0) : value)) : found;
  const inside = sum(mask);
  const share = sum(mask.map((value, i) => value & present[i])) / Math.max(inside, 1);
  const warnings = said && !hand ? [said] : [];
  if (share < PRESENT) warnings.push(`the model takes only ${Math.round(100 * share)}% of its mask for an object and is unsure of the rest`);
  const needed = where(shrunk(mask, width, height, frame), (value) => value > 0);
  const usual = quantile(length.filter((_, i) => needed[i] > 0), 0.95) || 0;
  const least = Math.max(0.1 * usual, LEAST);
  const known = where(length, (value, i) => value > 0.5 || (needed[i] > 0 && value > least));
  if (!known.some(Boolean)) throw new Unpaintable("the model sees no object in it; draw its outline, or crop other things away.");
  if (!inside) throw new Unpaintable("its mask is empty; draw the outline of an object.");
  const coarse = known.every(Boolean) ? normals : extended(normals, known, needed, frame.size);
  const out = restored(coarse, prepared, 3);
  if (frame.side > ENLARGED * frame.size) sharpen(out, known, prepared, mask);
  for (let i = 0; i < out.length; i += 3) {
    const size = Math.hypot(out[i], out[i + 1], out[i + 2]);
    if (size > 1e-8) for (let c = 0; c < 3; c++) out[i + c] /= size;
    else out.set([0, 0, 1], i);
  }
  return { normals: out, mask, warning: warnings.join("; ") };
}

/** @param {Uint8Array} values */
const sum = (values) => values.reduce((total, value) => total + value, 0);

/** Returns the mask and what is to be said of it. @param {Prepared} prepared @param {Uint8Array} present */
function chosen({ mask, closed, guessed }, present) {
  if (!mask) return { mask: present, said: "" };
  if (closed >= CLOSED) return { mask, said: guessed ? "its outline has a wide gap, which was closed by a straight line; draw on there, or choose another Object above, if the object goes on" : "" };
  return {
    mask: mask.map((value, i) => value | present[i]),
    said: `its outline is not closed, only ${Math.round(100 * closed)}% of its lines enclose anything; where they do not, the mask is the model's guess (close the gaps, or choose another Object above)`,
  };
}

/** Brings a square of the network to the drawing's place and size. @param {Float32Array} square @param {Prepared} prepared @param {number} channels */
function restored(square, { width, height, frame: { left, top, side, size } }, channels) {
  const scale = side / size;
  const out = new Float32Array(width * height * channels);
  const ways = [{ count: width, start: left }, { count: height, start: top }].map(({ count, start }) =>
    Float32Array.from({ length: count }, (_, i) => (i - start - (scale - 1) / 2) / scale));
  for (let y = 0; y < height; y++) {
    const row = Math.floor(ways[1][y]);
    const down = ways[1][y] - row;
    for (let x = 0; x < width; x++) {
      const column = Math.floor(ways[0][x]);
      if (row < -1 || column < -1 || row >= size || column >= size) continue;
      const right = ways[0][x] - column;
      for (let c = 0; c < channels; c++) {
        let value = 0;
        for (const [dy, share] of [[0, 1 - down], [1, down]]) {
          if (row + dy < 0 || row + dy >= size) continue;
          const at = ((row + dy) * size + column) * channels + c;
          if (column >= 0) value += share * (1 - right) * square[at];
          if (column + 1 < size) value += share * right * square[at + channels];
        }
        out[(y * width + x) * channels + c] = value;
      }
    }
  }
  return out;
}

/**
 * Returns unit normals everywhere: those known, and a near harmonic extension of them (Gortler et al. 1996, 3.3).
 * @param {Float32Array} normals @param {Uint8Array} known @param {Uint8Array} needed @param {number} size
 */
function extended(normals, known, needed, size) {
  const sweeps = needed.some((value, i) => value && !known[i]) ? SWEEPS : 0;
  const first = new Float32Array(4 * size * size);
  for (let i = 0; i < known.length; i++) if (known[i]) first.set([normals[3 * i], normals[3 * i + 1], normals[3 * i + 2], 1], 4 * i);
  const levels = [{ values: first, side: size }];
  for (let side = size; side > 1;) {
    const half = (side + 1) >> 1;
    levels.push({ values: resized(levels[levels.length - 1].values, side, side, half, half, 4), side: half });
    side = half;
  }
  const last = levels.pop() ?? levels[0];
  let coarse = Float32Array.from([0, 1, 2], (c) => last.values[c] / Math.max(last.values[3], 1e-12));
  let before = 1;
  for (const { values, side } of levels.reverse()) {
    coarse = resized(coarse, before, before, side, side, 3);
    const [kept, free] = [new Float32Array(3 * side * side), new Float32Array(side * side)];
    for (let i = 0; i < free.length; i++) {
      const weight = values[4 * i + 3];
      free[i] = 1 - Math.min(weight, 1);
      for (let c = 0; c < 3; c++) {
        kept[3 * i + c] = (values[4 * i + c] * Math.min(weight, 1)) / Math.max(weight, 1e-12);
        coarse[3 * i + c] = kept[3 * i + c] + free[i] * coarse[3 * i + c];
      }
    }
    for (let sweep = 0; sweep < sweeps; sweep++) {
      const next = new Float32Array(coarse.length);
      for (let y = 0; y < side; y++) {
        for (let x = 0; x < side; x++) {
          const i = y * side + x;
          const near = [i - (x > 0 ? 1 : 0), i + (x < side - 1 ? 1 : 0), i - (y > 0 ? side : 0), i + (y < side - 1 ? side : 0)];
          for (let c = 0; c < 3; c++) {
            const mean = (coarse[3 * near[0] + c] + coarse[3 * near[1] + c] + coarse[3 * near[2] + c] + coarse[3 * near[3] + c]) / 4;
            next[3 * i + c] = kept[3 * i + c] + free[i] * mean;
          }
        }
      }
      coarse = next;
    }
    before = side;
  }
  for (let i = 0; i < known.length; i++) {
    const size3 = Math.hypot(coarse[3 * i], coarse[3 * i + 1], coarse[3 * i + 2]);
    if (known[i]) coarse.set(normals.subarray(3 * i, 3 * i + 3), 3 * i);
    else if (size3 > 1e-8) for (let c = 0; c < 3; c++) coarse[3 * i + c] /= size3;
    else coarse.set([0, 0, 1], 3 * i);
  }
  return coarse;
}

/**
 * Lets enlarged normals change at the drawing's lines, in place.
 * @param {Float32Array} normals @param {Uint8Array} known @param {Prepared} prepared @param {Uint8Array} mask
 */
function sharpen(normals, known, prepared, mask) {
  const { width, height, frame, seen } = prepared;
  const around = extreme(seen, frame.size, frame.size, 1, 1);
  const trusted = around.map((value, i) => (1 - Math.min(2 * value, 1)) * known[i]);
  const whole = restored(trusted, prepared, 1);
  const scale = frame.side / frame.size;
  const beside = Math.ceil(2 * scale);
  const found = boxOf(mask, width, height);
  if (!found) return;
  /** @type {import("./raster.js").Box} */
  const box = [Math.max(found[0] - beside, 0), Math.max(found[1] - beside, 0), Math.min(found[2] + beside, width), Math.min(found[3] + beside, height)];
  const [wide, high] = [box[2] - box[0], box[3] - box[1]];
  const values = part(normals, width, height, box, 3);
  const weight = part(whole, width, height, box);
  const ink = part(prepared.ink, width, height, box);
  const inside = new Uint8Array(part(mask, width, height, box));
  const out = sharpened(values, weight, ink, inside, wide, high, scale);
  for (let y = 0; y < high; y++) normals.set(out.subarray(3 * y * wide, 3 * (y + 1) * wide), 3 * ((y + box[1]) * width + box[0]));
}

/**
 * Returns values that do not blend across lines.
 * @param {Float32Array} values @param {Float32Array} weight @param {Float32Array} ink @param {Uint8Array} mask
 * @param {number} width @param {number} height @param {number} scale
 */
function sharpened(values, weight, ink, mask, width, height, scale) {
  const factor = Math.min(FINEST / scale, 1);
  if (factor === 1) return gathered(values, weight, ink, mask, width, height, scale);
  const [wide, high] = [width, height].map((side) => Math.max(1, Math.round(side * factor)));
  /** @param {import("./raster.js").Plane} picture @param {number} [channels] */
  const smaller = (picture, channels = 1) => resized(picture, width, height, wide, high, channels);
  const inside = where(smaller(mask), (value) => value > 0.5);
  if (!inside.some(Boolean)) return values;
  const small = gathered(smaller(values, 3), smaller(weight), smaller(extreme(ink, width, height, 1, 1)), inside, wide, high, FINEST);
  const enlarged = resized(small, wide, high, width, height, 3);
  for (let i = 0; i < weight.length; i++) {
    for (let c = 3 * i; c < 3 * i + 3; c++) enlarged[c] += weight[i] * weight[i] * (values[c] - enlarged[c]);
  }
  return parted(enlarged, ink, mask, width, height, 1.5 / factor);
}

/**
 * Returns values gathered over about `reach` pixels where their own weight is low (Gastal and Oliveira 2011).
 * @param {Float32Array} values @param {Float32Array} weight @param {Float32Array} ink @param {Uint8Array} mask
 * @param {number} width @param {number} height @param {number} reach
 */
function gathered(values, weight, ink, mask, width, height, reach) {
  const carried = new Float32Array(4 * weight.length);
  for (let i = 0; i < weight.length; i++) {
    const own = mask[i] ? weight[i] + 1e-3 : 1e-6;
    carried.set([values[3 * i] * own, values[3 * i + 1] * own, values[3 * i + 2] * own, own], 4 * i);
  }
  const decay = middles(ink, mask, width, height).map((line) => Math.exp((-Math.SQRT2 / reach) * (1 + BARRIER * reach * line)));
  const far = 2 ** Math.ceil(Math.log2((-Math.log(0.005) * reach) / Math.SQRT2));
  for (const [count, length, step, line] of [[width, height, width, 1], [height, width, 1, width]]) {
    for (let i = 0; i < count; i++) along(carried, decay, i * line, step, length, far);
  }
  const out = new Float32Array(values.length);
  for (let i = 0; i < weight.length; i++) {
    const trusted = mask[i] ? weight[i] * weight[i] : 0;
    for (let c = 0; c < 3; c++) {
      const there = carried[4 * i + c] / carried[4 * i + 3];
      out[3 * i + c] = there + trusted * (values[3 * i + c] - there);
    }
  }
  return out;
}

/**
 * Smooths a line of pixels there and back, in place; nothing is carried farther than `far`.
 * @param {Float32Array} carried @param {Float32Array} decay
 * @param {number} start @param {number} step @param {number} length @param {number} far
 */
function along(carried, decay, start, step, length, far) {
  for (const way of [1, -1]) {
    const first = way === 1 ? start : start + (length - 1) * step;
    const own = new Float32Array(4 * length);
    const kept = new Float32Array(length);
    for (let k = 0; k < length; k++) {
      const at = first + way * k * step;
      kept[k] = k ? Math.min(decay[at], decay[at - way * step]) : 0;
      for (let c = 0; c < 4; c++) own[4 * k + c] = (1 - kept[k]) * carried[4 * at + c];
    }
    // What left the window of `far` pixels is taken out again.
    const sums = [0, 0, 0, 0];
    let through = 1;
    for (let k = 0; k < length; k++) {
      through = 1;
      sums.fill(0);
      for (let back = 0; back < far && k - back >= 0; back++) {
        for (let c = 0; c < 4; c++) sums[c] += through * own[4 * (k - back) + c];
        through *= kept[k - back];
        if (through < 1e-7) break;
      }
      const at = first + way * k * step;
      for (let c = 0; c < 4; c++) carried[4 * at + c] = sums[c];
    }
  }
}

/** Returns values that change at once in the middle of lines. @param {Float32Array} values @param {Float32Array} ink @param {Uint8Array} mask @param {number} width @param {number} height @param {number} reach */
function parted(values, ink, mask, width, height, reach) {
  const blended = thicker(where(middles(ink, mask, width, height), (value) => value > 0.5), width, height, reach);
  const nearest = new Int32Array(mask.length).fill(-1);
  /** @type {number[]} */
  let edge = [];
  for (let i = 0; i < mask.length; i++) {
    if (!mask[i] || blended[i]) continue;
    nearest[i] = i;
    edge.push(i);
  }
  if (!edge.length) return values;
  const out = values.slice();
  const steps = [-1, 1, -width, width, -width - 1, -width + 1, width - 1, width + 1];
  for (let round = 0; edge.length && round < 4 * reach + 8; round++) {
    /** @type {number[]} */
    const next = [];
    for (const at of edge) {
      for (const step of steps) {
        const other = at + step;
        if (!mask[other] || nearest[other] >= 0 || Math.abs((other % width) - (at % width)) > 1) continue;
        nearest[other] = nearest[at];
        out.set(values.subarray(3 * nearest[at], 3 * nearest[at] + 3), 3 * other);
        next.push(other);
      }
    }
    edge = next;
  }
  return out;
}

/** Returns 1 along the middle of lines and next to nothing at their edges; the contour is left out. @param {Float32Array} ink @param {Uint8Array} mask @param {number} width @param {number} height */
function middles(ink, mask, width, height) {
  const inked = where(ink, (value) => value > INK);
  const depth = distance(inked, width, height, true);
  const half = quantile(depth.filter((value) => value > 0));
  const size = Number.isNaN(half) ? 3 : 2 * Math.ceil(half) + 1;
  const deepest = extreme(depth, width, height, (size - 1) / 2, 1);
  const inner = extreme(mask, width, height, size, -1);
  return depth.map((value, i) => (value / Math.max(deepest[i], 1)) ** 4 * inner[i]);
}

