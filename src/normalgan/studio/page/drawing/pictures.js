/** Pictures: decode data URLs once, so that they can be drawn without waiting. */

import { text } from "../text/text.js";
import { context2d } from "./canvas.js";

/** @type {Map<string, HTMLImageElement>} */
const known = new Map();
/** @type {Map<string, boolean>} whether they have transparent parts */
const cutOut = new Map();

/** Frees all pictures but these. @param {Iterable<string>} urls */
export function keepOnly(urls) {
  const wanted = new Set(urls);
  for (const map of [known, cutOut]) for (const url of map.keys()) if (!wanted.has(url)) map.delete(url);
}

/** Frees pictures. @param {string[]} urls */
export function free(urls) {
  for (const url of urls) for (const map of [known, cutOut]) map.delete(url);
}

/**
 * Decodes pictures.
 * @param {string[]} urls data URLs
 * @returns {Promise<string[]>} those that were not decoded before
 * @throws {Error} with a message if one cannot be read.
 */
export async function decodeAll(urls) {
  /** @type {string[]} */
  const fresh = [];
  for (const url of urls) {
    if (known.has(url)) continue;
    const image = new Image();
    image.src = url;
    try {
      await image.decode();
    } catch {
      throw new Error(text.badPicture);
    }
    known.set(url, image);
    fresh.push(url);
  }
  return fresh;
}

/** Returns a picture that was decoded. @param {string} url @returns {HTMLImageElement} */
export function decoded(url) {
  return /** @type {HTMLImageElement} */ (known.get(url));
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
  // Dark lines on a transparent background must not be inverted, only dark paper that covers most of the picture.
  const covered = seen / (765 * 255 * canvas.width * canvas.height);
  const darkPaper = sheet && covered >= 0.6 && light / seen <= 0.4;
  const unseen = covered < 0.6 && dark < SEEN * seen;
  if (!darkPaper && !unseen) return url;
  for (let i = 0; i < pixels.data.length; i++) if (i % 4 < 3) pixels.data[i] = 255 - pixels.data[i];
  context.putImageData(pixels, 0, 0);
  const turned = canvas.toDataURL("image/png");
  await decodeAll([turned]);
  return turned;
}

/** Returns whether a decoded picture has transparent parts. @param {string} url @returns {boolean} */
export function hasHoles(url) {
  const before = cutOut.get(url);
  if (before !== undefined) return before;
  const small = document.createElement("canvas");
  small.width = small.height = 64;
  const context = context2d(small, { willReadFrequently: true });
  context.drawImage(decoded(url), 0, 0, 64, 64);
  const holes = context.getImageData(0, 0, 64, 64).data.some((value, i) => i % 4 === 3 && value < 128);
  cutOut.set(url, holes);
  return holes;
}
