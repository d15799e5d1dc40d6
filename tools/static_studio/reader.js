/** Reader: a small network that tells ink from ground and object from air, shown what normalgan.inference.mask.reader shows it. */

import { SQUARE, components, dilated, refitted, resized, rint } from "./raster.js";

/** @typedef {(picture: Float32Array, width: number, height: number) => Promise<Float32Array>} Network three planes in; ink, presence and two more out */
/** @typedef {{ink: Float32Array, presence: Float32Array, width: number, height: number}} Reading probabilities, at the network's size */

const [LEAST, MOST, STRIDE] = [256, 384, 32];
const [GATE, FOREIGN] = [0.25, 0.3];

/**
 * Returns what the network sees in a picture as it comes.
 * @param {{pixels: Uint8Array, width: number, height: number, channels: number}} plane grey, or with opacity
 * @param {Network} network @returns {Promise<Reading>}
 */
export async function read({ pixels, width: wide, height: high, channels }, network) {
  const longest = Math.max(wide, high);
  const side = Math.min(Math.max(longest, LEAST), MOST);
  const [width, height] = [wide, high].map((each) => Math.max(rint(Math.max(rint((each * side) / longest), 1) / STRIDE), 1) * STRIDE);
  const picture = new Float32Array(3 * width * height);
  const paper = channels === 4 ? ground(pixels) : 1;
  const plane = new Float32Array(wide * high);
  for (let c = 0; c < 3; c++) {
    // One channel says it all of a grey one.
    if (channels === 1 && c) picture.copyWithin(c * width * height, 0, width * height);
    else {
      for (let i = 0; i < plane.length; i++) {
        const alpha = channels === 4 ? pixels[4 * i + 3] / 255 : 1;
        plane[i] = (pixels[channels * i + c] / 255) * alpha + paper * (1 - alpha);
      }
      // The network is shown blue first.
      picture.set(resized(plane, wide, high, width, height, 1, side < longest ? "lines" : "points"), (channels === 1 ? 0 : 2 - c) * width * height);
    }
  }
  const found = await network(picture, width, height);
  const [ink, presence] = [0, 1].map((c) => found.slice(c * width * height, (c + 1) * width * height).map((value) => 1 / (1 + Math.exp(-value))));
  return { ink, presence, width, height };
}

/** Returns what a transparent picture is laid over: white, or black if what is opaque is light. @param {Uint8Array} pixels */
function ground(pixels) {
  let [seen, opaque] = [0, 0];
  for (let i = 0; i < pixels.length; i += 4) {
    seen += ((0.299 * pixels[i] + 0.587 * pixels[i + 1] + 0.114 * pixels[i + 2]) / 255) * pixels[i + 3];
    opaque += pixels[i + 3];
  }
  return seen < 0.6 * Math.max(opaque, 1e-6) ? 1 : 0;
}

/** Returns the presence at another size. @param {Reading} reading @param {number} width @param {number} height */
export const presenceAt = (reading, width, height) => resized(reading.presence, reading.width, reading.height, width, height, 1, "points");

/** Returns the lines at another size, as the network sees them. @param {Reading} reading @param {number} width @param {number} height */
export const linesAt = (reading, width, height) =>
  refitted(reading.ink, reading.width, reading.height, width, height).map((value) => Math.max(0, Math.min(1, value)));

/**
 * Returns lines without those of the ground: rules, squares, captions, folds.
 * @param {Float32Array} ink @param {number} width @param {number} height @param {Reading} reading
 */
export function dropGround(ink, width, height, reading) {
  const likely = dilated(Uint8Array.from(reading.ink, (value) => (value > GATE ? 1 : 0)), reading.width, reading.height, SQUARE);
  const [columns, rows] = [[width, reading.width], [height, reading.height]].map(([to, from]) => Int32Array.from({ length: to }, (_, i) => Math.min(Math.floor((i * from) / to), from - 1)));
  const gate = new Uint8Array(ink.length);
  const inked = new Uint8Array(ink.length);
  let [total, believed] = [0, 0];
  for (let y = 0, i = 0; y < height; y++) {
    for (let x = 0; x < width; x++, i++) {
      gate[i] = likely[rows[y] * reading.width + columns[x]];
      inked[i] = ink[i] > 0.1 ? 1 : 0;
      total += inked[i];
      believed += inked[i] & gate[i];
    }
  }
  if (!believed) return ink;
  if (total - believed > FOREIGN * total) return ink.map((value, i) => (gate[i] ? value : 0));
  const { labels, boxes } = components(inked, width, height, 8);
  const presence = presenceAt(reading, width, height);
  const [own, seen] = [new Float64Array(boxes.length), new Float64Array(boxes.length)];
  for (let i = 0; i < ink.length; i++) {
    own[labels[i]] += gate[i];
    seen[labels[i]] += presence[i];
  }
  // A caption may be ink; but no object is there.
  const dropped = boxes.map(({ area }, k) => k > 0 && ((own[k] < 0.2 * area && seen[k] < 0.3 * area) || seen[k] < 0.1 * area));
  if (!dropped.includes(false, 1)) return ink; // nothing looks like a drawing, so nothing is known of its lines
  return dropped.includes(true) ? ink.map((value, i) => (dropped[labels[i]] ? 0 : value)) : ink;
}
