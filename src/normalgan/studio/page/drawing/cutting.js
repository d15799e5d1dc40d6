/** Cutting: a worker that cuts a piece out of a picture, so that the page stays responsive. */

import { paperUnder } from "./inpainting.js";

/** @typedef {{left: number, top: number, right: number, bottom: number}} Rect in pixels of the picture */
/**
 * @typedef {{id: number, pixels: Uint8ClampedArray<ArrayBuffer>, width: number, inside: Uint8Array, box: Rect, paper: number[] | null}} CutRequest
 *   pixels: RGBA; inside: above 0 for the pixels of the box that are cut out; paper: its colour, null if there is none
 * @typedef {{id: number, rest: string, piece: string, rect: Rect | null}} Answer data URLs; rect: where the piece lies, null if
 *   there is no ink
 */

/** Empty margin around a piece in pixels, so that its edge looks the same at every size. */
const EMPTY = 2;
/** Margin in pixels around a cut in which the paper is sampled. */
const AROUND = 48;

addEventListener("message", async ({ data }) => {
  postMessage(await part(/** @type {CutRequest} */ (data)));
});

/** @param {CutRequest} request @returns {Promise<Answer>} */
async function part({ id, pixels, width, inside, box, paper }) {
  const height = pixels.length / 4 / width;
  const frame = grown(box, AROUND, width, height);
  const [wide, high] = [frame.right - frame.left, frame.bottom - frame.top];
  const seen = new Uint8ClampedArray(4 * wide * high);
  const place = (/** @type {number} */ row) => 4 * ((row + frame.top) * width + frame.left);
  for (let row = 0; row < high; row++) seen.set(pixels.subarray(place(row), place(row) + 4 * wide), 4 * row * wide);
  const under = paper && paperUnder(seen, wide, high, paper);
  const piece = new Uint8ClampedArray(seen.length);
  const found = { left: width, top: height, right: 0, bottom: 0 };
  for (let y = box.top; y < box.bottom; y++) {
    for (let x = box.left; x < box.right; x++) {
      const i = (y - frame.top) * wide + x - frame.left;
      if (!inside[(y - box.top) * (box.right - box.left) + x - box.left] || (under && !under.isInk[i])) continue;
      const at = 4 * (y * width + x);
      if (under) takeOff(seen, under.ground, 4 * i, piece);
      else piece.set(seen.subarray(4 * i, 4 * i + 4), 4 * i);
      if (!piece[4 * i + 3]) continue;
      for (let c = 0; c < 4; c++) pixels[at + c] = under ? under.ground[4 * i + c] : 0;
      found.left = Math.min(found.left, x);
      found.right = Math.max(found.right, x + 1);
      found.top = Math.min(found.top, y);
      found.bottom = Math.max(found.bottom, y + 1);
    }
  }
  if (found.left >= found.right) return { id, rest: "", piece: "", rect: null };
  const rect = grown(found, EMPTY, width, height);
  const cut = new ImageData(piece, wide);
  return {
    id, rect, rest: await encoded(new ImageData(pixels, width), 0, 0, width, height),
    piece: await encoded(cut, frame.left - rect.left, frame.top - rect.top, rect.right - rect.left, rect.bottom - rect.top),
  };
}

/** @param {Rect} rect @param {number} by @param {number} width @param {number} height @returns {Rect} */
const grown = ({ left, top, right, bottom }, by, width, height) =>
  ({ left: Math.max(0, left - by), top: Math.max(0, top - by), right: Math.min(width, right + by), bottom: Math.min(height, bottom + by) });

/** @param {ImageData} pixels @param {number} x where they lie @param {number} y @param {number} width of the PNG @param {number} height @returns {Promise<string>} a data URL */
async function encoded(pixels, x, y, width, height) {
  const canvas = new OffscreenCanvas(width, height);
  /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d", { willReadFrequently: true })).putImageData(pixels, x, y);
  const blob = await canvas.convertToBlob({ type: "image/png" });
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(blob);
  });
}

/**
 * Separates ink from its paper, so that the ink looks the same when drawn over that paper.
 * @param {Uint8ClampedArray} data opaque @param {Uint8ClampedArray} paper @param {number} i @param {Uint8ClampedArray} ink red, green, blue, opacity
 */
function takeOff(data, paper, i, ink) {
  let alpha = 0;
  for (let k = 0; k < 3; k++) {
    const [from, to] = [paper[i + k], data[i + k]];
    alpha = Math.max(alpha, to < from ? (from - to) / from : to > from ? (to - from) / (255 - from) : 0);
  }
  ink[i + 3] = Math.ceil(255 * alpha - 1e-6); // rounding must not increase the opacity
  const share = ink[i + 3] / 255;
  for (let k = 0; k < 3; k++) ink[i + k] = share ? (data[i + k] - (1 - share) * paper[i + k]) / share : 0;
}
