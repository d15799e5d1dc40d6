/** Suggest: finds where a point would help most, and how unsure the model is, like normalgan.inference.suggestion in Python. */

import { SUGGESTION } from "./constants.js";
import { above, blurred, both, boxOf, distance, resized, where } from "./raster.js";

const { INKED, RIM, SIDE } = SUGGESTION;

/** @typedef {{x: number, y: number, normal: [number, number, number], gain: number}} Point in pixels of the map; gain: 0 to 1 */

/**
 * Returns the error that the model expects of its normals, as a share of a right angle.
 * @param {number} confidence its κ (Bae, Budvytis, Cipolla 2021, equation 5)
 */
export function doubt(confidence) {
  const kappa = Math.max(0, Math.min(1e6, confidence));
  const angle = (2 * kappa) / (kappa * kappa + 1) + Math.PI / (Math.exp(Math.min(Math.PI * kappa, 700)) + 1);
  return angle / (Math.PI / 2);
}

/**
 * Returns at most `count` points, best first. It sums the gains within the reach of each point, takes the best point, lowers
 * the gains around it, and repeats.
 * @param {{normals: Float32Array, mask: Uint8Array, width: number, height: number}} map
 * @param {Float32Array | null} confidence κ of each pixel; null uses only the bends
 * @param {{x: number, y: number}[]} taken existing points
 * @param {number} count
 * @param {Uint8Array | null} [lines] the ink: on a line the normal is undefined, so points keep off it where there is room
 * @returns {Point[]}
 */
export function suggest({ normals, mask, width, height }, confidence, taken, count, lines = null) {
  if (!mask.some(Boolean)) return [];
  const scale = Math.min(SIDE / Math.max(width, height), 1);
  const [wide, high] = scale < 1 ? [width, height].map((side) => Math.max(1, Math.round(side * scale))) : [width, height];
  const cover = resized(mask, width, height, wide, high);
  const least = cover.some((value) => value > 0.5) ? 0.5 : 0; // a thin thread fills no pixel of the small map
  const small = where(cover, (value) => value > least);
  const step = { x: wide / width, y: high / height };
  const area = small.reduce((sum, value) => sum + value, 0);
  const reach = Math.max(0.55 * Math.sqrt(area / (count + taken.length)), 2);
  const depth = depthOf(small, wide, high);
  /** Lowers the weight of pixels near the outline. @param {Float32Array} values */
  const inside = (values) => values.map((value, i) => value * Math.min(depth[i] / 2, 1));
  const bends = bending(resized(normals, width, height, wide, high, 3), small, wide, high);
  const gain = peaked(inside(bends), wide, high, reach / 2);
  if (confidence) {
    const doubts = peaked(inside(resized(confidence, width, height, wide, high).map(doubt)), wide, high, reach / 2);
    for (let i = 0; i < gain.length; i++) gain[i] = 0.7 * doubts[i] + 0.3 * gain[i];
  }
  const deepest = depth.reduce((most, value) => Math.max(most, value), 0);
  let free = above(depth, Math.min(1, 0.8 * deepest));
  if (lines) {
    const off = above(depthOf(where(resized(lines, width, height, wide, high), (value) => value < INKED), wide, high), 1);
    const beside = both(free, off);
    if (beside.includes(1)) free = beside;
  }
  /** @param {number} x @param {number} y */
  const take = (x, y) => {
    for (let row = 0, i = 0; row < high; row++) {
      for (let column = 0; column < wide; column++, i++) {
        const away = Math.hypot(column + 0.5 - x, row + 0.5 - y);
        if (away < reach) free[i] = 0;
        gain[i] *= 1 - Math.exp(-((away / reach) ** 2) / 4);
      }
    }
  };
  for (const { x, y } of taken) take(x * step.x, y * step.y);
  /** @type {Point[]} */
  const points = [];
  while (points.length < count) {
    let best = -1;
    for (let i = 0; i < gain.length; i++) if (free[i] && (best < 0 || gain[i] > gain[best])) best = i;
    if (best < 0) break;
    const [x, y] = [(best % wide) + 0.5, Math.floor(best / wide) + 0.5];
    points.push({ ...placeOf(x / step.x, y / step.y, normals, mask, width, height), gain: Math.min(gain[best], 1) });
    take(x, y);
  }
  return points;
}

/** Returns how much normals change from pixel to pixel; steps across the mask's edge count as 0. @param {Float32Array} normals @param {Uint8Array} mask @param {number} width @param {number} height */
function bending(normals, mask, width, height) {
  const squares = new Float32Array(mask.length);
  /** @param {number} one @param {number} other */
  const step = (one, other) => {
    if (!mask[one] || !mask[other]) return;
    let square = 0;
    for (let c = 0; c < 3; c++) square += (normals[3 * other + c] - normals[3 * one + c]) ** 2;
    squares[one] += square / 2;
    squares[other] += square / 2;
  };
  for (let y = 0, i = 0; y < height; y++) {
    for (let x = 0; x < width; x++, i++) {
      if (x + 1 < width) step(i, i + 1);
      if (y + 1 < height) step(i, i + width);
    }
  }
  return squares.map(Math.sqrt);
}

/** Returns the sums of values within a reach, as shares of the largest sum. @param {Float32Array} values @param {number} width @param {number} height @param {number} reach */
function peaked(values, width, height, reach) {
  const around = blurred(values, width, height, reach);
  const most = Math.max(around.reduce((greatest, value) => Math.max(greatest, value), 0), 1e-6);
  return around.map((value) => value / most);
}

/** Returns the distance to the object's edge in units of the rim; 0 off the object. @param {Uint8Array} mask @param {number} width @param {number} height */
function depthOf(mask, width, height) {
  const [left, top, right, bottom] = boxOf(mask, width, height) ?? [0, 0, 1, 1];
  const extent = Math.max(right - left, bottom - top);
  const rim = Math.max(RIM * extent, 1.5);
  return distance(mask, width, height, true, 3).map((value) => value / rim);
}

/** Returns a point of the map, moved onto the object if it lies off it. @param {number} x @param {number} y @param {Float32Array} normals @param {Uint8Array} mask @param {number} width @param {number} height */
function placeOf(x, y, normals, mask, width, height) {
  let [column, row] = [Math.min(Math.floor(x), width - 1), Math.min(Math.floor(y), height - 1)];
  if (!mask[row * width + column]) {
    let nearest = Infinity;
    for (let i = 0; i < mask.length; i++) {
      if (!mask[i]) continue;
      const [u, v] = [i % width, Math.floor(i / width)];
      const away = Math.hypot(u + 0.5 - x, v + 0.5 - y);
      if (away < nearest) [nearest, column, row] = [away, u, v];
    }
  }
  const at = 3 * (row * width + column);
  const length = Math.hypot(normals[at], normals[at + 1], normals[at + 2]) || 1;
  return { x: column + 0.5, y: row + 0.5, normal: /** @type {Point["normal"]} */ ([0, 1, 2].map((c) => normals[at + c] / length)) };
}
