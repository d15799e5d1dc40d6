/** Outline: the line around an area of pixels that drawn lines enclose. */

import { corners, makeRoom, rounded } from "./simplify.js";

/** Maximum distance in pixels between the outline and the steps of the pixels that it follows. */
const SMOOTH = 1;
/** Steps to the right, down, to the left and up. */
const WAYS = [[1, 0], [0, 1], [-1, 0], [0, -1]];
/** What a pixel belongs to: a line, the area, the paper around all lines, or another area that lines enclose. */
const [INK, OWN, OUTSIDE, ENCLOSED] = [0, 1, 2, 3];

/** @typedef {{inked: Uint8Array, wide: number, high: number}} Lines which pixels are ink, row by row */

/**
 * Returns the outline of an area, without its holes.
 * @param {Uint8Array} area which pixels belong to it, joined by their sides @param {Lines} lines
 * @param {{width: number, height: number}} paper
 * @returns {number[]} x, y, x, y, … in pixels of the paper
 */
export function outlineOf(area, lines, { width, height }) {
  const line = walkAround(grown(area, lines), lines.wide);
  const points = corners([...line, line[0]], SMOOTH).slice(1)
    .flatMap((i) => [rounded((line[i % line.length].x * width) / lines.wide), rounded((line[i % line.length].y * height) / lines.high)]);
  makeRoom(points);
  return points;
}

/**
 * Returns an area with the lines around it: up to their middle where another enclosed area is behind them, and as a whole,
 * with a little of the paper, where nothing is. The object's mask ends at the line's outer edge.
 * @param {Uint8Array} area @param {Lines} lines
 */
function grown(area, { inked, wide, high }) {
  const owner = Uint8Array.from(inked, (ink, at) => (ink ? INK : area[at] ? OWN : ENCLOSED));
  /** @param {number[]} border @param {number} over @returns {number[]} */
  const spread = (border, over) => border.flatMap((at) => neighbours(at, wide, high).filter((to) => {
    if (owner[to] !== over) return false;
    owner[to] = owner[at];
    return true;
  }));
  const all = [...owner.keys()];
  let border = all.filter((at) => owner[at] === ENCLOSED && neighbours(at, wide, high).length < WAYS.length);
  for (const at of border) owner[at] = OUTSIDE;
  while (border.length) border = spread(border, ENCLOSED);
  /** @param {number[]} some */
  const owned = (some) => some.filter((at) => owner[at] === OWN);
  const inside = owned(all).length;
  border = spread(all.filter((at) => owner[at] !== INK), INK);
  const around = owned(border).length;
  while (border.length) border = spread(border, INK);
  border = owned(all);
  const width = Math.ceil((border.length - inside) / Math.max(around, 1)); // the mean half of the lines' width
  for (let step = 0; step < width; step++) border = spread(border, OUTSIDE);
  return owner.map((each) => (each === OWN ? 1 : 0));
}

/** Returns the pixels beside a pixel. @param {number} at @param {number} wide @param {number} high */
function neighbours(at, wide, high) {
  const column = at % wide;
  return [column > 0 ? at - 1 : -1, column < wide - 1 ? at + 1 : -1, at - wide, at + wide].filter((to) => to >= 0 && to < wide * high);
}

/**
 * Returns the corners of pixels around an area, clockwise, with the area on the right-hand side.
 * @param {Uint8Array} area @param {number} wide
 * @returns {import("./simplify.js").Point[]}
 */
function walkAround(area, wide) {
  const first = area.indexOf(1);
  const start = { x: first % wide, y: Math.floor(first / wide) };
  /** @param {number} column @param {number} row */
  const isIn = (column, row) => column >= 0 && column < wide && area[row * wide + column] === 1;
  const line = [];
  for (let { x, y } = start, way = 0; !line.length || x !== start.x || y !== start.y || way !== 0;) {
    line.push({ x, y });
    [x, y] = [x + WAYS[way][0], y + WAYS[way][1]];
    // The pixels ahead, to the right and to the left of the way.
    const [right, left] = [[[0, 0], [-1, 0], [-1, -1], [0, -1]][way], [[0, -1], [0, 0], [-1, 0], [-1, -1]][way]];
    if (!isIn(x + right[0], y + right[1])) way = (way + 1) % 4;
    else if (isIn(x + left[0], y + left[1])) way = (way + 3) % 4;
  }
  return line;
}
