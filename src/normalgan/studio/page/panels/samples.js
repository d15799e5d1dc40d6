/** Samples: drawings to start from, made of ordinary editable lines. */

import { context2d } from "../drawing/canvas.js";
import { newDocument, withActive } from "../drawing/document.js";
import { drawStroke } from "../drawing/strokes.js";
import { $, label, make } from "../elements/dom.js";
import { say, text } from "../text/text.js";

const SIDE = 512;
const SMALL = 72;
/** Number of interpolated points between two points of a sample. */
const PARTS = 6;
const PEN = 6;
/** Movement in pixels at which a press on a sample becomes a stroke. */
const STIRRED = 8;

/**
 * @typedef {{points: number[], closed?: boolean, mirrored?: boolean, size?: number}} Curve through x, y, x, y, …
 * @typedef {{name: keyof typeof text, curves: Curve[]}} Sample
 */

/** @type {Sample[]} */
export const SAMPLES = [
  {
    name: "sampleMushroom",
    curves: [
      { points: [90, 268, 110, 170, 180, 104, 262, 92, 346, 112, 410, 176, 424, 266, 396, 292, 340, 284, 256, 276, 170, 286, 116, 292], closed: true },
      { points: [204, 284, 212, 340, 196, 400, 178, 430, 212, 452, 264, 456, 316, 450, 338, 428, 318, 398, 306, 340, 312, 284] },
      { points: [196, 170, 218, 156, 238, 168, 232, 188, 206, 190], closed: true, size: 5 },
      { points: [304, 156, 328, 142, 350, 158, 346, 186, 318, 190], closed: true, size: 5 },
      { points: [252, 222, 274, 212, 290, 226, 280, 244, 256, 242], closed: true, size: 5 },
    ],
  },
  {
    name: "sampleVase",
    curves: [
      { points: [256, 74, 232, 74, 206, 77, 184, 88, 206, 104, 214, 140, 188, 188, 144, 250, 134, 320, 160, 390, 196, 430, 200, 448, 226, 453, 256, 454], mirrored: true },
      { points: [256, 104, 236, 104, 216, 101, 202, 94], mirrored: true, size: 4 },
      { points: [256, 248, 230, 247, 196, 242, 153, 231], mirrored: true, size: 4 },
      { points: [256, 280, 228, 279, 190, 273, 142, 262], mirrored: true, size: 4 },
    ],
  },
  {
    name: "sampleFish",
    curves: [
      { points: [70, 262, 120, 196, 206, 158, 296, 168, 366, 220, 404, 236, 452, 176, 446, 262, 456, 344, 402, 290, 362, 308, 290, 352, 200, 356, 118, 320], closed: true },
      { points: [180, 166, 222, 112, 296, 106, 318, 178] },
      { points: [176, 186, 196, 224, 198, 286, 178, 330], size: 5 },
      { points: [228, 262, 276, 250, 306, 272, 286, 300, 240, 296], size: 5 },
      { points: [118, 236, 128, 226, 140, 236, 130, 248], closed: true, size: 5 },
      { points: [78, 274, 100, 280, 116, 276], size: 4 },
    ],
  },
];

/**
 * Returns a smooth line through points: uniform Catmull-Rom.
 * @param {Curve} curve
 * @returns {import("../drawing/document.js").Line}
 */
function lineOf({ points, closed = false, mirrored = false, size = PEN }) {
  const count = points.length / 2;
  const at = (/** @type {number} */ i) => {
    const k = closed ? (i + count) % count : Math.max(0, Math.min(count - 1, i));
    return [points[2 * k], points[2 * k + 1]];
  };
  /** @type {number[]} */
  const line = [];
  const last = closed ? count : count - 1;
  for (let i = 0; i < last; i++) {
    const [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
    for (let part = 0; part < PARTS; part++) {
      const t = part / PARTS;
      const value = (/** @type {number} */ k) =>
        0.5 * (2 * b[k] + (c[k] - a[k]) * t + (2 * a[k] - 5 * b[k] + 4 * c[k] - d[k]) * t * t + (3 * b[k] - a[k] - 3 * c[k] + d[k]) * t ** 3);
      line.push(Math.round(100 * value(0)) / 100, Math.round(100 * value(1)) / 100, 0.5);
    }
  }
  line.push(...at(last), 0.5);
  return { kind: "pen", size, points: line, ...(mirrored && { mirror: SIDE / 2 }) };
}

/** Returns a sample as a document of its own. @param {Sample} sample @returns {import("../drawing/document.js").Doc} */
export function documentOf({ curves }) {
  return withActive(newDocument(SIDE, SIDE), { strokes: curves.map(lineOf) });
}

/** Lets strokes start on an element that covers the paper. @param {HTMLElement} above */
function letDraw(above) {
  /** @type {PointerEvent | null} */
  let pressed = null;
  above.addEventListener("pointerdown", (event) => { pressed = event; });
  above.addEventListener("pointerup", () => { pressed = null; });
  above.addEventListener("pointermove", ({ clientX, clientY }) => {
    if (!pressed || Math.hypot(clientX - pressed.clientX, clientY - pressed.clientY) < STIRRED) return;
    const begun = pressed;
    pressed = null;
    const { left, right, top, bottom } = $("board").getBoundingClientRect();
    const over = begun.clientX > left && begun.clientX < right && begun.clientY > top && begun.clientY < bottom;
    if (over) $("board").dispatchEvent(new PointerEvent("pointerdown", begun));
  });
}

/** Offers the samples on empty paper. @param {(doc: import("../drawing/document.js").Doc, name: string) => void} take */
export function offerSamples(take) {
  const buttons = SAMPLES.map((sample) => {
    const canvas = make("canvas", { width: SMALL, height: SMALL });
    const context = context2d(canvas);
    context.scale(SMALL / SIDE, SMALL / SIDE);
    const doc = documentOf(sample);
    for (const curve of sample.curves) drawStroke(context, { ...lineOf(curve), size: 2 * PEN }, () => canvas);
    const button = make("button", { type: "button" }, canvas);
    const name = /** @type {string} */ (text[sample.name]);
    label(button, say("takeSample", { name }));
    button.addEventListener("click", () => take(doc, name));
    letDraw(button);
    return button;
  });
  $("samples").replaceChildren(...buttons);
}
