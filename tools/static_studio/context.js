/** Context: the parts of a drawing, each alone or among the others, like normalgan.inference.composites.layer_context in Python. */

import { frameAround, shown, shrunk } from "./prepare.js";
import { above } from "./raster.js";
import { doubt } from "./suggest.js";

/** @typedef {import("./prepare.js").Prepared} Prepared */

/**
 * Returns each part of a drawing alone, and then among the others; the object of a part hides the parts behind it.
 * @param {Prepared[]} parts from back to front @param {[number, number]} widths of lines that the network knows
 * @returns {Prepared[][]}
 */
export function waysToSee(parts, widths) {
  const alone = parts.map((each) => [each]);
  const { width, height } = parts[0] ?? {};
  if (parts.length < 2 || parts.some((each) => each.width !== width || each.height !== height)) return alone;
  let { ink } = parts[0];
  for (const { ink: lines, mask } of parts.slice(1)) {
    const behind = ink;
    ink = lines.map((value, i) => (mask?.[i] ? value : Math.max(value, behind[i])));
  }
  const frame = frameAround(ink, width, height, parts[0].frame.size);
  if (!frame) return alone;
  const seen = shown(ink, width, height, frame, widths);
  return parts.map((each) => (each.mask ? [each, { ...each, frame, seen }] : [each]));
}

/** Returns the mean error that the network expects on a part's object. @param {Prepared} part @param {Float32Array} confidence */
export function expectedError({ mask, width, height, frame }, confidence) {
  if (!mask) return 0;
  const inside = above(shrunk(mask, width, height, frame), 0.5);
  let [sum, count] = [0, 0];
  for (let i = 0; i < confidence.length; i++) {
    if (!inside[i]) continue;
    sum += doubt(confidence[i]);
    count++;
  }
  return count ? sum / count : 0;
}
