/** Finish: brings the network's prediction to the drawing's size and place, like normalgan.inference in Python. */

import { EXTENSION, PIPELINE, UPSAMPLING } from "./constants.js";
import { softEdge } from "./edge.js";
import { Unpaintable, shrunk } from "./prepare.js";
import { SQUARE, WIDE, above, both, boxOf, components, dilated, distance, either, opposite, part, quantile, resized, sumOf, where, without } from "./raster.js";

/** @typedef {import("./prepare.js").Prepared} Prepared @typedef {import("./prepare.js").Frame} Frame
 * @typedef {import("./result/findings.js").Finding} Finding */
/** @typedef {(planes: Float32Array, width: number, height: number) => Promise<Float32Array>} Refiner six planes in, three out */

const { BESIDE, LEAST, PRESENT } = PIPELINE;
const { CELL, ENLARGED, LARGEST, RIM } = UPSAMPLING;
const { SWEEPS } = EXTENSION;

/**
 * Returns the normals (x, y, z for each pixel), the mask, both at the map's size, and the findings about it.
 * @param {Prepared} prepared
 * @param {Float32Array} painted three planes, vectors whose length is the probability of an object
 * @param {Refiner} refiner
 * @param {Int8Array | null} [hand] 1 where the user has added to the object, -1 where the user has removed from it
 */
export async function finish(prepared, painted, refiner, hand = null) {
  const { width, height, frame } = prepared;
  const area = frame.size ** 2;
  const [normals, length] = [new Float32Array(3 * area), new Float32Array(area)];
  for (let i = 0; i < area; i++) {
    const [x, y, z] = [painted[i], painted[area + i], painted[2 * area + i]];
    const long = Math.sqrt(x * x + y * y + z * z);
    length[i] = long;
    if (long <= 1e-8) continue;
    normals[3 * i] = x / long;
    normals[3 * i + 1] = y / long;
    normals[3 * i + 2] = z / long;
  }
  const present = above(restored(length, prepared, 1), 0.5);
  const { mask: found, findings: said } = chosen(prepared, present);
  // The user's strokes take precedence.
  const mask = hand ? byHand(found, hand, prepared) : found;
  const inside = sumOf(mask);
  const share = sumOf(both(mask, present)) / Math.max(inside, 1);
  const findings = hand ? [] : [...said];
  if (share < PRESENT) findings.push({ code: "unseen", share });
  const needed = above(shrunk(mask, width, height, frame), 0);
  const usual = quantile(length.filter((_, i) => needed[i] > 0), 0.95) || 0;
  const least = Math.max(0.1 * usual, LEAST);
  const known = where(length, (value, i) => value > 0.5 || (needed[i] > 0 && value > least));
  if (!known.some(Boolean)) throw new Unpaintable("no_object");
  if (!inside) throw new Unpaintable("empty_mask");
  const coarse = known.every(Boolean) ? normals : extended(normals, known, needed, frame.size);
  const worked = restored(coarse, prepared, 3);
  if (frame.side > ENLARGED * frame.size) await refine(worked, prepared, mask, refiner);
  const out = reduced(worked, prepared, 3);
  for (let i = 0; i < out.length; i += 3) {
    out[i + 2] = Math.max(out[i + 2], 0); // no visible surface faces away
    const size = Math.sqrt(out[i] * out[i] + out[i + 1] * out[i + 1] + out[i + 2] * out[i + 2]);
    if (size > 1e-8) for (let c = 0; c < 3; c++) out[i + c] /= size;
    else out.set([0, 0, 1], i);
  }
  const whole = coveredBy(prepared, mask);
  const covered = reduced(whole, prepared, 1);
  return { ...prepared.map, normals: out, mask: covered === whole ? mask : above(covered, 0.5), covered, findings };
}

/** Brings a picture of the size at which the drawing was worked on to the map's. @param {Float32Array} picture @param {Prepared} prepared @param {number} channels */
function reduced(picture, { width, height, map }, channels) {
  return map.width === width && map.height === height ? picture : resized(picture, width, height, map.width, map.height, channels);
}

/** Returns the model's κ at the map's size. @param {Float32Array} confidence @param {Prepared} prepared */
export const certaintyOf = (confidence, prepared) => reduced(restored(confidence, prepared, 1), prepared, 1);

/**
 * Returns the mask with the user's strokes applied. A filled area ends where a line begins, so that pixels of the
 * line's edge remain between it and the object: such gaps beside an added area also become object if they are all ink.
 * @param {Uint8Array} found @param {Int8Array} hand @param {Prepared} prepared
 */
function byHand(found, hand, { ink, width, height }) {
  const added = Uint8Array.from(hand, (value) => (value > 0 ? 1 : 0));
  const mask = either(found, added);
  if (added.includes(1)) {
    const { labels, boxes } = components(opposite(mask), width, height, 4);
    const [beside, gap] = [dilated(added, width, height, SQUARE), new Uint8Array(boxes.length)];
    for (let i = 0; i < labels.length; i++) if (beside[i]) gap[labels[i]] = 1;
    for (let i = 0; i < labels.length; i++) if (!ink[i]) gap[labels[i]] = 0;
    for (let i = 0; i < labels.length; i++) if (labels[i] && gap[labels[i]]) mask[i] = 1;
  }
  for (let i = 0; i < mask.length; i++) if (hand[i] < 0) mask[i] = 0;
  return mask;
}

/** Returns how much of each pixel the object covers; where the edge no longer follows the outline, it is one pixel wide. @param {Prepared} prepared @param {Uint8Array} mask */
function coveredBy({ covered, width, height }, mask) {
  if (!covered) return softEdge(mask, width, height);
  const outline = above(covered, 0.5);
  const other = either(without(mask, outline), without(outline, mask));
  if (!other.includes(1)) return covered;
  const [soft, changed] = [softEdge(mask, width, height), dilated(other, width, height, WIDE)];
  for (let i = 0; i < soft.length; i++) if (!changed[i]) soft[i] = covered[i];
  return soft;
}

/** Returns the mask and the findings about it. @param {Prepared} prepared @param {Uint8Array} present @returns {{mask: Uint8Array, findings: Finding[]}} */
const chosen = ({ mask, unsure }, present) => ({ mask: mask ?? present, findings: unsure });

/**
 * Returns the finding about hints off the object, if there are any.
 * @param {{x: number, y: number}[]} hints in pixels of the drawing @param {number} scale pixels of the mask to one of these
 * @param {{mask: Uint8Array, width: number, height: number}} map
 * @returns {Finding[]}
 */
export function hintsOff(hints, scale, { mask, width, height }) {
  if (!hints.length) return [];
  const beside = Math.max(Math.round(BESIDE * Math.max(width, height)), 1);
  const near = dilated(mask, width, height, Array.from({ length: 2 * beside + 1 }, () => beside));
  /** @param {number} value @param {number} most */
  const held = (value, most) => Math.min(Math.max(Math.floor((Math.floor(value) + 0.5) * scale), 0), most - 1);
  const off = hints.filter(({ x, y }) => !near[held(y, height) * width + held(x, width)]);
  if (!off.length) return [];
  return [{ code: "hints", places: off.map(({ x, y }) => [x, y]), count: off.length, total: hints.length }];
}

/** Brings a square of the network to the drawing's place and size. @param {Float32Array} square @param {Prepared} prepared @param {number} channels */
export function restored(square, { width, height, frame: { left, top, side, size } }, channels) {
  const scale = side / size;
  const out = new Float32Array(width * height * channels);
  const [across, down] = [{ count: width, start: left }, { count: height, start: top }].map(({ count, start }) => {
    const [from, share] = [new Int32Array(count), new Float32Array(count)];
    for (let i = 0; i < count; i++) {
      share[i] = (i - start - (scale - 1) / 2) / scale;
      from[i] = Math.floor(share[i]);
      share[i] -= from[i];
    }
    return { from, share };
  });
  for (let y = 0; y < height; y++) {
    const row = down.from[y];
    if (row < -1 || row >= size) continue;
    const [above, below] = [row >= 0 ? 1 - down.share[y] : 0, row + 1 < size ? down.share[y] : 0];
    // Pixels beyond the square have no weight, wherever they are read from.
    const [first, second] = [Math.max(row, 0) * size, Math.min(row + 1, size - 1) * size];
    for (let x = 0; x < width; x++) {
      const column = across.from[x];
      if (column < -1 || column >= size) continue;
      const before = column >= 0 ? 1 - across.share[x] : 0;
      const after = column + 1 < size ? across.share[x] : 0;
      const one = Math.max(column, 0) * channels;
      const two = Math.min(column + 1, size - 1) * channels;
      for (let c = 0; c < channels; c++) {
        out[(y * width + x) * channels + c] =
          above * (before * square[first * channels + one + c] + after * square[first * channels + two + c])
          + below * (before * square[second * channels + one + c] + after * square[second * channels + two + c]);
      }
    }
  }
  return out;
}

/**
 * Returns unit normals everywhere: the known ones, and their approximately harmonic extension (Gortler et al. 1996, 3.3).
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
 * Refines enlarged normals with the drawing's lines and rim, in place.
 * @param {Float32Array} normals @param {Prepared} prepared @param {Uint8Array} mask @param {Refiner} refiner
 */
async function refine(normals, prepared, mask, refiner) {
  const { width, height, frame } = prepared;
  const scale = frame.side / frame.size;
  const beside = Math.round(2 * scale);
  const found = boxOf(mask, width, height);
  if (!found) return;
  /** @type {import("./raster.js").Box} */
  const box = [Math.max(found[0] - beside, 0), Math.max(found[1] - beside, 0), Math.min(found[2] + beside, width), Math.min(found[3] + beside, height)];
  const [wide, high] = [box[2] - box[0], box[3] - box[1]];
  const factor = Math.min(LARGEST / scale, 1);
  const [w, h] = [wide, high].map((side) => Math.max(1, Math.round(side * factor)));
  /** @param {import("./raster.js").Plane} picture @param {number} [channels] */
  const shown = (picture, channels = 1) => {
    const own = part(picture, width, height, box, channels);
    return factor < 1 ? resized(own, wide, high, w, h, channels) : own;
  };
  const mended = await mend(shown(normals, 3), shown(prepared.ink), above(shown(mask), 0.5), w, h, refiner);
  const out = factor < 1 ? resized(mended, w, h, wide, high, 3) : mended;
  for (let y = 0; y < high; y++) normals.set(out.subarray(3 * y * wide, 3 * (y + 1) * wide), 3 * ((y + box[1]) * width + box[0]));
}

/**
 * Returns the refined normals, x, y, z for each pixel.
 * @param {Float32Array} normals @param {Float32Array} ink @param {Uint8Array} mask
 * @param {number} width @param {number} height @param {Refiner} refiner
 */
async function mend(normals, ink, mask, width, height, refiner) {
  const depth = distance(mask, width, height, true);
  // Whole cells: the last row and column are repeated to fill them.
  const [wide, high] = [width, height].map((side) => Math.ceil(side / CELL) * CELL);
  const area = wide * high;
  const planes = new Float32Array(6 * area);
  for (let y = 0, to = 0; y < high; y++) {
    for (let x = 0; x < wide; x++, to++) {
      const from = Math.min(y, height - 1) * width + Math.min(x, width - 1);
      for (let c = 0; c < 3; c++) planes[c * area + to] = normals[3 * from + c];
      planes[3 * area + to] = ink[from];
      planes[4 * area + to] = mask[from];
      planes[5 * area + to] = Math.min(depth[from] / RIM, 1);
    }
  }
  const mended = await refiner(planes, wide, high);
  const out = new Float32Array(normals.length);
  for (let y = 0, to = 0; y < height; y++) {
    for (let x = 0; x < width; x++, to += 3) for (let c = 0; c < 3; c++) out[to + c] = mended[c * area + y * wide + x];
  }
  return out;
}
