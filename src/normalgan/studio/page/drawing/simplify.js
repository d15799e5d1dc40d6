/** Simplify: a polyline of the same shape with fewer points. */

import { LIMITS } from "./limits.js";

/** @typedef {{x: number, y: number}} Point */

/** @param {Point} a @param {Point} b */
export const apart = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);

/** Rounds a coordinate to a hundredth of a pixel. @param {number} value */
export const rounded = (value) => Math.round(value * 100) / 100;

/** Returns the distance of a point from the line between two others. @param {Point} at @param {Point} a @param {Point} b */
export function offLine(at, a, b) {
  const length = apart(a, b) || 1e-9;
  const along = Math.max(0, Math.min(1, ((at.x - a.x) * (b.x - a.x) + (at.y - a.y) * (b.y - a.y)) / length ** 2));
  return apart(at, { x: a.x + along * (b.x - a.x), y: a.y + along * (b.y - a.y) });
}

/** Returns the indices of a polyline's corners and ends (Douglas and Peucker 1973). @param {Point[]} line @param {number} most @param {number} first @param {number} last @returns {number[]} */
export function corners(line, most, first = 0, last = line.length - 1) {
  let [farthest, off] = [-1, most];
  for (let i = first + 1; i < last; i++) {
    const away = offLine(line[i], line[first], line[last]);
    if (away > off) [farthest, off] = [i, away];
  }
  return farthest < 0 ? [first, last] : [...corners(line, most, first, farthest), ...corners(line, most, farthest, last).slice(1)];
}

/** Maximum number of points that the server accepts in a region, a brush or mask stroke, or a piece of a carved line; also used for lassos. */
export const { points: MOST_POINTS } = LIMITS;
/** Initial tolerance in drawing pixels when points are dropped. */
const LEAST_OFF = 0.25;

/**
 * Halves the points of a polyline that has reached the maximum, so that it can go on; its shape changes as little as possible.
 * @param {number[]} points x, y, x, y, …; in place
 */
export function makeRoom(points) {
  if (points.length < 2 * MOST_POINTS) return;
  const line = Array.from({ length: points.length / 2 }, (_, i) => ({ x: points[2 * i], y: points[2 * i + 1] }));
  let kept = line.map((_, i) => i);
  for (let off = LEAST_OFF; kept.length > MOST_POINTS / 2; off *= 2) kept = corners(line, off);
  points.splice(0, points.length, ...kept.flatMap((i) => [line[i].x, line[i].y]));
}
