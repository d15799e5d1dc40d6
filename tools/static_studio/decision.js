/** Decision: finds the object in a drawing from its lines and the reader's presence, like normalgan.inference.mask.decision in Python. */

import { DECISION, REGIONS } from "./constants.js";
import { snapOutline } from "./edge.js";
import { severalFigures } from "./figures.js";
import { SQUARE, above, boxOf, components, dilated, distance, enclosedBy, eroded, opposite, refitted, rint, sumOf, where, without } from "./raster.js";
import { presenceAt } from "./reader.js";

const { INKED } = REGIONS;
const { OPEN, REACH, SIDE, UNSURE_HIGH, UNSURE_LOW, UNSURE_SHARE } = DECISION;

/** @typedef {{mask: Uint8Array | null, covered: Float32Array | null, unsure: import("./result/findings.js").Finding[],
 *   figures: import("./result/findings.js").Finding[]}} Decision
 *   the object, null if none is found, its coverage of each pixel, and the findings about it and about separate figures */

/**
 * Returns the object according to the lines and the reader's presence.
 * @param {Float32Array} ink @param {number} width @param {number} height
 * @param {import("./reader.js").Reading | null} reading null leaves it to the lines
 * @returns {Decision}
 */
export function decide(ink, width, height, reading) {
  const [wide, high] = decided(width, height);
  const same = wide === width && high === height;
  const small = same ? ink : refitted(ink, width, height, wide, high);
  const inked = above(small, INKED);
  const presence = reading ? presenceAt(reading, wide, high) : Float32Array.from(without(enclosedBy(inked, wide, high), inked));
  const { labels, boxes } = components(opposite(inked), wide, high, 4);
  const enclosed = boxes.map((box, k) => k > 0 && box.left > 0 && box.top > 0 && box.right < wide && box.bottom < high);
  const votes = votesOf(labels, boxes, presence);
  const lone = reading ? loneOf(labels, boxes, enclosed, votes, presence) : -1;
  if (lone >= 0) votes[lone] = 1;
  const solid = new Uint8Array(inked.length);
  for (let i = 0; i < solid.length; i++) if (!inked[i]) solid[i] = Number((enclosed[labels[i]] ? votes[labels[i]] : presence[i]) > 0.5);
  const mask = solid.slice();
  for (let i = 0; i < mask.length; i++) if (inked[i] && presence[i] > 0.5) mask[i] = 1;
  // Every hole has a line around it.
  const whole = enclosedBy(mask, wide, high);
  for (let i = 0; i < mask.length; i++) if (whole[i] && !inked[i] && !enclosed[labels[i]]) mask[i] = 1;
  const scale = width / wide;
  const unsure = reading
    ? [...doubts({ labels, boxes, enclosed, votes, wide, high }, mask, scale), ...openEdge(mask, above(small, INKED / 2), wide, high, scale)]
    : [];
  const rough = same ? mask : above(refitted(mask, wide, high, width, height), 0.5);
  const covered = snapOutline(rough, ink, width, height);
  const object = above(covered, 0.5);
  const figures = reading ? severalFigures(small, presence, wide, high, reading, scale) : [];
  return object.includes(1) ? { mask: object, covered, unsure, figures } : { mask: null, covered: null, unsure: [{ code: "guessed" }], figures };
}

/** Returns the size at which areas are voted on. @param {number} width @param {number} height @returns {[number, number]} */
function decided(width, height) {
  const longest = Math.max(width, height);
  const side = Math.min(Math.max(longest, SIDE / 2), SIDE);
  return side === longest ? [width, height] : [Math.max(rint((width * side) / longest), 1), Math.max(rint((height * side) / longest), 1)];
}

/** Returns the mean presence of each region. @param {Int32Array} labels @param {{area: number}[]} boxes @param {Float32Array} presence */
function votesOf(labels, boxes, presence) {
  const sum = new Float64Array(boxes.length);
  for (let i = 0; i < labels.length; i++) sum[labels[i]] += presence[i];
  return boxes.map(({ area }, k) => sum[k] / Math.max(area, 1));
}

/**
 * Returns the only region that lines enclose if the reader is unsure of it and sees no object off the lines; otherwise -1.
 * If it were a hole, nothing would be left but its outline.
 * @param {Int32Array} labels @param {{area: number}[]} boxes @param {boolean[]} enclosed @param {number[]} votes @param {Float32Array} presence
 */
function loneOf(labels, boxes, enclosed, votes, presence) {
  const least = UNSURE_SHARE * boxes.reduce((most, { area }, k) => (enclosed[k] ? Math.max(most, area) : most), 0);
  const large = boxes.map((_, k) => k).filter((k) => enclosed[k] && boxes[k].area > least);
  if (large.length !== 1 || votes[large[0]] <= UNSURE_LOW || votes[large[0]] >= UNSURE_HIGH) return -1;
  let elsewhere = 0;
  for (let i = 0; i < labels.length; i++) if (labels[i] > 0 && !enclosed[labels[i]] && presence[i] > 0.5) elsewhere++;
  return elsewhere > least ? -1 : large[0];
}

/**
 * @typedef {object} Regions
 * @property {Int32Array} labels each pixel's region between lines; 0 on lines
 * @property {{area: number}[]} boxes
 * @property {boolean[]} enclosed
 * @property {number[]} votes
 * @property {number} wide
 * @property {number} high
 */

/**
 * Returns the finding about regions of which the reader is unsure.
 * @param {Regions} regions @param {Uint8Array} mask @param {number} scale pixels of the drawing for one of these
 * @returns {import("./result/findings.js").Finding[]}
 */
function doubts({ labels, boxes, enclosed, votes, wide, high }, mask, scale) {
  const least = UNSURE_SHARE * Math.max(sumOf(mask), 1);
  const numbers = boxes.map(({ area }, k) => ({ k, area, vote: votes[k] }))
    .filter(({ k, area, vote }) => enclosed[k] && vote > UNSURE_LOW && vote < UNSURE_HIGH && area > least).sort((one, other) => other.area - one.area);
  if (!numbers.length) return [];
  const places = numbers.map(({ k }) => {
    const depth = distance(where(labels, (label) => label === k), wide, high, true, 3);
    const at = depth.indexOf(depth.reduce((most, value) => Math.max(most, value), 0));
    return /** @type {[number, number]} */ ([(at % wide) * scale, Math.floor(at / wide) * scale]);
  });
  return [{ code: "regions", places, count: numbers.length }];
}

/**
 * Returns the finding about the longest stretch of the object's edge without a line, if it is long.
 * @param {Uint8Array} mask @param {Uint8Array} inked @param {number} wide @param {number} high @param {number} scale as in `doubts`
 * @returns {import("./result/findings.js").Finding[]}
 */
function openEdge(mask, inked, wide, high, scale) {
  const box = boxOf(mask, wide, high);
  if (!box) return [];
  const bounded = dilated(inked, wide, high, Array.from({ length: 2 * REACH + 1 }, () => REACH));
  const free = without(without(mask, eroded(mask, wide, high, SQUARE)), bounded);
  // Where the picture's border cuts the object off, no line is needed.
  for (let y = 0; y < high; y++) {
    const level = y < REACH || y >= high - REACH;
    for (let x = 0; x < wide; x++) if (level || x < REACH || x >= wide - REACH) free[y * wide + x] = 0;
  }
  const { labels, boxes } = components(free, wide, high, 8);
  const longest = boxes.reduce((most, { area }, k) => (area > boxes[most].area ? k : most), 0);
  if (!longest || boxes[longest].area < OPEN * Math.max(box[2] - box[0], box[3] - box[1])) return [];
  const points = [...labels.keys()].filter((at) => labels[at] === longest).map((at) => [at % wide, Math.floor(at / wide)]);
  const [x, y] = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
  const away = points.map((point) => Math.hypot(point[0] - x, point[1] - y));
  const middle = points[away.indexOf(away.reduce((least, value) => Math.min(least, value), Infinity))];
  return [{ code: "edge", places: [[middle[0] * scale, middle[1] * scale]] }];
}
