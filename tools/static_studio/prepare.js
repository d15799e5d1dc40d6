/** Prepare: performs all steps before the network, like normalgan.inference in Python. */

import { INK, LINE_WIDTH, SILHOUETTE } from "./constants.js";
import { decide } from "./decision.js";
import { severalIslands } from "./figures.js";
import { SQUARE, above, blurred, boxOf, components, dilated, distance, eroded, median, opposite, part, refitted, resized, ridge, rint, stretched, sumOf, thinned, where } from "./raster.js";
import { brightness, inkAt, read } from "./reader.js";

/** @typedef {{left: number, top: number, side: number, size: number}} Frame the square that the network sees */
/**
 * @typedef {object} Prepared
 * @property {number} width at which the drawing is worked on
 * @property {number} height
 * @property {{width: number, height: number}} map the map's size, which is smaller for icons
 * @property {Float32Array} ink lines 1, paper 0
 * @property {Uint8Array | null} mask the object, if known
 * @property {Float32Array | null} covered how much of each pixel the object covers, if its outline determines it
 * @property {Float32Array | null} alpha the drawing's opacity, if it determines the mask
 * @property {Frame} frame
 * @property {Float32Array} seen the network's input
 * @property {import("./result/findings.js").Finding[]} unsure findings about regions of which the reader is unsure
 * @property {import("./result/findings.js").Finding[]} figures the finding about separate figures, if there are any
 */

const { DRAWN_WIDTH, FINER, ROUGH, THIN, THINNEST } = LINE_WIDTH;
const MARGIN = 0.06;

/** The drawing cannot be predicted. */
export class Unpaintable extends Error {
  /** @param {string} code of the finding @param {string} [layer] the layer's name, if there are several */
  constructor(code, layer = "") {
    super(code);
    this.code = code;
    this.layer = layer;
  }
}

const { LEAST } = INK;
const { HELD, RIM, SHEET, SURE, TINY, TRANSLUCENT } = SILHOUETTE;

/**
 * Prepares a drawing.
 * @param {{pixels: Uint8Array, width: number, height: number, channels: number}} plane grey, or with opacity
 * @param {number} size side of the network's pictures
 * @param {null | "outline" | "model"} source source of the mask; null for the reader
 * @param {number | null} longest longer side of the map; null for the drawing's
 * @param {[number, number]} widths of lines that the network sees unchanged, in its pixels
 * @param {import("./reader.js").Network} reader
 * @param {(seen: Float32Array, frame: Frame, scale: number) => void} [begin] called with the network's input before the object is found
 * @returns {Promise<Prepared>}
 */
export async function prepare(plane, size, source, longest, widths, reader, begin = () => {}) {
  const scale = longest ? longest / Math.max(plane.width, plane.height) : 1;
  const map = { width: Math.max(1, rint(plane.width * scale)), height: Math.max(1, rint(plane.height * scale)) };
  // Lines of a tiny sprite are as wide as its details; enlarged, they can be told apart and thinned.
  const enlarged = Math.max(1, size / Math.max(map.width, map.height));
  const [width, height] = [map.width, map.height].map((side) => Math.max(1, rint(side * enlarged)));
  const alpha = opacity(plane, width, height);
  // Strokes are ink already, so the network begins before they are read.
  const drawn = plane.channels === 1;
  const asked = source && drawn ? null : read(plane, reader);
  const cut = alpha && asked && (await isSilhouette(plane, await asked, reader)) ? alpha : null;
  const opaque = cut && opaquePart(cut, width, height);
  const grey = brightness(plane, width, height);
  /** @type {Float32Array} */
  let ink = drawn ? grey.map((value) => 1 - value) : inkAt(/** @type {import("./reader.js").Reading} */ (await asked), grey, width, height);
  if (opaque) {
    ink = outlined(ink, opaque, width, height, width / plane.width);
  }
  const frame = frameAround(ink, width, height, size);
  if (!frame || !ink.some((value) => value >= LEAST)) throw new Unpaintable("no_lines");
  const seen = shown(ink, width, height, frame, widths);
  begin(seen, frame, width / plane.width);
  const rest = { width, height, map, ink, frame, seen, unsure: [], figures: [], alpha: null, covered: null };
  // A map of another size has no finding about figures, as in Python.
  if (opaque && !source) return { ...rest, mask: opaque, alpha: cut, figures: map.width === plane.width ? severalIslands(plane, width / plane.width) : [] };
  if (source === "model") return { ...rest, mask: null };
  return { ...rest, ...decide(ink, width, height, source ? null : await asked) };
}

/** Returns the square around the lines of a drawing, or null if there are none. @param {Float32Array} ink @param {number} width @param {number} height @param {number} size @returns {Frame | null} */
export function frameAround(ink, width, height, size) {
  const box = boxOf(ink, width, height, 0.1);
  if (!box) return null;
  const [left, top, right, bottom] = box;
  const side = Math.max(right - left, bottom - top) / (1 - 2 * MARGIN);
  return { left: rint((left + right - side) / 2), top: rint((top + bottom - side) / 2), side: rint(side), size };
}

/** Returns the opacity of a picture at a size, or null if the whole picture is opaque. @param {{pixels: Uint8Array, width: number, height: number, channels: number}} plane @param {number} width @param {number} height */
function opacity({ pixels, width: wide, height: high, channels }, width, height) {
  if (channels === 1) return null;
  const alpha = Float32Array.from({ length: wide * high }, (_, i) => pixels[4 * i + 3] / 255);
  if (alpha.every((value) => value === 1)) return null;
  return width === wide && height === high ? alpha : refitted(alpha, wide, high, width, height).map((value) => Math.max(0, Math.min(1, value)));
}

/** Returns the values between two limits, and neither. @param {Float32Array} values @param {number} low @param {number} high */
function between(values, low, high) {
  const found = new Float32Array(values.length);
  let count = 0;
  for (let i = 0; i < values.length; i++) if (values[i] > low && values[i] < high) found[count++] = values[i];
  return found.slice(0, count);
}

/** Returns the opaque part of a drawing, with the translucent areas that it encloses. @param {Float32Array} alpha @param {number} width @param {number} height */
function opaquePart(alpha, width, height) {
  const opaque = above(alpha, 0.5);
  const { labels, boxes } = components(opposite(opaque), width, height, 4);
  const translucent = new Int32Array(boxes.length);
  for (let i = 0; i < alpha.length; i++) if (alpha[i] >= TRANSLUCENT) translucent[labels[i]]++;
  const belongs = boxes.map((box, label) => label > 0 && box.left > 0 && box.top > 0 && box.right < width && box.bottom < height && translucent[label] > box.area / 2);
  return where(opaque, (value, i) => value > 0 || belongs[labels[i]]);
}

/**
 * Returns whether the opaque part is an object and neither only its lines nor a card around it: according to the reader, the share of ink in it is smaller than the opaque share of the object, and the object is most of a rectangle.
 * @param {{pixels: Uint8Array, width: number, height: number, channels: number}} plane @param {import("./reader.js").Reading} reading @param {import("./reader.js").Network} network
 */
async function isSilhouette({ pixels, width, height, channels }, reading, network) {
  let alpha = Float32Array.from({ length: width * height }, (_, i) => pixels[4 * i + 3] / 255);
  const opaque = opaquePart(alpha, width, height);
  const found = boxOf(opaque, width, height);
  if (!found || sumOf(opaque) > SHEET * opaque.length) return false;
  let [left, top, right, bottom] = found;
  const [wide, high] = [right - left, bottom - top];
  const extent = Math.max(wide, high);
  const room = (extent >> 3) + 2;
  const rectangle = extent >= TINY && sumOf(opaque) > SHEET * wide * high;
  if (rectangle || extent < Math.max(width, height) / 2) {
    // The reader sees small drawings on a page poorly, and a box without room around it looks like paper.
    [left, top, right, bottom] = rectangle ? [left - room, top - room, right + room, bottom + room] : [Math.max(left - room, 0), Math.max(top - room, 0), Math.min(right + room, width), Math.min(bottom + room, height)];
    /** @type {[number, number, number, number]} */
    const box = [left, top, right, bottom];
    alpha = part(alpha, width, height, box);
    reading = await read({ pixels: new Uint8Array(part(pixels, width, height, box, 4)), width: right - left, height: bottom - top, channels }, network);
    [width, height] = [right - left, bottom - top];
  }
  const shown = resized(alpha, width, height, reading.width, reading.height, 1, Math.max(reading.width, reading.height) < Math.max(width, height) ? "lines" : "points");
  let [all, inked, present, covered] = [0, 0, 0, 0];
  shown.forEach((value, i) => {
    all += value;
    inked += value * reading.ink[i];
    if (reading.presence[i] > 0.5) [present, covered] = [present + 1, covered + value];
  });
  return inked / all <= covered / Math.max(present, 1) + SURE && (!rectangle || covered > HELD * all);
}

/**
 * Returns the ink of an object with a line just inside its silhouette, which covers the half-transparent pixels at its edge.
 * In a tiny object the line replaces the object's own outline, unless the object is nothing else.
 * @param {Float32Array} ink @param {Uint8Array} opaque @param {number} width @param {number} height @param {number} pixel side of the drawing's pixels in these
 * @returns {Float32Array}
 */
function outlined(ink, opaque, width, height, pixel) {
  const depth = distance(opaque, width, height, true);
  const [left, top, right, bottom] = boxOf(opaque, width, height) ?? [0, 0, 1, 1];
  const extent = Math.max(right - left, bottom - top);
  const tiny = extent < TINY * pixel && depth.some((each) => each >= RIM * pixel);
  const wide = Math.max(extent / 250, 1.5 * (tiny ? pixel / 2 : pixel));
  return ink.map((value, i) => {
    if (!opaque[i]) return 0;
    const line = Math.max(0, Math.min(1, wide + 0.5 - depth[i]));
    if (tiny) return depth[i] < RIM * pixel ? line : value;
    return Math.max(value, line);
  });
}

/** Returns the part of a picture inside the frame at the network's size. @param {Float32Array | Uint8Array} picture @param {number} width @param {number} height @param {Frame} frame */
export function shrunk(picture, width, height, { left, top, side, size }) {
  return resized(part(picture, width, height, [left, top, left + side, top + side]), side, side, size, size);
}

/** Returns the ink in a frame, with lines as dark as before. @param {Float32Array} ink @param {number} width @param {number} height @param {Frame} frame */
function cut(ink, width, height, frame) {
  const small = shrunk(ink, width, height, frame);
  const lines = between(small, 0.1, Infinity);
  return lines.length ? stretched(small, 1 / Math.max(median(lines), 0.1), 0) : small;
}

/** Returns the width of most lines in pixels. @param {Uint8Array} inked @param {number} width @param {number} height @param {Float32Array} [depth] */
export function lineWidth(inked, width, height, depth = distance(inked, width, height, true)) {
  const peaks = ridge(depth, inked, width, height);
  const widths = [];
  for (let i = 0; i < inked.length; i++) if (peaks[i]) widths.push(2 * depth[i] - 1);
  return widths.length ? median(widths) : 0;
}

/**
 * Returns the network's input: lines with widths as in its training, and areas as their outlines.
 * @param {Float32Array} ink @param {number} width @param {number} height @param {Frame} frame @param {[number, number]} widths
 */
export function shown(ink, width, height, frame, widths) {
  if (isKnown(ink, width, height, frame, widths)) return cut(ink, width, height, frame);
  const fine = frame.size * FINER;
  const whole = above(cut(ink, width, height, { ...frame, size: fine }), 0.5);
  const found = boxOf(whole, fine, fine);
  if (!found) return cut(ink, width, height, frame);
  const room = 2 * FINER;
  const [left, top] = [Math.max(0, found[0] - room), Math.max(0, found[1] - room)];
  const [right, bottom] = [Math.min(fine, found[2] + room), Math.min(fine, found[3] + room)];
  const [wide, high] = [right - left, bottom - top];
  const inked = new Uint8Array(part(whole, fine, fine, [left, top, right, bottom]));
  const depth = distance(inked, wide, high, true);
  const usual = lineWidth(inked, wide, high, depth);
  const thick = areas(inked, wide, high, usual, depth, fine, fine / frame.side);
  const lines = thick ? lineWidth(where(inked, (value, i) => value > 0 && !thick[i]), wide, high, depth) : usual;
  const known = lines >= widths[0] * FINER && lines <= widths[1] * FINER;
  if (known && !thick) return cut(ink, width, height, frame);
  let [drawn, drawnWidth] = [inked, DRAWN_WIDTH * FINER - lines + 1];
  if (thick || lines > widths[1] * FINER) {
    [drawn, drawnWidth] = [known && thick ? edge(inked, thick, wide, high) : middle(inked, wide, high, lines, thick), DRAWN_WIDTH * FINER];
  }
  const away = distance(opposite(drawn), wide, high);
  const out = new Float32Array(fine * fine);
  for (let y = 0; y < high; y++) {
    for (let x = 0; x < wide; x++) {
      const i = y * wide + x;
      const kept = known && inked[i] && !thick?.[i];
      out[(y + top) * fine + x + left] = kept ? 1 : Math.max(0, Math.min(1, drawnWidth / 2 + 0.5 - away[i]));
    }
  }
  return resized(out, fine, fine, frame.size, frame.size);
}

/** Returns whether all lines certainly have a known width and none is an area; false if this needs a closer look. @param {Float32Array} ink @param {number} width @param {number} height @param {Frame} frame @param {[number, number]} widths */
function isKnown(ink, width, height, frame, widths) {
  const side = frame.size * ROUGH;
  const inked = above(cut(ink, width, height, { ...frame, size: side }), 0.5);
  const depth = distance(inked, side, side, true);
  const lines = lineWidth(inked, side, side, depth);
  return lines >= widths[0] * ROUGH + 1 && lines <= widths[1] * ROUGH - 1 && depth.every((value) => value + 1 <= THIN * side);
}

/**
 * Returns the parts too thick to be lines, or null if there are none.
 * @param {Uint8Array} inked @param {number} width @param {number} height @param {number} lines @param {Float32Array} depth @param {number} side
 * @param {number} drawn side of the drawing's pixels
 */
function areas(inked, width, height, lines, depth, side, drawn) {
  const thickest = Math.max(Math.min(Math.max(1.5 * lines, THIN * side), 0.035 * side), THINNEST * drawn);
  if (!depth.some((value) => value > thickest)) return null;
  const away = distance(where(depth, (value) => !(value > thickest)), width, height);
  const thick = where(inked, (value, i) => value > 0 && away[i] <= 1.2 * thickest);
  const { labels, boxes } = components(inked, width, height, 8);
  const counts = new Float32Array(boxes.length);
  thick.forEach((value, i) => { counts[labels[i]] += value; });
  return where(thick, (value, i) => value > 0 || (inked[i] > 0 && counts[labels[i]] > 0.5 * boxes[labels[i]].area));
}

/**
 * Returns the centre lines of lines and the outlines of areas.
 * @param {Uint8Array} inked @param {number} width @param {number} height @param {number} lines @param {Uint8Array | null} thick
 */
function middle(inked, width, height, lines, thick) {
  const blur = Math.max(lines / 4, 0.5);
  let smooth = above(blurred(inked, width, height, blur), 0.5);
  // It loses lines much thinner than the others, such as the eyes in a face with a thick outline.
  const away = distance(opposite(smooth), width, height);
  const lost = where(inked, (value, i) => value > 0 && away[i] > blur);
  if (lost.includes(1)) {
    const near = distance(opposite(lost), width, height);
    smooth = where(smooth, (value, i) => value > 0 || (inked[i] > 0 && near[i] <= blur));
  }
  const thin = thinned(where(smooth, (value, i) => value > 0 && !thick?.[i]), width, height);
  if (!thick) return thin;
  const rim = edge(inked, thick, width, height);
  return where(thin, (value, i) => value > 0 || rim[i] > 0);
}

/**
 * Returns the outlines of areas except where they merge into a line.
 * @param {Uint8Array} inked @param {Uint8Array} thick @param {number} width @param {number} height
 */
function edge(inked, thick, width, height) {
  const inner = eroded(thick, width, height, SQUARE);
  const onto = dilated(where(inked, (value, i) => value > 0 && !thick[i]), width, height, SQUARE);
  return where(thick, (value, i) => value > 0 && !inner[i] && !onto[i]);
}
