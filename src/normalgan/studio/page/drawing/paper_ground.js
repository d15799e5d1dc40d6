/** Paper ground: the paper of a picture without its lines. */

import { context2d } from "./canvas.js";
import { decoded } from "./pictures.js";
import { drawStroke } from "./strokes.js";

/** Longer side in pixels at which the tone of the paper is measured. */
const SIDE = 256;
/** Lines of a picture are narrower than this share of its longer side. */
const WIDEST = 1 / 16;

/**
 * Returns the largest level within a distance of each pixel along rows and columns.
 * @param {Uint8Array} levels @param {number} width @param {number} height @param {number} radius
 */
export function largest(levels, width, height, radius) {
  let found = levels;
  // Loops without a function per pixel, since a large drawing has many.
  for (const [lines, between, length, step] of [[height, width, width, 1], [width, 1, height, width]]) {
    // The largest of `span` levels from each pixel on; doubled until two of them cover the distance.
    let ahead = found;
    let span = 1;
    for (; 2 * span <= 2 * radius + 1; span *= 2) {
      const longer = ahead.slice();
      for (let line = 0; line < lines; line++) {
        for (let place = 0, at = line * between; place + span < length; place++, at += step) {
          const other = ahead[at + span * step];
          if (other > longer[at]) longer[at] = other;
        }
      }
      ahead = longer;
    }
    const out = new Uint8Array(levels.length);
    for (let line = 0; line < lines; line++) {
      const start = line * between;
      for (let place = 0; place < length; place++) {
        const first = ahead[start + Math.max(place - radius, 0) * step];
        const last = ahead[start + Math.min(Math.max(place + radius + 1 - span, 0), length - 1) * step];
        out[start + place * step] = first > last ? first : last;
      }
    }
    found = out;
  }
  return found;
}

/** @param {Uint8Array} levels */
export const turned = (levels) => levels.map((level) => 255 - level);

/** Returns the paper under dark lines: the levels without anything dark that is narrower than twice the radius. @param {Uint8Array} levels @param {number} width @param {number} height @param {number} radius */
const paperUnder = (levels, width, height, radius) => turned(largest(turned(largest(levels, width, height, radius)), width, height, radius));

/** @param {number} width @param {number} height */
export const radiusOf = (width, height) => Math.max(2, Math.round((Math.max(width, height) * WIDEST) / 2));

/**
 * Returns the paper of pictures with dark lines as a small canvas; without a picture, paper is white.
 * @param {import("./ink.js").Drawn} drawn pictures only
 */
export function paperOf({ width, height, strokes }) {
  const canvas = document.createElement("canvas");
  const scale = Math.min(1, SIDE / Math.max(width, height));
  [canvas.width, canvas.height] = [width, height].map((side) => Math.max(1, Math.round(side * scale)));
  const context = context2d(canvas, { willReadFrequently: true });
  context.fillStyle = "#fff";
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.scale(canvas.width / width, canvas.height / height);
  context.imageSmoothingQuality = "high";
  for (const stroke of strokes) drawStroke(context, stroke, decoded);
  context.resetTransform();
  const image = context.getImageData(0, 0, canvas.width, canvas.height);
  const radius = radiusOf(canvas.width, canvas.height);
  for (let c = 0; c < 3; c++) {
    const levels = Uint8Array.from({ length: image.data.length / 4 }, (_, i) => image.data[4 * i + c]);
    paperUnder(levels, canvas.width, canvas.height, radius).forEach((level, i) => { image.data[4 * i + c] = level; });
  }
  context.putImageData(image, 0, 0);
  return canvas;
}
