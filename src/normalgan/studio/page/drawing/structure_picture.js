/** Structure picture: turn a picture, for example of cloth or bark, into a seamless grey tile. */

import { context2d } from "./canvas.js";
import { LIMITS } from "./limits.js";

const { tile: SIDE } = LIMITS;
/** Width in pixels of the band in which two edges fade into the opposite ones. */
const MARGIN = SIDE / 4;
/** Maximum ratio of the change across opposite edges to the change inside for a picture that already repeats. */
const SEAM = 1.5;
/** Radius in pixels for evening out the lighting of a photo. */
const EVENED = (3 * SIDE) / 8;
/** Fraction of pixels that become black and white in the tile, and minimum difference between the two in levels. */
const [CLIPPED, FLAT] = [0.01, 6];

/**
 * Returns a tile of the middle of a picture: a data URL of a grey PNG, white is high.
 * @param {CanvasImageSource & {width: number, height: number}} image
 * @returns {string | null} null if the picture is uniform
 */
export function tileFrom(image) {
  const whole = greyOf(image, SIDE);
  const values = evened(repeats(whole) ? whole : faded(greyOf(image, SIDE + MARGIN)));
  const sorted = values.toSorted();
  const [low, high] = [CLIPPED, 1 - CLIPPED].map((share) => sorted[Math.floor(share * (sorted.length - 1))]);
  if (high - low < FLAT) return null;
  const canvas = canvasOf(SIDE);
  const pixels = new ImageData(SIDE, SIDE);
  values.forEach((value, i) => pixels.data.set([0, 0, 0].fill((255 * (value - low)) / (high - low)).concat(255), 4 * i));
  context2d(canvas).putImageData(pixels, 0, 0);
  return canvas.toDataURL("image/png");
}

/** @param {number} side */
function canvasOf(side) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [side, side];
  return canvas;
}

/** Returns the middle of a picture, grey, on white. @param {CanvasImageSource & {width: number, height: number}} image @param {number} side */
function greyOf(image, side) {
  const { width, height } = image;
  const least = Math.min(width, height);
  const context = context2d(canvasOf(side), { willReadFrequently: true });
  context.fillStyle = "#fff";
  context.fillRect(0, 0, side, side);
  context.imageSmoothingQuality = "high";
  context.drawImage(image, (width - least) / 2, (height - least) / 2, least, least, 0, 0, side, side);
  const { data } = context.getImageData(0, 0, side, side);
  return Float32Array.from({ length: side * side }, (_, i) => 0.2126 * data[4 * i] + 0.7152 * data[4 * i + 1] + 0.0722 * data[4 * i + 2]);
}

/** Whether a picture already repeats at opposite edges. @param {Float32Array} values */
function repeats(values) {
  return [1, SIDE].every((step) => {
    const [along, last] = [step === 1 ? SIDE : 1, (SIDE - 1) * step];
    let [seam, inside] = [0, 0];
    for (let i = 0; i < SIDE; i++) {
      seam += Math.abs(values[i * along] - values[i * along + last]);
      for (let k = 1; k < SIDE; k++) inside += Math.abs(values[i * along + k * step] - values[i * along + (k - 1) * step]) / (SIDE - 1);
    }
    return seam <= SEAM * inside;
  });
}

/** Fades what lies beyond two edges of a larger picture into the opposite ones. @param {Float32Array} larger */
function faded(larger) {
  const wide = SIDE + MARGIN;
  /** @param {number} at */
  const share = (at) => Math.min((at + 0.5) / MARGIN, 1);
  const across = new Float32Array(SIDE * wide);
  for (let y = 0; y < wide; y++) {
    for (let x = 0; x < SIDE; x++) across[y * SIDE + x] = share(x) * larger[y * wide + x] + (1 - share(x)) * (larger[y * wide + x + SIDE] ?? 0);
  }
  return Float32Array.from({ length: SIDE * SIDE }, (_, i) => {
    const part = share(Math.floor(i / SIDE));
    return part * across[i] + (1 - part) * (across[i + SIDE * SIDE] ?? 0);
  });
}

/** Subtracts the local mean from each pixel. @param {Float32Array} values */
function evened(values) {
  let mean = values;
  for (const step of [1, SIDE, 1, SIDE]) {
    const [before, along] = [mean, step === 1 ? SIDE : 1];
    mean = new Float32Array(values.length);
    for (let line = 0; line < SIDE; line++) {
      let sum = 0;
      /** @param {number} k */
      const at = (k) => line * along + ((k + SIDE) % SIDE) * step;
      for (let k = -EVENED; k <= EVENED; k++) sum += before[at(k)];
      for (let k = 0; k < SIDE; k++) {
        mean[at(k)] = sum / (2 * EVENED + 1);
        sum += before[at(k + EVENED + 1)] - before[at(k - EVENED)];
      }
    }
  }
  return values.map((value, i) => value - mean[i]);
}
