/** Lasso: select everything inside a line, including parts of imported pictures. */

import { context2d } from "./canvas.js";
import { extentOf } from "./moving.js";
import { decodeAll, decoded, free, hasHoles } from "./pictures.js";
import { drawStroke, sidesOf } from "./strokes.js";

/** @typedef {import("./document.js").Placed} Placed @typedef {import("./document.js").Stroke} Stroke */
/** @typedef {{x: number, y: number}} Point @typedef {{left: number, top: number, right: number, bottom: number}} Rect */
/** @typedef {number[][]} Lasso one or more lines around, each x, y, x, y, … in pixels of the drawing */
/**
 * @typedef {object} Cut a picture of which only a part is selected
 * @property {number} index its place among the layer's strokes
 * @property {Stroke} stroke the picture
 * @property {import("./moving.js").Box} box around the selected part
 * @property {{rest: Placed, piece: Placed} | null} parts null until they are cut; a piece of size 0 has no ink
 * @property {Promise<void>} ready resolves when they are
 */

/** Opacity, out of 255, above which a pixel counts as drawn, because paper is never quite even. */
const DRAWN = 25;
/** Level, out of 255, below which a colour is ink instead of paper. */
const LIGHT = 128;

/** @type {Worker | null} */
let worker = null;
let requests = 0;
/** @type {Set<string>} cut pictures that are not in a document yet */
const unused = new Set();

/** Returns a function that tests whether a point lies inside. @param {Lasso} lasso @returns {(point: Point) => boolean} */
export function insideOf(lasso) {
  const context = context2d(document.createElement("canvas"));
  const paths = lasso.map(pathOf);
  return ({ x, y }) => paths.some((path) => context.isPointInPath(path, x, y));
}

/** @param {number[]} points */
function pathOf(points) {
  const path = new Path2D();
  for (let i = 0; i < points.length; i += 2) path.lineTo(points[i], points[i + 1]);
  path.closePath();
  return path;
}

/** Returns whether most of a stroke lies inside. @param {import("./document.js").Line} line @param {(point: Point) => boolean} inside */
function isMostlyInside(line, inside) {
  const points = sidesOf(line).flatMap(({ points: all }) =>
    Array.from({ length: all.length / 3 }, (_, i) => ({ x: all[3 * i], y: all[3 * i + 1] })));
  return 2 * points.filter(inside).length > points.length;
}

/**
 * Returns the selection of a lasso in a layer: lines that lie mostly inside, and the pixels of pictures inside.
 * @param {import("./document.js").Layer} layer @param {Lasso} lasso
 * @returns {{strokes: number[], cuts: Cut[]}} strokes: those that are selected as a whole
 */
export function chosenBy({ strokes }, lasso) {
  const inside = insideOf(lasso);
  /** @type {number[]} */
  const whole = [];
  /** @type {Cut[]} */
  const cuts = [];
  for (const [index, stroke] of strokes.entries()) {
    if (stroke.kind !== "picture") {
      if (stroke.kind !== "eraser" && isMostlyInside(stroke, inside)) whole.push(index);
      continue;
    }
    const found = cutOf(stroke, strokes.slice(index + 1).filter(({ kind }) => kind === "eraser"), lasso);
    if (found === "whole") whole.push(index);
    else if (found) cuts.push(Object.assign(found, { index, stroke })); // the same object, because its parts are added later
  }
  return { strokes: whole, cuts };
}

/** Returns the matrix from the pixels of a picture to the drawing. @param {import("./document.js").Box} box @param {number} wide @param {number} high */
function matrixOf({ x, y, width, height, turn = 0, flipped = false }, wide, high) {
  return new DOMMatrix().translate(x + width / 2, y + height / 2).rotate((turn * 180) / Math.PI)
    .scale((flipped ? -1 : 1) * (width / wide), height / high).translate(-wide / 2, -high / 2);
}

/** @param {number} width @param {number} height */
function canvasOf(width, height) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  return { canvas, context: context2d(canvas, { willReadFrequently: true }) };
}

/** Returns the parts of a cut and marks them as used by a document. @param {Cut} cut */
export function takeParts({ parts }) {
  if (parts) for (const { picture } of [parts.rest, parts.piece]) unused.delete(picture);
  return parts;
}

/**
 * Cuts a picture along a lasso. Each pixel goes unchanged to one of the parts. From a picture on paper only the ink is cut
 * out, extracted from its paper, and paper remains in its place.
 * @param {Placed} stroke @param {Stroke[]} erasers later strokes of the eraser @param {Lasso} lasso
 * @returns {Omit<Cut, "index" | "stroke"> | "whole" | null} whole: everything drawn is inside; null: nothing is
 */
function cutOf(stroke, erasers, lasso) {
  const image = decoded(stroke.picture);
  const { width, height } = image;
  const back = matrixOf(stroke, width, height).inverse();
  const edges = lasso.map((points) => Array.from({ length: points.length / 2 }, (_, i) => back.transformPoint({ x: points[2 * i], y: points[2 * i + 1] })));
  const box = pixelsAround(edges.flat(), width, height);
  if (box.left >= box.right || box.top >= box.bottom) return null;
  const { context } = canvasOf(width, height);
  context.drawImage(image, 0, 0);
  const paper = stroke.paper || hasHoles(stroke.picture) ? null : paperAlong(context, edges);
  erase(context, back, erasers, paper);
  const { data } = context.getImageData(0, 0, width, height);
  const inside = pixelsIn(lasso, back, box);
  const { found, outside } = drawnIn(data, width, { inside, box }, paper);
  if (!found) return null;
  if (!outside) return "whole";
  const placed = (/** @type {Rect} */ rect) => placeOf(stroke, rect, width, height);
  const cut = { box: extentOf({ ...stroke, ...placed(found) }), parts: /** @type {Cut["parts"]} */ (null), ready: Promise.resolve() };
  cut.ready = asked({ pixels: data, width, inside, box, paper }).then(async ({ rest, piece, rect }) => {
    if (rect) for (const url of await decodeAll([rest, piece])) unused.add(url);
    const place = rect ? placed(rect) : { x: 0, y: 0, width: 0, height: 0 };
    cut.parts = { rest: { ...stroke, picture: rest }, piece: { ...stroke, ...place, picture: piece, ...(paper && { paper: true }) } };
    if (rect) cut.box = extentOf(cut.parts.piece);
  });
  return cut;
}

/** Returns the box of a picture's pixels around points, with a margin of one pixel. @param {Point[]} points @param {number} width @param {number} height @returns {Rect} */
function pixelsAround(points, width, height) {
  const rect = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };
  for (const { x, y } of points) {
    [rect.left, rect.right] = [Math.min(rect.left, x), Math.max(rect.right, x)];
    [rect.top, rect.bottom] = [Math.min(rect.top, y), Math.max(rect.bottom, y)];
  }
  const within = (/** @type {number} */ value, /** @type {number} */ side) => Math.max(0, Math.min(side, Math.round(value)));
  return { left: within(rect.left - 1, width), top: within(rect.top - 1, height), right: within(rect.right + 1, width), bottom: within(rect.bottom + 1, height) };
}

/**
 * Applies erasers to a picture, and fills the erased parts with its paper.
 * @param {CanvasRenderingContext2D} context the picture @param {DOMMatrix} back from the drawing to it @param {Stroke[]} erasers @param {number[] | null} paper
 */
function erase(context, back, erasers, paper) {
  context.setTransform(back);
  for (const eraser of erasers) drawStroke(context, eraser, decoded);
  context.resetTransform();
  if (!paper) return;
  context.globalCompositeOperation = "destination-over";
  context.fillStyle = `rgb(${paper.join(" ")})`;
  context.fillRect(0, 0, context.canvas.width, context.canvas.height);
}

/** Returns 1 for each pixel of a box in a picture that lies in a lasso, else 0. @param {Lasso} lasso @param {DOMMatrix} back from the drawing to the picture @param {Rect} box */
function pixelsIn(lasso, back, { left, top, right, bottom }) {
  const { context } = canvasOf(right - left, bottom - top);
  context.setTransform(new DOMMatrix().translate(-left, -top).multiply(back));
  for (const points of lasso) context.fill(pathOf(points));
  const { data } = context.getImageData(0, 0, right - left, bottom - top);
  const inside = new Uint8Array(data.length / 4);
  for (let i = 0; i < inside.length; i++) inside[i] = data[4 * i + 3] >> 7;
  return inside;
}

/**
 * Returns the box of a picture's ink inside a lasso, or null, and whether there is ink outside.
 * @param {Uint8ClampedArray} data of the picture @param {number} width @param {{inside: Uint8Array, box: Rect}} lasso which pixels of the box are inside
 * @param {number[] | null} paper
 * @returns {{found: Rect | null, outside: boolean}}
 */
function drawnIn(data, width, { inside, box: { left, top, right, bottom } }, paper) {
  const height = data.length / 4 / width;
  const found = { left: width, top: height, right: 0, bottom: 0 };
  let outside = false;
  for (let y = 0; y < height; y++) {
    const crossed = y >= top && y < bottom;
    if (!crossed && outside) continue; // rows without the lasso no longer matter
    for (let x = 0, i = y * width; x < width; x++, i++) {
      const within = crossed && x >= left && x < right && inside[(y - top) * (right - left) + x - left];
      if ((!within && outside) || opacityOf(data, 4 * i, paper) <= DRAWN) continue;
      if (!within) {
        outside = true;
        continue;
      }
      if (x < found.left) found.left = x;
      if (x >= found.right) found.right = x + 1;
      if (y < found.top) found.top = y;
      found.bottom = y + 1;
    }
  }
  return { found: found.right ? found : null, outside };
}

/** Asks a worker to split the pixels of a picture. @param {Omit<import("./cutting.js").CutRequest, "id">} request @returns {Promise<import("./cutting.js").Answer>} */
function asked(request) {
  free([...unused]);
  unused.clear();
  worker ??= new Worker(new URL("cutting.js", import.meta.url), { type: "module" });
  const own = worker;
  const id = ++requests;
  return new Promise((resolve, reject) => {
    const over = new AbortController();
    own.addEventListener("message", ({ data }) => {
      if (data.id !== id) return;
      over.abort();
      resolve(data);
    }, over);
    own.addEventListener("error", (event) => {
      over.abort();
      worker = null;
      reject(new Error(event.message));
    }, over);
    own.postMessage({ ...request, id }, [request.pixels.buffer, request.inside.buffer]);
  });
}

/** Returns the opacity of ink on its paper, 0 to 255. @param {Uint8ClampedArray} data @param {number} i @param {number[] | null} paper */
function opacityOf(data, i, paper) {
  if (!paper) return data[i + 3];
  let alpha = 0;
  for (let k = 0; k < 3; k++) {
    const [from, to] = [paper[k], data[i + k]];
    alpha = Math.max(alpha, to < from ? (from - to) / from : to > from ? (to - from) / (255 - from) : 0);
  }
  return 255 * alpha;
}

/**
 * Returns the position of a part of a picture.
 * @param {Placed} stroke @param {Rect} rect in pixels of the picture @param {number} wide of the picture @param {number} high
 */
function placeOf(stroke, { left, top, right, bottom }, wide, high) {
  const { x, y } = matrixOf(stroke, wide, high).transformPoint({ x: (left + right) / 2, y: (top + bottom) / 2 });
  const [width, height] = [((right - left) * stroke.width) / wide, ((bottom - top) * stroke.height) / high];
  return { x: x - width / 2, y: y - height / 2, width, height };
}

/**
 * Returns the colour of the paper: the median along the lasso, which mostly runs between lines, or white if that is dark.
 * @param {CanvasRenderingContext2D} context the picture @param {{x: number, y: number}[][]} edges of the lasso in the picture
 * @returns {number[]} red, green, blue
 */
function paperAlong(context, edges) {
  const { width, height } = context.canvas;
  const { data } = context.getImageData(0, 0, width, height);
  /** @type {number[][]} */
  const seen = [[], [], []];
  for (const corners of edges) {
    for (const [i, from] of corners.entries()) {
      const to = corners[(i + 1) % corners.length];
      const steps = Math.max(1, Math.ceil(Math.hypot(to.x - from.x, to.y - from.y)));
      for (let k = 0; k < steps; k++) {
        const [column, row] = [Math.floor(from.x + ((to.x - from.x) * k) / steps), Math.floor(from.y + ((to.y - from.y) * k) / steps)];
        if (column < 0 || row < 0 || column >= width || row >= height) continue;
        const at = 4 * (row * width + column);
        seen.forEach((each, channel) => each.push(data[at + channel]));
      }
    }
  }
  const paper = seen.map((each) => each.sort((a, b) => a - b)[each.length >> 1] ?? 255);
  return Math.max(...paper) < LIGHT ? [255, 255, 255] : paper;
}
