/** Painted: what is wide and dark in a drawing is no line, as normalgan.inference's paper and painted areas have it for grey. */

import { SQUARE, components, eroded, extreme, median, quantile, where } from "./raster.js";

/** @typedef {{painted: Uint8Array, paper: Float32Array, step: Uint8Array}} Painted where it is painted, the paper, and where it gets darker within a few pixels */

/** What is wide and darker than this share of the sheet is painted. */
const PAINTED = 0.8;
/** How much darker a painted area is than what lies a few pixels beside it; and levels that are one paint. */
const STEP = 0.12;
const MOST = 12;

/**
 * Returns where a drawing is painted, and the paper with painted areas as wide as they are.
 * @param {Float32Array} dark the drawing @param {Float32Array} lightest the lightest level about each pixel
 * @param {number} width @param {number} height @param {number} level that of the sheet
 * @returns {Painted}
 */
export function paintedAreas(dark, lightest, width, height, level) {
  const wide = where(lightest, (value) => Math.fround(value / level) < Math.fround(PAINTED));
  if (!wide.includes(1)) return { painted: wide, paper: lightest, step: wide }; // as in most drawings
  const relative = dark.map((value) => value / level);
  const [lighter, darker] = [extreme(relative, width, height, 3, 1), extreme(relative, width, height, 3, -1)];
  const step = where(lighter, (value, i) => Math.fround(value - darker[i]) > Math.fround(STEP));
  const painted = new Uint8Array(wide.length);
  const paper = lightest.slice();
  const { labels, boxes } = components(wide, width, height, 4);
  const largest = boxes.map((box, label) => ({ label, area: box.area })).slice(1)
    .sort((one, other) => other.area - one.area).slice(0, MOST).filter(({ area }) => area > 16);
  for (const { label } of largest) {
    const own = where(labels, (value) => value === label);
    const inner = eroded(own, width, height, SQUARE);
    let [edge, sharp] = [0, 0];
    /** @type {number[]} */
    const colours = [];
    for (let i = 0; i < own.length; i++) {
      if (!own[i]) continue;
      colours.push(dark[i]);
      if (!inner[i]) [edge, sharp] = [edge + 1, sharp + step[i]];
    }
    if (edge && sharp / edge < 0.5) continue; // shaded
    const paint = median(colours);
    const alike = where(dark, (value, i) => Math.abs(Math.fround(value - paint)) < Math.fround(STEP) && relative[i] < Math.fround(PAINTED));
    const parts = components(where(own, (value, i) => value > 0 || alike[i] > 0), width, height, 4).labels;
    const whole = parts[own.indexOf(1)]; // it hangs together
    for (let i = 0; i < parts.length; i++) {
      if (parts[i] !== whole) continue;
      painted[i] = 1;
      if (alike[i]) paper[i] = Math.min(paper[i], Math.max(paint, dark[i]));
    }
  }
  return { painted, paper, step };
}

/** Returns the level of the sheet, given that of the paper about each pixel. @param {Float32Array} paper */
export function sheetLevel(paper) {
  const [usual, lightest] = [quantile(paper), quantile(paper, 0.95)];
  // Where more than half is painted, the median is paint.
  return Math.fround(Math.max(usual < 0.7 * lightest ? lightest : usual, 0.04));
}
