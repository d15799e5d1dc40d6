/** Context: the parts of a drawing as the network sees them among the others, as normalgan.inference.composites.context has it. */

import { frameAround, shown } from "./prepare.js";

/** @typedef {import("./prepare.js").Prepared} Prepared */

/** Below this share of enclosed lines the network has a say in what is object. */
const CLOSED = 0.8;

/**
 * Returns parts of a drawing with all their lines as what the network is shown; the object of a part hides what is behind it.
 * @param {Prepared[]} parts the hindmost first @param {[number, number]} widths of lines that the network knows
 * @returns {Prepared[]}
 */
export function inContext(parts, widths) {
  const { width, height } = parts[0];
  if (parts.length < 2 || parts.some((each) => each.width !== width || each.height !== height)) return parts;
  let { ink } = parts[0];
  for (const { ink: lines, mask } of parts.slice(1)) {
    const behind = ink;
    ink = lines.map((value, i) => (mask?.[i] ? value : Math.max(value, behind[i])));
  }
  const frame = frameAround(ink, width, height, parts[0].frame.size);
  if (!frame) return parts;
  const seen = shown(ink, width, height, frame, widths);
  return parts.map((each) => (each.mask && each.closed >= CLOSED ? { ...each, frame, seen } : each));
}
