/** Decision: the object in a drawing, from its lines and the reader's presence, as normalgan.inference.mask.decision finds it in Python. */

import { snapOutline } from "./edge.js";
import { INKED, decided, enlarged, fillOutline } from "./filling.js";
import { lineWidth } from "./prepare.js";
import { SQUARE, above, both, boxOf, components, dilated, distance, ellipse, eroded, labelled, opposite, refitted, rint, sumOf, where, without } from "./raster.js";
import { presenceAt } from "./reader.js";

const [HOLE, PART, EYE, ADDED, SURE, SPECK] = [0.3, 0.75, 0.004, 0.6, 0.72, 0.002];
/** Mean presence between which the reader is unsure of a region, and the least share of the object to warn. */
const [LOW, HIGH, SHARE] = [0.15, 0.7, 0.02];
/** Share of the object's longer side that an edge without a line has at least to be told of, and how near a line bounds it. */
const [OPEN, REACH] = [0.2, 4];

/** @typedef {{mask: Uint8Array, covered: Float32Array, closed: number, guessed: boolean, unsure: import("./findings.js").Finding[]}} Decision
 *   the object, how much of each pixel it covers, the share of the lines in it or at it, whether a wide gap was closed, and what is to be said */

/**
 * Returns the object that lines and the reader's presence tell together.
 * @param {Float32Array} ink @param {number} width @param {number} height
 * @param {import("./reader.js").Reading | null} reading null leaves it to the lines
 * @returns {Decision}
 */
export function decide(ink, width, height, reading) {
  const [wide, high] = decided(width, height);
  const same = wide === width && high === height;
  const small = same ? ink : refitted(ink, width, height, wide, high);
  const inked = above(small, INKED);
  const filled = fillOutline(inked, wide, high);
  const outline = filled.mask;
  let { closed } = filled;
  let mask = outline;
  /** @type {import("./findings.js").Finding[]} */
  let unsure = [];
  if (reading) {
    const presence = presenceAt(reading, wide, high);
    const { labels, boxes } = components(opposite(inked), wide, high, 4);
    const enclosed = boxes.map((box, k) => k > 0 && box.left > 0 && box.top > 0 && box.right < wide && box.bottom < high);
    mask = voted({ inked, labels, enclosed, outline, presence, wide, high });
    if (!mask.includes(1)) mask = outline;
    closed = shareAt(inked, mask, wide, high);
    unsure = [
      ...doubts({ labels, boxes, enclosed, presence, wide, high }, mask, width / wide),
      ...openEdge(mask, above(small, INKED / 2), wide, high, width / wide),
    ];
  }
  const covered = snapOutline(same ? mask : enlarged(mask, wide, high, width, height), ink, width, height);
  return { mask: above(covered, 0.5), covered, closed, guessed: !reading && filled.guessed, unsure };
}

/**
 * @typedef {object} Regions
 * @property {Int32Array} labels the region between lines that each pixel lies in; 0 on lines
 * @property {boolean[]} enclosed
 * @property {Float32Array} presence
 * @property {number} wide
 * @property {number} high
 */

/** Returns regions by their votes, with the lines about them. @param {Regions & {inked: Uint8Array, outline: Uint8Array}} drawn */
function voted({ inked, labels, enclosed, outline, presence, wide, high }) {
  // A cell is a part of a region that the outline treats alike.
  const count = 2 * enclosed.length;
  const [size, sum] = [new Uint32Array(count), new Float64Array(count)];
  let object = 0;
  for (let i = 0; i < labels.length; i++) {
    object += outline[i];
    if (inked[i]) continue;
    size[2 * labels[i] + outline[i]]++;
    sum[2 * labels[i] + outline[i]] += presence[i];
  }
  const [kept, mixed] = [new Uint8Array(count), new Uint8Array(count)];
  for (let cell = 2; cell < count; cell++) {
    const [mean, inside, within] = [sum[cell] / Math.max(size[cell], 1), enclosed[cell >> 1], cell % 2 === 1];
    kept[cell] = (within ? mean >= HOLE || (inside && size[cell] < EYE * object) : inside && mean > ADDED) ? 1 : 0;
    mixed[cell] = !inside && (!within || mean < PART) && size[cell] ? 1 : 0;
  }
  let solid = new Uint8Array(labels.length);
  for (let i = 0; i < solid.length; i++) {
    if (inked[i]) continue;
    const cell = 2 * labels[i] + outline[i];
    solid[i] = mixed[cell] ? Number(presence[i] > 0.5) : kept[cell];
  }
  if (mixed.includes(1)) solid = withoutGuesses(solid, outline, presence, wide, high);
  const near = dilated(solid, wide, high, ellipse(reachOf(inked, wide, high)));
  const mask = solid.slice();
  for (let i = 0; i < mask.length; i++) if (inked[i] && (near[i] ? outline[i] || presence[i] > 0.15 : presence[i] > 0.4)) mask[i] = 1;
  // Between a line and what it bounds there is no gap of a pixel.
  const closed = eroded(dilated(mask, wide, high, SQUARE), wide, high, SQUARE);
  for (let i = 0; i < mask.length; i++) {
    if (closed[i] && (outline[i] || presence[i] > 0.3) && !(outline[i] && labels[i] && !kept[2 * labels[i] + 1])) mask[i] = 1;
  }
  return mask;
}

/** Returns the object without areas off the outline that are specks, or of which the reader is unsure. @param {Uint8Array} solid @param {Uint8Array} outline @param {Float32Array} presence @param {number} wide @param {number} high */
function withoutGuesses(solid, outline, presence, wide, high) {
  const { labels, boxes } = components(without(solid, outline), wide, high, 4);
  const sum = new Float64Array(boxes.length);
  for (let i = 0; i < labels.length; i++) sum[labels[i]] += presence[i];
  const least = SPECK * Math.max(sumOf(solid), 1);
  const kept = boxes.map(({ area }, k) => k === 0 || (sum[k] >= SURE * area && area >= least));
  return both(solid, labelled(labels, kept));
}

/** Returns how wide a window about a line is that reaches what it bounds. @param {Uint8Array} inked @param {number} wide @param {number} high */
const reachOf = (inked, wide, high) => 2 * rint(lineWidth(inked, wide, high) + 1.5) + 1;

/** Returns the share of lines in or at the object. @param {Uint8Array} inked @param {Uint8Array} mask @param {number} wide @param {number} high */
function shareAt(inked, mask, wide, high) {
  const reach = reachOf(inked, wide, high);
  const near = dilated(mask, wide, high, Array.from({ length: reach }, () => reach >> 1));
  let [held, all] = [0, 0];
  for (let i = 0; i < inked.length; i++) {
    all += inked[i];
    held += inked[i] & near[i];
  }
  return held / Math.max(all, 1);
}

/**
 * Returns what is to be said of regions of which the reader is unsure.
 * @param {Regions & {boxes: {area: number}[]}} regions @param {Uint8Array} mask @param {number} scale pixels of the drawing for one of these
 * @returns {import("./findings.js").Finding[]}
 */
function doubts({ labels, boxes, enclosed, presence, wide, high }, mask, scale) {
  const sum = new Float64Array(boxes.length);
  for (let i = 0; i < labels.length; i++) sum[labels[i]] += presence[i];
  const least = SHARE * Math.max(sumOf(mask), 1);
  const numbers = boxes.map(({ area }, k) => ({ k, area, vote: sum[k] / Math.max(area, 1) }))
    .filter(({ k, area, vote }) => enclosed[k] && vote > LOW && vote < HIGH && area > least).sort((one, other) => other.area - one.area);
  if (!numbers.length) return [];
  const places = numbers.map(({ k }) => {
    const depth = distance(where(labels, (label) => label === k), wide, high, true, 3);
    const at = depth.indexOf(depth.reduce((most, value) => Math.max(most, value), 0));
    return /** @type {[number, number]} */ ([(at % wide) * scale, Math.floor(at / wide) * scale]);
  });
  return [{ code: "regions", places, count: numbers.length }];
}

/**
 * Returns what is to be said of the longest stretch of an object's edge that no line bounds, if it is long.
 * @param {Uint8Array} mask @param {Uint8Array} inked @param {number} wide @param {number} high @param {number} scale as of `doubts`
 * @returns {import("./findings.js").Finding[]}
 */
function openEdge(mask, inked, wide, high, scale) {
  const box = boxOf(mask, wide, high);
  if (!box) return [];
  const bounded = dilated(inked, wide, high, Array.from({ length: 2 * REACH + 1 }, () => REACH));
  const free = without(without(mask, eroded(mask, wide, high, SQUARE)), bounded);
  // What the picture's border cuts off needs no line there.
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
