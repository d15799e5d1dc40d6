/** Normals: colours, descriptions and rotations of normals. */

import { say, text } from "../text/text.js";

/** @typedef {import("./document.js").Normal} Normal */

/** Returns the colour of a normal map, OpenGL green. @param {Normal} normal @returns {string} */
export const colourOf = (normal) => `rgb(${normal.map((n) => Math.round((n + 1) * 127.5)).join(" ")})`;

/**
 * Returns the normal at a point of a ball, clamped to the visible half.
 * @param {number} x to the right, radius 1
 * @param {number} y upwards
 * @returns {Normal}
 */
export function onBall(x, y) {
  const length = Math.hypot(x, y);
  const shrink = length > 1 ? 1 / length : 1;
  return [x * shrink, y * shrink, Math.sqrt(Math.max(0, 1 - Math.min(length, 1) ** 2))];
}

/**
 * Returns a normal rotated to the right and upwards, never away from the viewer.
 * @param {Normal} normal
 * @param {number} right degrees
 * @param {number} up degrees
 * @returns {Normal}
 */
export function turned([x, y, z], right, up) {
  const [a, b] = [(right * Math.PI) / 180, (up * Math.PI) / 180];
  const [x1, z1] = [x * Math.cos(a) + z * Math.sin(a), z * Math.cos(a) - x * Math.sin(a)];
  const [y1, z2] = [y * Math.cos(b) + z1 * Math.sin(b), z1 * Math.cos(b) - y * Math.sin(b)];
  const length = Math.hypot(x1, y1) || 1;
  if (z2 < 0) return [x1 / length, y1 / length, 0];
  return [x1, y1, z2];
}

/** Returns a normal in words, such as "30° right, 12° up". @param {Normal} normal @returns {string} */
export function inWords([x, y]) {
  /** @param {number} value */
  const degrees = (value) => Math.round((Math.asin(Math.max(-1, Math.min(1, value))) * 180) / Math.PI);
  const parts = [];
  if (degrees(x)) parts.push(say(x > 0 ? "right" : "left", { angle: Math.abs(degrees(x)) }));
  if (degrees(y)) parts.push(say(y > 0 ? "up" : "down", { angle: Math.abs(degrees(y)) }));
  return parts.join(", ") || text.straight;
}

/**
 * Returns the normal a map has at a point, or one towards the viewer where it has none.
 * @param {{rgba: Uint8Array, width: number, height: number} | null} map
 * @param {number} x share of the width, 0..1
 * @param {number} y share of the height, from the top
 * @returns {Normal}
 */
export function normalAt(map, x, y) {
  if (!map) return [0, 0, 1];
  const column = Math.min(map.width - 1, Math.max(0, Math.floor(x * map.width)));
  const row = Math.min(map.height - 1, Math.max(0, Math.floor(y * map.height)));
  const [r, g, b, a] = map.rgba.subarray(4 * (row * map.width + column));
  if (a < 128) return [0, 0, 1];
  const vector = [r, g, b].map((value) => value / 127.5 - 1);
  vector[2] = Math.max(vector[2], 0);
  const length = Math.hypot(...vector);
  return length > 0.1 ? /** @type {Normal} */ (vector.map((value) => value / length)) : [0, 0, 1];
}

/** Number of sample points per side for the mean of an area. */
const GRID = 32;

/**
 * Returns the mean normal of a map inside a polygon, or one towards the viewer where it has none.
 * @param {{rgba: Uint8Array, width: number, height: number} | null} map
 * @param {number[]} points x, y, x, y, … in pixels of the drawing
 * @param {{width: number, height: number}} doc
 * @returns {Normal}
 */
export function meanNormal(map, points, { width, height }) {
  const outline = new Path2D();
  for (let i = 0; i < points.length; i += 2) outline.lineTo(points[i], points[i + 1]);
  const [xs, ys] = [0, 1].map((offset) => points.filter((_, i) => i % 2 === offset));
  const [left, top] = [Math.min(...xs), Math.min(...ys)];
  const [across, down] = [Math.max(...xs) - left, Math.max(...ys) - top];
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(1, 1).getContext("2d"));
  const sum = [0, 0, 0];
  for (let row = 0; row < GRID; row++) {
    for (let column = 0; column < GRID; column++) {
      const [x, y] = [left + ((column + 0.5) / GRID) * across, top + ((row + 0.5) / GRID) * down];
      if (!context.isPointInPath(outline, x, y)) continue;
      normalAt(map, x / width, y / height).forEach((value, i) => { sum[i] += value; });
    }
  }
  const length = Math.hypot(...sum);
  return length > 0 ? /** @type {Normal} */ (sum.map((value) => value / length)) : [0, 0, 1];
}
