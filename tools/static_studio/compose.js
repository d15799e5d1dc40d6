/** Compose: combines the maps of layers, each predicted separately, like normalgan.inference.composites.composition in Python. */

import { distance, opposite } from "./raster.js";

/** @typedef {{normals: Float32Array, mask: Uint8Array, covered: Float32Array, width: number, height: number, confidence: Float32Array | null}} LayerMap
 *   x, y, z of each pixel, the object, its coverage of each pixel, and the model's κ */

/**
 * Returns one map, in which front layers hide those behind; off all layers, the nearest layer's normals continue.
 * @param {LayerMap[]} maps of one size, from back to front
 * @returns {LayerMap}
 */
export function compose(maps) {
  const [back, ...others] = maps;
  if (!others.length) return back;
  const { width, height } = back;
  const [normals, mask, covered] = [back.normals.slice(), back.mask.slice(), back.covered.slice()];
  const confidence = maps.every((each) => each.confidence) ? back.confidence?.slice() ?? null : null;
  for (const front of others) {
    for (let i = 0; i < mask.length; i++) {
      covered[i] = front.covered[i] + (1 - front.covered[i]) * covered[i];
      if (!front.mask[i]) continue;
      mask[i] = 1;
      if (confidence && front.confidence) confidence[i] = front.confidence[i];
      for (let c = 3 * i; c < 3 * i + 3; c++) normals[c] = front.normals[c];
    }
  }
  const away = maps.map((each) => distance(opposite(each.mask), width, height));
  for (let i = 0; i < mask.length; i++) {
    if (mask[i]) continue;
    let nearest = 0;
    for (let k = 1; k < maps.length; k++) if (away[k][i] < away[nearest][i]) nearest = k;
    for (let c = 3 * i; c < 3 * i + 3; c++) normals[c] = maps[nearest].normals[c];
  }
  return { normals, mask, covered, width, height, confidence };
}
