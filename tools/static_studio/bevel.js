/** Bevel: makes a part of a map round, flat or hollow, like normalgan.inference.forms in Python. */

import { FORMS } from "./constants.js";
import { blurred, boxOf, distance, opposite, part as cut, resized, where } from "./raster.js";

/** @typedef {import("./drawing/document.js").Form} Form */

const { COARSE, DISH, OUTSIDE, SIDE, SWEEPS } = FORMS;

/**
 * Gives a part of a map a form, in place.
 * @param {{normals: Float32Array, mask: Uint8Array, width: number, height: number}} map
 * @param {Float32Array} area how much each pixel belongs to the part @param {Form} form
 */
export function giveForm({ normals, mask, width, height }, area, { kind, bevel, strength }) {
  const own = area.map((value, i) => value * mask[i]);
  const found = boxOf(own, width, height, 0.5);
  if (!found || !strength) return;
  /** @type {import("./raster.js").Box} */
  const box = [Math.max(found[0] - 1, 0), Math.max(found[1] - 1, 0), Math.min(found[2] + 1, width), Math.min(found[3] + 1, height)];
  const [wide, high] = [box[2] - box[0], box[3] - box[1]];
  const scale = Math.min(SIDE / Math.max(wide, high), 1);
  const [w, h] = [wide, high].map((side) => Math.max(Math.round(side * scale), 1));
  const inside = cut(own, width, height, box);
  const small = shaped(scale < 1 ? resized(inside, wide, high, w, h) : inside, w, h, kind, bevel);
  const form = scale < 1 ? resized(small, w, h, wide, high, 3) : small;
  for (let y = 0, from = 0; y < high; y++) {
    for (let x = 0; x < wide; x++, from += 3) {
      const to = (y + box[1]) * width + x + box[0];
      const share = strength * area[to];
      const [a, b, c] = [0, 1, 2].map((k) => (1 - share) * normals[3 * to + k] + share * form[from + k]);
      const length = Math.hypot(a, b, c);
      if (length > 1e-8) normals.set([a / length, b / length, c / length], 3 * to);
    }
  }
}

/** Returns an area that fades out inwards. @param {Float32Array} area @param {number} width @param {number} height @param {number} soft the share of its depth */
export function feathered(area, width, height, soft) {
  const box = boxOf(area, width, height, 0.5);
  if (!box) return area;
  const [left, top, right, bottom] = box;
  const inside = where(cut(area, width, height, box), (value) => value > 0.5);
  const fade = soft * deepest(distance(inside, right - left, bottom - top, true));
  if (fade <= 0) return area;
  const rim = Math.ceil(fade);
  const [wide, high] = [right - left + 2 * rim, bottom - top + 2 * rim];
  const solid = where(cut(area, width, height, [left - rim, top - rim, right + rim, bottom + rim]), (value) => value > 0.5);
  const faded = distance(solid, wide, high, true).map((value) => {
    const rise = Math.min(Math.max((value - 0.5) / fade, 0), 1);
    return rise ** 3 * (rise * (6 * rise - 15) + 10);
  });
  return cut(blurred(faded, wide, high, Math.max(fade / 6, 0.5)), wide, high, [rim - left, rim - top, rim - left + width, rim - top + height]);
}

/** @param {Float32Array} depth */
const deepest = (depth) => depth.reduce((most, value) => Math.max(most, value), 0);

/** Returns the normals of a part in a form. @param {import("./raster.js").Plane} part @param {number} width @param {number} height @param {Form["kind"]} kind @param {number} bevel */
function shaped(part, width, height, kind, bevel) {
  const flat = kind === "flat";
  const rim = 1 + (flat ? Math.round(0.3 * Math.max(width, height) * bevel) : 0);
  const [wide, high] = [width + 2 * rim, height + 2 * rim];
  const inside = cut(part, width, height, [-rim, -rim, width + rim, height + rim]);
  const solid = where(inside, (value) => value > 0.5);
  const depth = distance(solid, wide, high, true);
  const most = Math.max(deepest(depth), 1);
  const reach = Math.max(bevel * most, 1);
  const off = flat ? distance(opposite(solid), wide, high) : depth;
  const level = reach < most ? 4 / reach ** 2 - 4 / most ** 2 : 0;
  const values = flat
    ? blurred(depth.map((value, i) => Math.min(value - off[i], reach)), wide, high, Math.max(0.15 * reach, 0.7))
    : inflated(inside, wide, high, level);
  const out = new Float32Array(3 * width * height);
  for (let y = 0, to = 0; y < height; y++) {
    for (let x = 0; x < width; x++, to += 3) {
      const at = (y + rim) * wide + x + rim;
      const normal = [(values[at - 1] - values[at + 1]) / 2, (values[at + wide] - values[at - wide]) / 2, flat ? 1 : 2 * Math.sqrt(values[at]) + 1e-3];
      const length = Math.hypot(...normal);
      let [a, b, c] = normal.map((value) => value / length);
      if (kind === "hollow") {
        [a, b] = [-DISH * a, -DISH * b];
        c = Math.sqrt(Math.max(1 - a * a - b * b, 0));
      }
      out.set([a, b, c], to);
    }
  }
  return out;
}

/** Returns u with ∇²u - level u = -4 inside and nearly 0 outside, from coarse to fine. @param {Float32Array} inside @param {number} width @param {number} height @param {number} level @returns {Float32Array} */
function inflated(inside, width, height, level) {
  const side = Math.max(width, height);
  let [sweeps, ahead] = [2 * side, 2 / (1 + Math.sin(Math.PI / side))];
  let square = new Float32Array(width * height);
  if (side > COARSE) {
    const [w, h] = [(width + 1) >> 1, (height + 1) >> 1];
    const coarse = inflated(resized(inside, width, height, w, h), w, h, 4 * level);
    square = resized(coarse, w, h, width, height).map((value) => 4 * value);
    [sweeps, ahead] = [SWEEPS, 1];
  }
  for (let sweep = 0; sweep < 2 * sweeps; sweep++) {
    for (let y = 0; y < height; y++) {
      for (let x = (y + sweep) % 2; x < width; x += 2) {
        const i = y * width + x;
        const near = (x > 0 ? square[i - 1] : 0) + (x < width - 1 ? square[i + 1] : 0) + (y > 0 ? square[i - width] : 0) + (y < height - 1 ? square[i + width] : 0);
        square[i] += ahead * ((near + 4 * inside[i]) / (4 + level + OUTSIDE * (1 - inside[i])) - square[i]);
      }
    }
  }
  return square.map((value) => Math.max(value, 0));
}
