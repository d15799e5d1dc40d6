/** Strokes: draw a pen's points piece by piece as a line whose width follows the pressure. */

import { context2d } from "./canvas.js";

/** @typedef {import("./document.js").Stroke} Stroke */

/** Width in pixels at a pressure; a mouse has 0.5. @param {number} size @param {number} pressure */
export const widthAt = (size, pressure) => size * (0.25 + 1.5 * pressure);

const ALIKE = 0.05;

/** @param {number[]} points @param {number} i */
const at = (points, i) => ({ x: points[3 * i], y: points[3 * i + 1], p: points[3 * i + 2] });
/** @typedef {{x: number, y: number, p: number}} Point p: pressure */
/** @param {Point} a @param {Point} b @returns {Point} */
const middle = (a, b) => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, p: (a.p + b.p) / 2 });

/**
 * Returns a line, and its mirror image if it has one.
 * @param {import("./document.js").Line} line
 * @param {number} [from] the first point that is needed
 * @returns {{size: number, points: number[]}[]}
 */
export function sidesOf(line, from = 0) {
  const { mirror } = line;
  if (mirror === undefined) return [line];
  const points = line.points.map((value, i) => (i % 3 || i < 3 * from ? value : 2 * mirror - value));
  return [line, { size: line.size, points }];
}

/**
 * Draws the piece of a stroke around point i, between the midpoints to its neighbours.
 * @param {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} context in pixels of the drawing
 * @param {{size: number, points: number[]}} line
 * @param {number} i
 * @param {boolean} last whether the stroke ends with this point
 */
export function drawPiece(context, line, i, last) {
  const point = at(line.points, i);
  const from = i === 0 ? point : middle(at(line.points, i - 1), point);
  const to = last ? point : middle(point, at(line.points, i + 1));
  const [first, end] = [widthAt(line.size, from.p), widthAt(line.size, to.p)];
  const way = Math.hypot(point.x - from.x, point.y - from.y) + Math.hypot(to.x - point.x, to.y - point.y);
  // A canvas strokes with constant width, so varying width is drawn in short straight parts.
  const parts = Math.abs(first - end) < ALIKE ? 1 : Math.max(2, Math.ceil(way / 1.5));
  /** @type {{x: number, y: number}} */
  let start = from;
  for (let k = 1; k <= parts; k++) {
    const t = k / parts;
    const s = 1 - t;
    const stop = {
      x: s * s * from.x + 2 * s * t * point.x + t * t * to.x,
      y: s * s * from.y + 2 * s * t * point.y + t * t * to.y,
    };
    context.lineWidth = first + (end - first) * (t - 0.5 / parts);
    context.beginPath();
    context.moveTo(start.x, start.y);
    if (parts === 1) context.quadraticCurveTo(point.x, point.y, stop.x, stop.y);
    else context.lineTo(stop.x, stop.y);
    context.stroke();
    start = stop;
  }
}

/**
 * Returns points along the line as it is drawn.
 * @param {{size: number, points: number[]}} line @param {number} step pixels between them at most, about
 * @returns {Point[]}
 */
export function curveOf({ points }, step) {
  const count = points.length / 3;
  const curve = [at(points, 0)];
  for (let i = 0; i < count; i++) {
    const point = at(points, i);
    const from = curve[curve.length - 1];
    const to = i === count - 1 ? point : middle(point, at(points, i + 1));
    const parts = Math.ceil((Math.hypot(point.x - from.x, point.y - from.y) + Math.hypot(to.x - point.x, to.y - point.y)) / step);
    for (let k = 1; k <= parts; k++) {
      const [t, s] = [k / parts, 1 - k / parts];
      const mixed = (/** @type {"x" | "y"} */ side) => s * s * from[side] + 2 * s * t * point[side] + t * t * to[side];
      curve.push({ x: mixed("x"), y: mixed("y"), p: from.p + t * (to.p - from.p) });
    }
  }
  return curve;
}

/**
 * Prepares a context for the pieces of a stroke.
 * @param {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} context
 * @param {Stroke["kind"]} kind
 * @param {string} [colour]
 * @param {CanvasPattern | null} [paper] what an eraser leaves of a picture on paper
 */
export function prepare(context, kind, colour = "#000", paper = null) {
  const erased = paper ? "source-atop" : "destination-out";
  context.globalCompositeOperation = kind === "eraser" ? erased : "source-over";
  context.lineCap = "round";
  context.lineJoin = "round";
  context.strokeStyle = kind === "eraser" && paper ? paper : colour;
}

/**
 * Draws a picture where it is placed.
 * @param {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} context
 * @param {CanvasImageSource} image
 * @param {import("./document.js").Box} box
 */
export function drawPicture(context, image, { x, y, width, height, turn = 0, flipped = false }) {
  if (!turn && !flipped) {
    context.drawImage(image, x, y, width, height);
    return;
  }
  context.save();
  context.translate(x + width / 2, y + height / 2);
  context.rotate(turn);
  context.scale(flipped ? -1 : 1, 1);
  context.drawImage(image, -width / 2, -height / 2, width, height);
  context.restore();
}

/** Returns the area of a fill. @param {import("./document.js").Line} fill */
export function pathOfFill({ points }) {
  const path = new Path2D();
  for (let i = 0; i < points.length; i += 3) path.lineTo(points[i], points[i + 1]);
  path.closePath();
  return path;
}

/** Whether a point lies in the area of a fill. @param {import("./document.js").Line} fill @param {{x: number, y: number}} at */
export function isInFill(fill, { x, y }) {
  return context2d(document.createElement("canvas")).isPointInPath(pathOfFill(fill), x, y, "evenodd");
}

/**
 * Draws a whole stroke.
 * @param {CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D} context
 * @param {Stroke} stroke
 * @param {(url: string) => CanvasImageSource} image a decoded picture
 * @param {CanvasPattern | null} [paper] what an eraser leaves of a picture on paper
 */
export function drawStroke(context, stroke, image, paper = null) {
  prepare(context, stroke.kind, "colour" in stroke ? stroke.colour : undefined, paper);
  if (stroke.kind === "picture") {
    drawPicture(context, image(stroke.picture), stroke);
    return;
  }
  if (stroke.kind === "fill") {
    context.fillStyle = stroke.colour ?? "#000";
    context.fill(pathOfFill(stroke), "evenodd");
    return;
  }
  const count = stroke.points.length / 3;
  for (const line of sidesOf(stroke)) for (let i = 0; i < count; i++) drawPiece(context, line, i, i === count - 1);
}

/**
 * Returns the bounding box of the pieces of a stroke from a point on.
 * @param {{size: number, points: number[], mirror?: number}} line
 * @param {number} from
 */
export function boxOf(line, from) {
  const reach = widthAt(line.size, 1) / 2 + 1;
  const box = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };
  for (let i = 3 * from; i < line.points.length; i += 3) {
    const x = line.points[i];
    const other = line.mirror === undefined ? x : 2 * line.mirror - x;
    box.left = Math.min(box.left, x - reach, other - reach);
    box.right = Math.max(box.right, x + reach, other + reach);
    box.top = Math.min(box.top, line.points[i + 1] - reach);
    box.bottom = Math.max(box.bottom, line.points[i + 1] + reach);
  }
  return box;
}
