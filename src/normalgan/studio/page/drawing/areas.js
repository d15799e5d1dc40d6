/** Areas: find the areas enclosed by lines, which a click flips between object and hole. */

import { context2d } from "./canvas.js";
import { MOST_LAYERS } from "./document.js";
import { inkAt } from "./ink.js";
import { areaToFill, outlineOf } from "./outline.js";
import { linesIn } from "./paper_tone.js";

/** Longer side in pixels at which areas are searched while the pointer moves. */
const SIDE = 512;
const OBJECT = [91, 98, 224, 115];
const HOLE = [208, 52, 44, 90];

/** @typedef {{shows: (x: number, y: number) => boolean, open: boolean, pictures: Record<"object" | "hole", HTMLCanvasElement>,
 *   outline: () => number[], filling: () => import("./simplify.js").Point[]}} Area of the drawing; open: it reaches the paper's edge;
 *   pictures: its tint; outline and filling: see `outlineOf` and `areaToFill` */
/** @typedef {{area: Area, object: boolean}} Vote object: whether most of the area is */

/**
 * @typedef {object} Lines the lines of a layer
 * @property {number} width of the paper
 * @property {number} height
 * @property {Uint8Array} inked which pixels are ink, row by row
 * @property {number} wide pixels in a row
 * @property {number} high rows
 * @property {{area: Uint8Array, found: Area} | null} last the area that was found last
 */
/** The lines of the layers that were asked about last, by their strokes, for all tools. @type {Map<object, Lines>} */
const known = new Map();

/** Returns the lines of a layer. @param {import("./document.js").Doc} doc @param {import("./document.js").Layer} layer @returns {Lines} */
function linesOfLayer({ width, height }, { strokes }) {
  let lines = known.get(strokes);
  if (lines?.width !== width || lines.height !== height) {
    const { canvas, pixels } = inkAt({ width, height, strokes }, Math.min(SIDE, Math.max(width, height)));
    lines = { width, height, inked: linesIn(pixels(), canvas.width, canvas.height), wide: canvas.width, high: canvas.height, last: null };
  }
  known.delete(strokes);
  known.set(strokes, lines);
  for (const oldest of known.keys()) if (known.size > MOST_LAYERS) known.delete(oldest);
  return lines;
}

/**
 * Returns the area at a point; null on a line.
 * @param {import("./document.js").Doc} doc @param {import("./document.js").Layer} layer @param {number} x @param {number} y
 * @returns {Area | null}
 */
export function areaAt(doc, layer, x, y) {
  const { width, height } = doc;
  if (x < 0 || y < 0 || x >= width || y >= height || !layer.strokes.length) return null;
  const lines = linesOfLayer(doc, layer);
  const { inked, wide, high } = lines;
  const place = (/** @type {number} */ right, /** @type {number} */ down) =>
    Math.min(high - 1, Math.floor((down / height) * high)) * wide + Math.min(wide - 1, Math.floor((right / width) * wide));
  const first = place(x, y);
  if (inked[first]) return null;
  if (lines.last?.area[first]) return lines.last.found;
  const area = new Uint8Array(inked.length);
  const stack = [first];
  area[first] = 1;
  let open = false;
  while (stack.length) {
    const at = /** @type {number} */ (stack.pop());
    const column = at % wide;
    open ||= column === 0 || column === wide - 1 || at < wide || at >= inked.length - wide;
    for (const to of [column > 0 ? at - 1 : -1, column < wide - 1 ? at + 1 : -1, at - wide, at + wide]) {
      if (to < 0 || to >= inked.length || inked[to] || area[to]) continue;
      area[to] = 1;
      stack.push(to);
    }
  }
  const found = { shows: (/** @type {number} */ right, /** @type {number} */ down) => area[place(right, down)] > 0, open, pictures: { object: pictureOf(area, wide, high, OBJECT), hole: pictureOf(area, wide, high, HOLE) }, outline: () => outlineOf(area, lines, { width, height }), filling: () => areaToFill(area, lines, { width, height }) };
  lines.last = { area, found };
  return found;
}

/**
 * Returns the front layer whose lines enclose a point, or else the only layer with lines; null if there is none.
 * @param {import("./document.js").Doc} doc @param {{x: number, y: number}} at
 */
export function layerAt(doc, { x, y }) {
  const drawn = doc.layers.filter(({ visible, strokes }) => visible && strokes.length);
  const around = drawn.findLast((layer) => areaAt(doc, layer, x, y)?.open === false);
  return around ?? (drawn.length === 1 ? drawn[0] : null);
}

/** @param {Uint8Array} area @param {number} width @param {number} height @param {number[]} colour */
function pictureOf(area, width, height, colour) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const image = new ImageData(width, height);
  for (let i = 0; i < area.length; i++) if (area[i]) image.data.set(colour, 4 * i);
  context2d(canvas).putImageData(image, 0, 0);
  return canvas;
}
