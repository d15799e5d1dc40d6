/** Paper tone: tells the lines of a picture from its paper, which may be photographed, unevenly lit, or darker than they are. */

import { context2d } from "./canvas.js";
import { WHITE, hasPaper, inkAt, kindOf } from "./ink.js";
import { largest, paperOf, radiusOf, turned } from "./paper_ground.js";
import { decodeAll, decoded } from "./pictures.js";

/** Minimum darkness of a line compared with the paper around it: 0 as the paper, 1 as the darkest ink. */
const INKED = 0.35;
/** Share of a picture's pixels that are its darkest ink. */
const DARKEST = 0.005;
/** Minimum difference between paper and ink in levels; less is grain. */
const CONTRAST = 48;
/** Areas wider than a line are ink too if they are about as dark as the darkest ink, as a share of its darkness. */
const FILLED = 0.25;
/** Longer side in pixels at which lines on photographed paper are measured. */
const LINES_SIDE = 512;
/** Pixels of the drawing left around lines on photographed paper. */
const ROOM = 8;

/** Returns the values below which these shares of all lie. @param {Float32Array | Uint8Array} values @param {number[]} shares */
function quantiles(values, shares) {
  const sorted = values.toSorted();
  return shares.map((share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))]);
}

/**
 * Returns the number of pixels close to a line, and how many of them are dark: if most are, lines are lighter than the paper,
 * since most of what lies close to a line is paper.
 * @param {Uint8Array} levels @param {Uint8Array} high the largest within a distance @param {Uint8Array} low the smallest
 */
function nearLines(levels, high, low) {
  let [near, dark] = [0, 0];
  for (let i = 0; i < levels.length; i++) {
    if (high[i] - low[i] <= CONTRAST) continue;
    near += 1;
    if (2 * levels[i] < high[i] + low[i]) dark += 1;
  }
  return { near, dark };
}

/** Returns the levels of a picture on white paper, and the largest and smallest ones within a line's width. @param {Uint8Array | Uint8ClampedArray} bytes @param {number} width @param {number} height */
function rangesOf(bytes, width, height) {
  const seen = Uint8Array.from({ length: width * height }, (_, i) => {
    const [red, green, blue, alpha] = bytes.subarray(4 * i, 4 * i + 4);
    return 255 - ((255 - Math.min(red, green, blue)) * alpha) / 255;
  });
  const radius = radiusOf(width, height);
  return { seen, radius, high: largest(seen, width, height, radius), low: turned(largest(turned(seen), width, height, radius)) };
}

/**
 * Returns where a drawing has lines, of any colour.
 * @param {{channels: 1 | 4, bytes: Uint8Array}} pixels @param {number} width @param {number} height
 * @returns {Uint8Array} 1 on lines
 */
export function linesIn({ channels, bytes }, width, height) {
  if (channels === 1) return bytes.map((level) => Number(255 - level > INKED * 255));
  const { seen, radius, high, low } = rangesOf(bytes, width, height);
  const { near, dark } = nearLines(seen, high, low);
  const light = dark > near / 2;
  const levels = light ? turned(seen) : seen;
  const paper = turned(largest(light ? low : turned(high), width, height, radius));
  // A shadow darkens paper and ink by the same factor.
  const darkness = Float32Array.from(levels, (level, i) => 1 - (level + 1) / (paper[i] + 1));
  const [darkest] = quantiles(darkness, [1 - DARKEST]);
  const least = INKED * Math.max(darkest, CONTRAST / 255);
  const [ink, usual] = quantiles(levels, [DARKEST, 0.5]);
  const filled = usual - ink > CONTRAST ? ink + FILLED * (usual - ink) : -1;
  return levels.map((level, i) => Number(darkness[i] > least || level < filled));
}

/** Maximum share of a transparent picture that is darker than `PALE`, if the picture cannot be seen on white paper. */
const SEEN = 0.005;
const PALE = 204;

/**
 * Returns a picture with dark lines; a light-on-dark picture is inverted, because black strokes would not show on it, and so
 * are light lines on nothing, which would not show on white paper.
 * @param {string} url a data URL, decoded
 * @param {boolean} [sheet] whether it may have dark paper
 * @returns {Promise<string>} a data URL, decoded
 */
export async function darkOnLight(url, sheet = true) {
  const image = decoded(url);
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width, image.height];
  const context = context2d(canvas, { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
  let [light, seen, dark] = [0, 0, 0];
  for (let i = 0; i < pixels.data.length; i += 4) {
    const level = pixels.data[i] + pixels.data[i + 1] + pixels.data[i + 2];
    light += level * pixels.data[i + 3];
    seen += 765 * pixels.data[i + 3];
    if (level < 3 * PALE) dark += 765 * pixels.data[i + 3];
  }
  // Dark lines on a transparent background must not be inverted, only dark paper that covers most of the picture, or a grey board.
  const covered = seen / (765 * 255 * canvas.width * canvas.height);
  const darkPaper = sheet && covered >= 0.6 && (light / seen <= 0.4 || isBoard(image));
  const unseen = covered < 0.6 && dark < SEEN * seen;
  if (!darkPaper && !unseen) return url;
  for (let i = 0; i < pixels.data.length; i++) if (i % 4 < 3) pixels.data[i] = 255 - pixels.data[i];
  context.putImageData(pixels, 0, 0);
  const inverted = canvas.toDataURL("image/png");
  await decodeAll([inverted]);
  return inverted;
}

/** Maximum share of a board that is close to lines, and minimum share of that which is darker than they are; a painting has other ones. */
const BOARD = { near: 0.5, dark: 0.65 };

/** Whether a picture shows light lines on an even board, which may be grey. @param {HTMLImageElement} image */
function isBoard(image) {
  const scale = Math.min(1, LINES_SIDE / Math.max(image.width, image.height));
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width, image.height].map((side) => Math.max(1, Math.round(side * scale)));
  const { width, height } = canvas;
  const context = context2d(canvas, { willReadFrequently: true });
  context.imageSmoothingQuality = "high";
  context.drawImage(image, 0, 0, width, height);
  const { seen, high, low } = rangesOf(context.getImageData(0, 0, width, height).data, width, height);
  const { near, dark } = nearLines(seen, high, low);
  return near < BOARD.near * seen.length && dark > BOARD.dark * near;
}

/**
 * Returns the paper of a layer's pictures as a small canvas in inverted colours, which "color-dodge" makes white.
 * @param {import("./ink.js").Drawn} drawn
 * @returns {HTMLCanvasElement | null} null if no paper hides what is below it
 */
export function invertedPaper(drawn) {
  const pictures = drawn.strokes.filter(({ kind }) => kind === "picture");
  if (!hasPaper(pictures)) return null;
  const canvas = paperOf({ ...drawn, strokes: pictures });
  const context = context2d(canvas);
  context.globalCompositeOperation = "difference";
  context.fillStyle = "#fff";
  context.fillRect(0, 0, canvas.width, canvas.height);
  return canvas;
}

/**
 * Returns the bounding box of everything drawn on visible layers, clipped to the paper; on photographed paper the lines count.
 * @param {import("./document.js").Doc} doc
 * @returns {import("./ink.js").Box | null} in whole pixels; null if nothing is drawn
 */
export function drawnBox({ width, height, layers }) {
  const boxes = layers.filter(({ visible }) => visible).flatMap(({ strokes }) => boxOfLayer({ width, height, strokes }) ?? []);
  if (!boxes.length) return null;
  const ends = (/** @type {(box: import("./ink.js").Box) => number} */ end) => boxes.map(end);
  return {
    left: Math.min(...ends(({ left }) => left)), top: Math.min(...ends(({ top }) => top)),
    right: Math.max(...ends(({ right }) => right)), bottom: Math.max(...ends(({ bottom }) => bottom)),
  };
}

/** @param {import("./ink.js").Drawn} drawn */
function boxOfLayer({ width, height, strokes }) {
  const longest = Math.max(width, height);
  const { channels, bytes } = inkAt({ width, height, strokes }, longest).pixels();
  const { onPaper } = kindOf(strokes);
  const marked = Uint8Array.from({ length: width * height }, (_, i) => {
    if (channels === 1) return Number(bytes[i] <= WHITE);
    if (!onPaper) return Number(bytes[4 * i + 3] >= 255 - WHITE);
    return Number(Math.min(bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2]) <= WHITE);
  });
  const whitePaper = channels === 1 || !onPaper || marked.reduce((sum, each) => sum + each, 0) < marked.length / 2;
  if (whitePaper) return boxOf(marked, width);
  const { canvas, pixels } = inkAt({ width, height, strokes }, Math.min(LINES_SIDE, longest));
  const found = boxOf(linesIn(pixels(), canvas.width, canvas.height), canvas.width);
  if (!found) return boxOf(marked, width); // an area of paint
  const [across, down] = [width / canvas.width, height / canvas.height];
  return {
    left: Math.max(0, Math.floor(found.left * across) - ROOM), top: Math.max(0, Math.floor(found.top * down) - ROOM),
    right: Math.min(width, Math.ceil(found.right * across) + ROOM), bottom: Math.min(height, Math.ceil(found.bottom * down) + ROOM),
  };
}

/** Returns the bounding box of marked pixels, or null if there are none. @param {Uint8Array} marked @param {number} width @returns {import("./ink.js").Box | null} */
function boxOf(marked, width) {
  const box = { left: width, top: marked.length / width, right: 0, bottom: 0 };
  marked.forEach((on, at) => {
    if (!on) return;
    const [x, y] = [at % width, Math.floor(at / width)];
    [box.left, box.right] = [Math.min(box.left, x), Math.max(box.right, x + 1)];
    [box.top, box.bottom] = [Math.min(box.top, y), Math.max(box.bottom, y + 1)];
  });
  return box.right > box.left ? box : null;
}
