/** Outline: the line around an area of pixels that drawn lines enclose. */

import { apart, corners, makeRoom, rounded } from "./simplify.js";

/** Maximum distance in pixels between the outline and the steps of the pixels that it follows. */
const SMOOTH = 1;
/** Steps to the right, down, to the left and up. */
const WAYS = [[1, 0], [0, 1], [-1, 0], [0, -1]];
/** The pixels beyond a corner that are on the right-hand side of each way; on its left-hand side is that of the way before. */
const AHEAD = [[0, 0], [-1, 0], [-1, -1], [0, -1]];
/** What a pixel belongs to: a line, the area, the paper around all lines, or another area that lines enclose. */
const [INK, OWN, OUTSIDE, ENCLOSED] = [0, 1, 2, 3];

/** @typedef {import("./simplify.js").Point} Point */
/** @typedef {{inked: Uint8Array, wide: number, high: number}} Lines which pixels are ink, row by row */

/**
 * Returns the outline of an area, without its holes and with the lines around it: up to their middle where another enclosed
 * area is behind them, and as a whole where nothing is, because there the object's mask ends at their outer edge.
 * @param {Uint8Array} area which pixels belong to it, joined by their sides @param {Lines} lines
 * @param {{width: number, height: number}} paper
 * @returns {number[]} x, y, x, y, … in pixels of the paper
 */
export function outlineOf(area, lines, paper) {
  const owner = ownersOf(area, lines);
  takeOutside(owner, area, lines);
  const [around] = linesAround(owner, lines.wide);
  const points = placed(around, lines, paper).flatMap(({ x, y }) => [x, y]);
  makeRoom(points);
  return points;
}

/**
 * Returns the outline of an area up to the middle of the lines around it, and of its holes; thin cuts join them, so that all
 * is one line to be filled.
 * @param {Uint8Array} area which pixels belong to it, joined by their sides @param {Lines} lines
 * @param {{width: number, height: number}} paper
 * @returns {import("./simplify.js").Point[]} in pixels of the paper
 */
export function areaToFill(area, lines, paper) {
  const [around, ...holes] = linesAround(ownersOf(area, lines), lines.wide).map((line) => placed(line, lines, paper));
  for (const hole of holes) {
    const [first] = hole;
    const away = around.map((each) => apart(each, first));
    const near = away.indexOf(Math.min(...away));
    around.splice(near + 1, 0, ...hole, first, around[near]);
  }
  return around;
}

/** Returns a line with fewer points, in pixels of the paper. @param {Point[]} line @param {Lines} lines @param {{width: number, height: number}} paper @returns {Point[]} */
function placed(line, { wide, high }, { width, height }) {
  const whole = [...line, line[0]];
  return corners(whole, SMOOTH).slice(1).map((i) => ({ x: rounded((whole[i].x * width) / wide), y: rounded((whole[i].y * height) / high) }));
}

/**
 * Returns what each pixel belongs to; ink belongs to the nearest paper.
 * @param {Uint8Array} area @param {Lines} lines
 * @returns {Uint8Array}
 */
function ownersOf(area, lines) {
  const { inked, wide, high } = lines;
  const owner = Uint8Array.from(inked, (ink, at) => (ink ? INK : area[at] ? OWN : ENCLOSED));
  const edge = [...owner.keys()].filter((at) => owner[at] === ENCLOSED && neighbours(at, wide, high).length < WAYS.length);
  for (const at of edge) owner[at] = OUTSIDE;
  for (let border = edge; border.length;) border = spread(owner, border, ENCLOSED, lines);
  for (let border = [...owner.keys()].filter((at) => owner[at] !== INK); border.length;) border = spread(owner, border, INK, lines);
  return owner;
}

/** Adds to an area what is outside and within half a line's width. @param {Uint8Array} owner @param {Uint8Array} area @param {Lines} lines */
function takeOutside(owner, area, lines) {
  let border = [...owner.keys()].filter((at) => owner[at] === OWN);
  const ink = border.filter((at) => !area[at]);
  const beside = ink.filter((at) => neighbours(at, lines.wide, lines.high).some((to) => area[to]));
  for (let step = 0; step < ink.length / Math.max(beside.length, 1); step++) border = spread(owner, border, OUTSIDE, lines);
}

/** Passes the owners of pixels on to their neighbours, and returns these. @param {Uint8Array} owner @param {number[]} border @param {number} over whose pixels @param {Lines} lines */
function spread(owner, border, over, { wide, high }) {
  return border.flatMap((at) => neighbours(at, wide, high).filter((to) => {
    if (owner[to] !== over) return false;
    owner[to] = owner[at];
    return true;
  }));
}

/** Returns the pixels beside a pixel. @param {number} at @param {number} wide @param {number} high */
function neighbours(at, wide, high) {
  const column = at % wide;
  return [column > 0 ? at - 1 : -1, column < wide - 1 ? at + 1 : -1, at - wide, at + wide].filter((to) => to >= 0 && to < wide * high);
}

/**
 * Returns the lines around an area, of corners of pixels: the outer one, and one for each hole.
 * @param {Uint8Array} owner @param {number} wide
 * @returns {Point[][]} with the area on the right-hand side
 */
function linesAround(owner, wide) {
  /** @param {number} column @param {number} row */
  const isIn = (column, row) => column >= 0 && column < wide && owner[row * wide + column] === OWN;
  const seen = new Set();
  const found = [];
  for (const [at, each] of owner.entries()) {
    const start = { x: at % wide, y: Math.floor(at / wide) };
    if (each !== OWN || isIn(start.x, start.y - 1) || seen.has(at)) continue;
    const line = [];
    for (let { x, y } = start, way = 0; !line.length || x !== start.x || y !== start.y || way !== 0;) {
      line.push({ x, y });
      if (way === 0) seen.add(y * wide + x);
      [x, y] = [x + WAYS[way][0], y + WAYS[way][1]];
      const [right, left] = [AHEAD[way], AHEAD[(way + 3) % 4]];
      if (!isIn(x + right[0], y + right[1])) way = (way + 1) % 4;
      else if (isIn(x + left[0], y + left[1])) way = (way + 3) % 4;
    }
    found.push(line);
  }
  return found;
}
