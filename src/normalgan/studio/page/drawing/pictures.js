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
