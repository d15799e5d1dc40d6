/** Edge: finds where an object ends from the ink of its outline, like normalgan.inference.mask.edge in Python. */

import { DECISION, EDGE } from "./constants.js";
import { lineWidth } from "./prepare.js";
import { CROSS, SQUARE, WIDE, above, both, blurred, boxOf, components, dilated, distance, either, eroded, extreme, labelled, near, opposite, part, refitted, ridge, stretched, where, without } from "./raster.js";

const { FINER, LARGE, MERGED, PALEST, TIP, TOUCHING } = EDGE;
const { LEAST_OFF, OFF, SIDE } = DECISION;

/** Returns a mask as opacity, with its staircase smoothed to an edge one pixel wide. @param {Uint8Array} mask @param {number} width @param {number} height */
export const softEdge = (mask, width, height) => stretched(blurred(mask, width, height, 1), 1.6, -0.3);

/** Returns how much of each pixel an object covers, given a mask found at the size of the vote. @param {Uint8Array} mask @param {Float32Array} ink @param {number} width @param {number} height */
export const snapOutline = (mask, ink, width, height) => snap(mask, ink, width, height, Math.max((OFF * Math.max(width, height)) / SIDE, LEAST_OFF));

/**
 * Returns how much of each pixel an object covers, given a mask that may be off by a few pixels.
 * @param {Uint8Array} mask @param {Float32Array} ink @param {number} width @param {number} height @param {number} reach the number of these pixels
 */
function snap(mask, ink, width, height, reach) {
  const covered = new Float32Array(mask.length);
  const found = boxOf(mask, width, height);
  if (!found) return covered;
  const [left, top, right, bottom] = found;
  const room = Math.floor(TIP * Math.max(right - left, bottom - top)) + Math.floor(reach) + 4;
  /** @type {import("./raster.js").Box} */
  const box = [Math.max(left - room, 0), Math.max(top - room, 0), Math.min(right + room, width), Math.min(bottom + room, height)];
  const [wide, high] = [box[2] - box[0], box[3] - box[1]];
  const lines = part(ink, width, height, box);
  const darkest = extreme(lines, wide, high, 2, 1);
  const share = new Float32Array(lines.length);
  for (let i = 0; i < share.length; i++) if (lines[i]) share[i] = Math.min(lines[i] / Math.max(darkest[i], PALEST), 1);
  const inked = above(share, 0.5);
  const body = bodyOf(above(part(mask, width, height, box), 0), lines, inked, wide, high, reach);
  const own = soft(body, inked, share, wide, high);
  for (let y = 0; y < high; y++) covered.set(own.subarray(y * wide, (y + 1) * wide), (y + box[1]) * width + box[0]);
  return covered;
}

/**
 * Returns the object with all of its ink.
 * @param {Uint8Array} mask @param {Float32Array} ink @param {Uint8Array} inked @param {number} width @param {number} height @param {number} reach
 * @returns {Uint8Array}
 */
function bodyOf(mask, ink, inked, width, height, reach) {
  if (Math.max(width, height) > LARGE) {
    const [wide, high] = [(width + 1) >> 1, (height + 1) >> 1];
    const small = refitted(ink, width, height, wide, high);
    const half = above(refitted(mask, width, height, wide, high), 0.5);
    const rough = bodyOf(half, small, above(small, PALEST), wide, high, reach / 2);
    return finished(above(refitted(rough, wide, high, width, height), 0.5), inked, width, height);
  }
  const inside = divided(mask, inked, width, height, reach);
  const whole = either(inside, ownInk(mask, inside, inked, width, height));
  return either(whole, tipsOf(whole, inked, width, height));
}

/** Returns how many marked pixels each part has. @param {Int32Array} labels @param {number} count @param {(at: number) => boolean} marked */
function counted(labels, count, marked) {
  const sums = new Uint32Array(count);
  for (let i = 0; i < labels.length; i++) if (marked(i)) sums[labels[i]]++;
  return sums;
}

/** Grows two sides through free pixels until they meet. @param {Uint8Array} one @param {Uint8Array} other @param {Uint8Array} free @param {number} width @param {number} rounds */
function meet(one, other, free, width, rounds) {
  // 1 is inside, and 2 outside.
  const side = one.slice();
  for (let i = 0; i < side.length; i++) if (other[i]) side[i] = 2;
  /** @type {number[]} */
  let edge = [];
  side.forEach((kind, at) => { if (kind) edge.push(at); });
  for (let round = 0; round < rounds && edge.length; round++) {
    const next = [];
    for (const kind of [1, 2]) {
      for (const at of edge) {
        if (side[at] !== kind) continue;
        const x = at % width;
        for (const to of [x > 0 ? at - 1 : -1, x < width - 1 ? at + 1 : -1, at - width, at + width]) {
          if (to < 0 || to >= side.length || side[to] || !free[to]) continue;
          side[to] = kind;
          next.push(to);
        }
      }
    }
    edge = next;
  }
  return side;
}

/** @param {Uint8Array} mask @param {Uint8Array} inked @param {number} width @param {number} height @param {number} reach */
function divided(mask, inked, width, height, reach) {
  const free = opposite(inked);
  const { labels, boxes } = components(free, width, height, 4);
  const [outer, inner] = [mask, opposite(mask)].map((each) => near(each, width, height, reach, 3));
  // A region in which the mask is certain of only one side belongs to that side as a whole.
  const held = counted(labels, boxes.length, (i) => mask[i] > 0);
  const core = counted(labels, boxes.length, (i) => !inner[i]);
  const rest = counted(labels, boxes.length, (i) => !outer[i]);
  const whole = boxes.map((_, k) => k > 0 && (!core[k] || !rest[k]));
  const inside = labelled(labels, whole.map((all, k) => all && held[k] > 0.5 * boxes[k].area));
  const mixed = labelled(labels, whole.map((all, k) => k > 0 && !all));
  if (mixed.includes(1)) {
    const known = where(mixed, (value, i) => value > 0 && !(inner[i] && outer[i]));
    const side = meet(both(known, mask), without(known, mask), mixed, width, Math.floor(2 * reach) + 2);
    for (let i = 0; i < inside.length; i++) if (mixed[i]) inside[i] = side[i] === 1 || (side[i] === 0 && mask[i] > 0) ? 1 : 0;
  }
  return inside;
}

/** @param {Uint8Array} mask @param {Uint8Array} inside @param {Uint8Array} inked @param {number} width @param {number} height */
function ownInk(mask, inside, inked, width, height) {
  const depth = distance(inked, width, height);
  const peaks = ridge(depth, inked, width, height);
  const away = distance(opposite(inside), width, height);
  /** @type {Map<number, Uint8Array>} */
  const bins = new Map();
  let own = new Uint8Array(inked.length);
  for (let i = 0; i < inked.length; i++) {
    if (!inked[i]) continue;
    const touches = away[i] <= TOUCHING * depth[i] + 1.5;
    if (mask[i] && touches) own[i] = 1;
    if (!peaks[i] || !(mask[i] || touches)) continue;
    const bin = Math.floor(Math.log(depth[i]) / Math.log(FINER));
    let marked = bins.get(bin);
    if (!marked) bins.set(bin, (marked = new Uint8Array(inked.length)));
    marked[i] = 1;
  }
  for (const [bin, middles] of bins) {
    own = either(own, both(inked, near(middles, width, height, FINER ** (bin + 1))));
  }
  for (let round = 0; round < 2; round++) {
    own = both(inked, dilated(own, width, height, SQUARE));
  }
  return own;
}

/** @param {Uint8Array} body @param {Uint8Array} inked @param {number} width @param {number} height */
function tipsOf(body, inked, width, height) {
  const loose = without(inked, body);
  const beside = dilated(body, width, height, SQUARE);
  if (!both(loose, beside).includes(1)) return new Uint8Array(body.length);
  const { labels, boxes } = components(loose, width, height, 8);
  const depth = distance(inked, width, height, true);
  const line = lineWidth(inked, width, height);
  const merged = counted(labels, boxes.length, (i) => loose[i] > 0 && 2 * depth[i] - 1 > Math.max(MERGED * line, line + 1.5));
  const touching = counted(labels, boxes.length, (i) => beside[i] > 0);
  return labelled(labels, boxes.map((_, k) => k > 0 && merged[k] > 0 && touching[k] > 0));
}

/** Returns an object whose edge was off by two pixels at most. @param {Uint8Array} rough @param {Uint8Array} inked @param {number} width @param {number} height */
function finished(rough, inked, width, height) {
  const [grown, shrunk] = [dilated(rough, width, height, WIDE), eroded(rough, width, height, WIDE)];
  const free = opposite(inked);
  const side = meet(both(shrunk, free), without(free, grown), free, width, 6);
  return where(side, (value, i) => value === 1 || (inked[i] ? grown[i] > 0 : rough[i] > 0 && value !== 2));
}

/** @param {Uint8Array} body @param {Uint8Array} inked @param {Float32Array} share @param {number} width @param {number} height */
function soft(body, inked, share, width, height) {
  const covered = softEdge(body, width, height);
  const outside = dilated(opposite(body), width, height, CROSS); // no farther: the inner edge of a thin line is inside
  const line = dilated(both(body, inked), width, height, WIDE);
  for (let i = 0; i < covered.length; i++) {
    if (body[i] ? inked[i] && outside[i] : !inked[i] && line[i]) covered[i] = share[i];
    else if (body[i] && line[i]) covered[i] = 1;
  }
  return covered;
}
