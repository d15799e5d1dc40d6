/** Builds a mesh from a height map: pixels are vertices, and no triangle lies off the object or across a jump in depth. */

import { smoothRim } from "./viewer_rim.js";

const LONGEST = 512; // vertices along the longer side; more than a screen shows only cost time
const STEEPEST = 6; // height difference per pixel sideways; a larger one is a jump, where one part hides another

/**
 * Returns (x right, y up, z to the viewer) of each vertex in halves of the longer side, its place in the map
 * from 0 to 1, and the vertices of triangles, counter-clockwise for a viewer in front.
 * @param {{heights: Float32Array, width: number, height: number}} map in pixels, NaN off the object
 * @returns {{places: Float32Array, wheres: Float32Array, corners: Uint32Array}}
 */
export function meshOf({ heights, width, height }) {
  const stride = Math.max(1, Math.ceil(Math.max(width, height) / LONGEST));
  const columns = Math.ceil(width / stride);
  const rows = Math.ceil(height / stride);
  const unit = Math.max(width, height) / 2;
  const middle = middleOf(heights);
  const levels = new Float32Array(columns * rows);
  const places = new Float32Array(3 * columns * rows);
  const wheres = new Float32Array(2 * columns * rows);
  for (let at = 0; at < levels.length; at++) {
    const x = (at % columns) * stride;
    const y = Math.floor(at / columns) * stride;
    levels[at] = heights[y * width + x];
    places[3 * at] = (x + 0.5 - width / 2) / unit;
    places[3 * at + 1] = (height / 2 - y - 0.5) / unit;
    places[3 * at + 2] = (levels[at] - middle) / unit; // NaN where no triangle uses this vertex
    wheres[2 * at] = (x + 0.5) / width;
    wheres[2 * at + 1] = (y + 0.5) / height;
  }
  const corners = triangles(levels, columns, rows, STEEPEST * stride);
  smoothRim(places, corners, columns);
  return { places, wheres, corners };
}

/** @param {Float32Array} heights */
function middleOf(heights) {
  let [low, high] = [Infinity, -Infinity];
  for (const level of heights) {
    if (level < low) low = level;
    if (level > high) high = level;
  }
  return low <= high ? (low + high) / 2 : 0;
}

/** @param {Float32Array} levels @param {number} columns @param {number} rows @param {number} limit */
function triangles(levels, columns, rows, limit) {
  const corners = new Uint32Array(6 * Math.max(columns - 1, 0) * Math.max(rows - 1, 0));
  let count = 0;
  /** @param {number} a @param {number} b @param {number} c */
  function add(a, b, c) {
    const [p, q, r] = [levels[a], levels[b], levels[c]];
    if (!(Math.max(p, q, r) - Math.min(p, q, r) <= limit)) return; // also false if one is NaN
    corners[count] = a;
    corners[count + 1] = b;
    corners[count + 2] = c;
    count += 3;
  }
  for (let row = 0; row + 1 < rows; row++) {
    for (let column = 0; column + 1 < columns; column++) {
      const [upperLeft, upperRight] = [row * columns + column, row * columns + column + 1];
      const [lowerLeft, lowerRight] = [upperLeft + columns, upperRight + columns];
      // Use the diagonal that bends less; if one corner is missing, the other three still form a triangle.
      const falling = Math.abs(levels[upperLeft] - levels[lowerRight]);
      const rising = Math.abs(levels[upperRight] - levels[lowerLeft]);
      if (Number.isNaN(rising) || falling <= rising) {
        add(upperLeft, lowerLeft, lowerRight);
        add(upperLeft, lowerRight, upperRight);
      } else {
        add(upperLeft, lowerLeft, upperRight);
        add(upperRight, lowerLeft, lowerRight);
      }
    }
  }
  return corners.slice(0, count);
}
