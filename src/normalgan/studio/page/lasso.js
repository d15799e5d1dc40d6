/** Lasso: what lies inside of a line around it is chosen, of an imported drawing its pixels too. */

import { context2d } from "./canvas.js";
import { extentOf } from "./moving.js";
import { decoded, hasHoles, keepDrawn } from "./pictures.js";
import { drawStroke, sidesOf } from "./strokes.js";

/** @typedef {import("./document.js").Placed} Placed @typedef {import("./document.js").Stroke} Stroke */
/** @typedef {{x: number, y: number}} Point @typedef {{left: number, top: number, right: number, bottom: number}} Rect */
/** @typedef {number[][]} Lasso one or more lines around, each x, y, x, y, … in pixels of the drawing */
/**
 * @typedef {object} Cut a picture of which only a part is chosen
 * @property {number} index its place among the layer's strokes
 * @property {Stroke} stroke the picture
 * @property {import("./moving.js").Box} box around the chosen part
 * @property {() => {rest: Placed, piece: Placed}} parts cuts it, once
 */

/** Opacity, to 255, above which a pixel is drawn: paper is never quite even. */
const DRAWN = 25;
/** Below this, to 255, a colour is that of ink, and not of paper. */
const LIGHT = 128;
/** Pixels about a piece that stay empty, so that it has the same edge at every size. */
const EMPTY = 2;

/** Returns what tells whether a point lies inside. @param {Lasso} lasso @returns {(point: Point) => boolean} */
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
 * Returns what a lasso chooses of a layer: lines that lie mostly inside, and the pixels inside of its pictures.
 * @param {import("./document.js").Layer} layer @param {Lasso} lasso
 * @returns {{strokes: number[], cuts: Cut[]}} strokes: those that are chosen whole
 */
export function chosenBy({ strokes }, lasso) {
  const inside = insideOf(lasso);
  /** @type {number[]} */
  const whole = [];
  /** @type {Cut[]} */
  const cuts = [];
  for (const [index, stroke] of strokes.entries()) {
    if (stroke.kind !== "picture") {
      if (stroke.kind === "pen" && isMostlyInside(stroke, inside)) whole.push(index);
      continue;
    }
    const found = cutOf(stroke, strokes.slice(index + 1).filter(({ kind }) => kind === "eraser"), lasso);
    if (found === "whole") whole.push(index);
    else if (found) cuts.push({ index, stroke, ...found });
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

/**
 * Cuts a picture along a lasso. Each of its pixels goes to one part, as it is; of a picture on paper the ink goes, which is
 * taken off its paper, and paper stays in its place.
 * @param {Placed} stroke @param {Stroke[]} erasers what was erased of it later @param {Lasso} lasso
 * @returns {Omit<Cut, "index" | "stroke"> | "whole" | null} whole: all that is drawn is inside; null: nothing is
 */
function cutOf(stroke, erasers, lasso) {
  const image = decoded(stroke.picture);
  const { width, height } = image;
  const back = matrixOf(stroke, width, height).inverse();
  const { canvas, context } = canvasOf(width, height);
  context.drawImage(image, 0, 0);
  const paper = stroke.paper || hasHoles(stroke.picture) ? null : paperAlong(context, lasso, back);
  context.setTransform(back);
  for (const eraser of erasers) drawStroke(context, eraser, decoded);
  context.resetTransform();
  if (paper) {
    context.globalCompositeOperation = "destination-over";
    context.fillStyle = `rgb(${paper.join(" ")})`;
    context.fillRect(0, 0, width, height);
  }
  const around = canvasOf(width, height).context;
  around.setTransform(back);
  for (const points of lasso) around.fill(pathOf(points));
  const isIn = around.getImageData(0, 0, width, height).data;

  const rest = context.getImageData(0, 0, width, height);
  const piece = context.createImageData(width, height);
  const ink = new Uint8ClampedArray(4);
  let [left, top, right, bottom, inside, outside] = [width, height, 0, 0, false, false];
  for (let i = 0; i < isIn.length; i += 4) {
    if (paper) takeOff(rest.data, i, paper, ink);
    else ink.set(rest.data.subarray(i, i + 4));
    if (isIn[i + 3] < 128) {
      outside ||= ink[3] > DRAWN;
      continue;
    }
    inside ||= ink[3] > DRAWN;
    if (!ink[3]) continue;
    piece.data.set(ink, i);
    rest.data.set(paper ? [...paper, 255] : [0, 0, 0, 0], i);
    const [column, row] = [(i / 4) % width, Math.floor(i / 4 / width)];
    [left, right, top, bottom] = [Math.min(left, column), Math.max(right, column), Math.min(top, row), Math.max(bottom, row)];
  }
  if (!inside) return null;
  if (!outside) return "whole";
  const rect = {
    left: Math.max(0, left - EMPTY), top: Math.max(0, top - EMPTY),
    right: Math.min(width, right + 1 + EMPTY), bottom: Math.min(height, bottom + 1 + EMPTY),
  };
  const place = placeOf(stroke, rect, width, height);
  /** @type {{rest: Placed, piece: Placed} | undefined} */
  let parts;
  return {
    box: extentOf({ ...stroke, ...place }),
    parts: () => {
      if (parts) return parts;
      const cut = canvasOf(rect.right - rect.left, rect.bottom - rect.top);
      cut.context.putImageData(piece, -rect.left, -rect.top);
      context.putImageData(rest, 0, 0);
      parts = {
        rest: { ...stroke, picture: keepDrawn(canvas) },
        piece: { ...stroke, ...place, picture: keepDrawn(cut.canvas), ...(paper && { paper: true }) },
      };
      return parts;
    },
  };
}

/**
 * Returns where a part of a picture is placed.
 * @param {Placed} stroke @param {Rect} rect in pixels of the picture @param {number} wide of the picture @param {number} high
 */
function placeOf(stroke, { left, top, right, bottom }, wide, high) {
  const { x, y } = matrixOf(stroke, wide, high).transformPoint({ x: (left + right) / 2, y: (top + bottom) / 2 });
  const [width, height] = [((right - left) * stroke.width) / wide, ((bottom - top) * stroke.height) / high];
  return { x: x - width / 2, y: y - height / 2, width, height };
}

/**
 * Returns the colour of the paper along a lasso, which mostly runs beside the lines: the median there, or white if it is dark.
 * @param {CanvasRenderingContext2D} context the picture @param {Lasso} lasso @param {DOMMatrix} back from the drawing to the picture
 * @returns {number[]} red, green, blue
 */
function paperAlong(context, lasso, back) {
  const { width, height } = context.canvas;
  const { data } = context.getImageData(0, 0, width, height);
  /** @type {number[][]} */
  const seen = [[], [], []];
  for (const points of lasso) {
    const corners = Array.from({ length: points.length / 2 }, (_, i) => back.transformPoint({ x: points[2 * i], y: points[2 * i + 1] }));
    for (const [i, from] of corners.entries()) {
      const to = corners[(i + 1) % corners.length];
      const steps = Math.max(1, Math.ceil(Math.hypot(to.x - from.x, to.y - from.y)));
      for (let k = 0; k < steps; k++) {
        const [column, row] = [Math.floor(from.x + ((to.x - from.x) * k) / steps), Math.floor(from.y + ((to.y - from.y) * k) / steps)];
        if (column < 0 || row < 0 || column >= width || row >= height) continue;
        const colour = data.subarray(4 * (row * width + column), 4 * (row * width + column) + 3);
        seen.forEach((each, channel) => each.push(colour[channel]));
      }
    }
  }
  const paper = seen.map((each) => each.sort((a, b) => a - b)[each.length >> 1] ?? 255);
  return Math.max(...paper) < LIGHT ? [255, 255, 255] : paper;
}

/**
 * Takes a colour off its paper: on that paper the ink that is left looks as before.
 * @param {Uint8ClampedArray} data opaque @param {number} i @param {number[]} paper @param {Uint8ClampedArray} ink red, green, blue, opacity
 */
function takeOff(data, i, paper, ink) {
  let alpha = 0;
  for (let k = 0; k < 3; k++) {
    const [from, to] = [paper[k], data[i + k]];
    alpha = Math.max(alpha, to < from ? (from - to) / from : to > from ? (to - from) / (255 - from) : 0);
  }
  ink[3] = Math.ceil(255 * alpha - 1e-6); // rounding must not make more of it
  const share = ink[3] / 255;
  for (let k = 0; k < 3; k++) ink[k] = share ? (data[i + k] - (1 - share) * paper[k]) / share : 0;
}
