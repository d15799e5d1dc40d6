/** Unrolling: finds where the points of a surface lie when it is flattened, like normalgan.inference.unrolling in Python. */

import { UNROLLING } from "./constants.js";

const { GROUND, LEAST, SIDE, SLACK } = UNROLLING;
/** Relative residual allowed in the solution, at most a tenth of a pixel, and the maximum number of steps. */
const [RESIDUE, STEPS] = [1e-3, 1000];

/**
 * Returns a function that gives how far a point of the surface moves right and down, in pixels, when it is flattened.
 * @param {{normals: Float32Array, mask: Uint8Array, width: number, height: number}} map
 * @returns {(x: number, y: number, out: number[]) => void} x, y: in pixels of the map
 */
export function unrolled({ normals, mask, width, height }) {
  const side = Math.ceil(Math.max(height, width) / SIDE);
  const [rows, columns] = [Math.ceil(height / side), Math.ceil(width / side)];
  const { stretch, share } = cellsOf(normals, mask, width, side, rows, columns);
  const pulls = [new Float64Array(rows * columns), new Float64Array(rows * columns)];
  const [across, down] = [new Float64Array(rows * columns), new Float64Array(rows * columns)];
  for (let i = 0; i < rows * columns; i++) {
    for (const [axis, there, next, weights] of /** @type {const} */ ([
      [0, i % columns < columns - 1, i + 1, across],
      [1, i < (rows - 1) * columns, i + columns, down],
    ])) {
      if (!there) continue;
      weights[i] = Math.min(share[i], share[next]) + SLACK;
      for (let c = 0; c < 2; c++) {
        // The stretch consists of xx, xy and yy.
        const wanted = (side * weights[i] * (stretch[3 * i + axis + c] + stretch[3 * next + axis + c])) / 2;
        pulls[c][next] += wanted;
        pulls[c][i] -= wanted;
      }
    }
  }
  const object = Math.max(share.reduce((sum, value) => sum + value, 0), 1e-9);
  const moved = pulls.map((pull) => {
    const found = solved(pull, across, down, columns);
    const mean = found.reduce((sum, value, i) => sum + value * share[i], 0) / object;
    return found.map((value) => value - mean);
  });
  return (x, y, out) => {
    const [u, v] = [Math.min(Math.max(x / side - 0.5, 0), columns - 1), Math.min(Math.max(y / side - 0.5, 0), rows - 1)];
    const [column, row] = [Math.min(Math.floor(u), Math.max(columns - 2, 0)), Math.min(Math.floor(v), Math.max(rows - 2, 0))];
    const [far, low] = [u - column, v - row];
    const [at, right, below] = [row * columns + column, columns > 1 ? 1 : 0, rows > 1 ? columns : 0];
    moved.forEach((values, c) => {
      out[c] = (1 - low) * ((1 - far) * values[at] + far * values[at + right]) +
        low * ((1 - far) * values[at + below] + far * values[at + below + right]);
    });
  };
}

/**
 * Returns the share of object in each cell, and the stretch of steps on its surface: xx, xy and yy.
 * @param {Float32Array} normals @param {Uint8Array} mask @param {number} width @param {number} side @param {number} rows @param {number} columns
 */
function cellsOf(normals, mask, width, side, rows, columns) {
  const count = rows * columns;
  const [sums, share, stretch] = [new Float64Array(3 * count), new Float64Array(count), new Float64Array(3 * count)];
  for (let i = 0; i < mask.length; i++) {
    if (!mask[i]) continue;
    const cell = Math.floor(Math.floor(i / width) / side) * columns + Math.floor((i % width) / side);
    share[cell] += 1 / (side * side);
    for (let c = 0; c < 3; c++) sums[3 * cell + c] += normals[3 * i + c];
  }
  for (let i = 0; i < count; i++) {
    if (!share[i]) continue;
    const [x, y, z] = sums.subarray(3 * i, 3 * i + 3);
    const longer = (1 / Math.max(z / Math.max(Math.hypot(x, y, z), 1e-9), LEAST) - 1) / Math.max(x * x + y * y, 1e-18);
    stretch.set([longer * x * x, -longer * x * y, longer * y * y], 3 * i);
  }
  return { stretch, share };
}

/**
 * Returns the equilibrium positions of the cells, by conjugate gradients with diagonal preconditioning.
 * @param {Float64Array} pull @param {Float64Array} across weights of the links to the right @param {Float64Array} down and down @param {number} columns
 */
function solved(pull, across, down, columns) {
  const count = pull.length;
  const [place, change] = [new Float64Array(count), new Float64Array(count)];
  const held = place.map((_, i) => GROUND + across[i] + down[i] + (i % columns ? across[i - 1] : 0) + (i >= columns ? down[i - columns] : 0));
  const rest = pull.slice();
  const way = rest.map((value, i) => value / held[i]);
  const dot = (/** @type {Float64Array} */ one, /** @type {Float64Array} */ other) => one.reduce((sum, value, i) => sum + value * other[i], 0);
  let left = dot(rest, way);
  const enough = left * RESIDUE ** 2;
  for (let step = 0; step < STEPS && left > enough; step++) {
    for (let i = 0; i < count; i++) change[i] = held[i] * way[i];
    for (let i = 0; i < count; i++) {
      if (across[i]) {
        change[i] -= across[i] * way[i + 1];
        change[i + 1] -= across[i] * way[i];
      }
      if (down[i]) {
        change[i] -= down[i] * way[i + columns];
        change[i + columns] -= down[i] * way[i];
      }
    }
    const far = left / dot(way, change);
    for (let i = 0; i < count; i++) {
      place[i] += far * way[i];
      rest[i] -= far * change[i];
    }
    const next = rest.reduce((sum, value, i) => sum + (value * value) / held[i], 0);
    for (let i = 0; i < count; i++) way[i] = rest[i] / held[i] + (next / left) * way[i];
    left = next;
  }
  return place;
}
