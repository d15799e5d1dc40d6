/** Carving: convert engraved and embossed lines to the areas that the server takes. */

import { MOST_POINTS, rounded } from "./simplify.js";
import { boxOf, curveOf, sidesOf, widthAt } from "./strokes.js";

/** @typedef {import("./strokes.js").Point} Point @typedef {import("./document.js").Line} Line */
/** @typedef {import("./document.js").Area & {height?: number, widths?: number[]}} Asked height: of a line that is carved; widths: at its points */

/** @type {WeakMap<object, Asked[]>} by the strokes of a layer */
const known = new WeakMap();

/** Returns the edits of a layer's map: its areas, then its carved lines. @param {import("./document.js").Layer} layer @returns {Asked[]} */
export function areasOf({ areas, strokes }) {
  const carved = known.get(strokes) ?? strokes.flatMap((stroke, i) =>
    stroke.kind === "pen" && stroke.carve ? piecesOf(stroke, strokes.slice(i + 1)) : []);
  known.set(strokes, carved);
  return [...areas, ...carved];
}

/** Returns the parts of a line that were not erased later, in pieces of at most `MOST_POINTS` points. @param {Line} line @param {import("./document.js").Stroke[]} later @returns {Asked[]} */
function piecesOf(line, later) {
  const around = boxOf(line, 0);
  const erasers = later.flatMap((stroke) => (stroke.kind === "eraser" && meet(boxOf(stroke, 0), around) ? sidesOf(stroke) : []))
    .map((side) => ({ size: side.size, way: sampled(side), box: boxOf(side, 0) }));
  const isErased = (/** @type {Point} */ { x, y }) =>
    erasers.some(({ size, way, box }) => meet(box, { left: x, top: y, right: x, bottom: y }) && way.some((each) => Math.hypot(each.x - x, each.y - y) < widthAt(size, each.p) / 2));
  /** @type {Point[][]} */
  const pieces = [];
  for (const side of sidesOf(line)) {
    /** @type {Point[]} */
    let piece = [];
    pieces.push(piece);
    for (const point of sampled(side)) {
      const erased = isErased(point);
      if (erased || piece.length >= MOST_POINTS) pieces.push((piece = []));
      if (!erased) piece.push(point);
    }
  }
  return pieces.filter((piece) => piece.length).map((piece) => ({
    points: piece.flatMap(({ x, y }) => [rounded(x), rounded(y)]), normal: [0, 0, 1], size: line.size, height: line.carve,
    widths: piece.map(({ p }) => rounded(widthAt(line.size, p))),
  }));
}

/** @typedef {{left: number, top: number, right: number, bottom: number}} Box */
/** @param {Box} a @param {Box} b */
const meet = (a, b) => a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;

/** Returns points along a line, spaced more closely than its width. @param {{size: number, points: number[]}} side */
const sampled = (side) => curveOf(side, Math.max(1, side.size / 3));
