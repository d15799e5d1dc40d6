/** Reader: runs a small network that separates ink from ground and object from background, on the same input as normalgan.inference.cleaning.reader. */

import { READER } from "./constants.js";
import { components, extreme, filtered, part, refitted, resized, rint, where } from "./raster.js";

const { DOUBT, FLAT, GREY, NARROWEST, NEARER, ONE_TONE, PAPER, SIDES, STRIDE, WINDOW } = READER;

/** @typedef {(picture: Float32Array, width: number, height: number) => Promise<Float32Array>} Network three planes in; ink, presence and two more out */
/** @typedef {{ink: Float32Array, presence: Float32Array, middle: Float32Array[], width: number, height: number}} Reading probabilities, and x and y of the
 *   middle of each pixel's object as shares of the picture's sides, at the scale at which the network saw the drawing */
/** @typedef {{pixels: Uint8Array, width: number, height: number, channels: number}} Picture grey, in colour, or with opacity */

/** Weights of the window in which ink follows brightness. */
const AVERAGE = Array.from({ length: WINDOW }, () => 1 / WINDOW);

/**
 * Returns the network's reading of a picture; it reads a small drawing on a large page a second time, from nearer.
 * @param {Picture} plane @param {Network} network @returns {Promise<Reading>}
 */
export async function read(plane, network) {
  const { pixels, width, height, channels } = plane;
  const paper = channels === 4 ? ground(pixels, width, height) : 1;
  const page = await look(plane, paper, network);
  const box = aroundDrawing(page, width, height);
  if (!box) return page;
  const [left, top, right, bottom] = box;
  const nearer = new Uint8Array(part(pixels, width, height, box, channels));
  return putIn(page, await look({ pixels: nearer, width: right - left, height: bottom - top, channels }, paper, network), box, width, height);
}

/** Returns the box of a picture to read from nearer, or null if that adds little detail. @param {Reading} page @param {number} width @param {number} height */
function aroundDrawing({ ink, presence, width: wide, height: high }, width, height) {
  const drawn = where(ink, (value, i) => value > 0.5 || presence[i] > 0.5);
  const [columns, rows] = [[wide, -1], [high, -1]];
  drawn.forEach((on, i) => {
    if (!on) return;
    const [x, y] = [i % wide, Math.floor(i / wide)];
    [columns[0], columns[1], rows[0], rows[1]] = [Math.min(columns[0], x), Math.max(columns[1], x), Math.min(rows[0], y), Math.max(rows[1], y)];
  });
  if (columns[1] < 0) return null;
  const [lows, highs] = [0, 1].map((end) => [(columns[end] * width) / wide, (rows[end] * height) / high]);
  const longest = Math.max(width, height);
  const side = Math.max(Math.max(highs[0] - lows[0], highs[1] - lows[1]) * (1 + 2 * PAPER), longest / NEARER[1]);
  if (shownShare(side) < NEARER[0] * shownShare(longest)) return null;
  const starts = [width, height].map((all, k) => Math.floor(Math.min(Math.max((lows[k] + highs[k] - side) / 2, 0), Math.max(all - side, 0))));
  const ends = [width, height].map((all, k) => Math.min(starts[k] + rint(side), all));
  return /** @type {import("./raster.js").Box} */ ([...starts, ...ends]);
}

/** Returns the scale at which the network sees a picture. @param {number} side its longer side in pixels */
const shownShare = (side) => Math.min(SIDES[1] / side, 1);

/**
 * Returns the reading of a picture with the reading of a part inserted, at the part's scale.
 * @param {Reading} page @param {Reading} nearer @param {import("./raster.js").Box} box of the part @param {number} width @param {number} height
 */
function putIn(page, nearer, [left, top, right, bottom], width, height) {
  const [across, down] = [nearer.width / (right - left), nearer.height / (bottom - top)];
  const [wide, high] = [Math.max(rint(width * across), nearer.width), Math.max(rint(height * down), nearer.height)];
  const [x, y] = [Math.min(rint(left * across), wide - nearer.width), Math.min(rint(top * down), high - nearer.height)];
  /** @param {Float32Array} around @param {Float32Array} within */
  const whole = (around, within) => {
    const values = resized(around, page.width, page.height, wide, high, 1, "points");
    for (let row = 0; row < nearer.height; row++) values.set(within.subarray(row * nearer.width, (row + 1) * nearer.width), (y + row) * wide + x);
    return values;
  };
  const sides = [[left, right, width], [top, bottom, height]];
  const middle = sides.map(([start, end, side], axis) => whole(page.middle[axis], nearer.middle[axis].map((each) => (start + each * (end - start)) / side)));
  return { ink: whole(page.ink, nearer.ink), presence: whole(page.presence, nearer.presence), middle, width: wide, height: high };
}

/**
 * Returns the network's reading of a picture.
 * @param {Picture} plane @param {number} paper brightness of the ground behind it @param {Network} network @returns {Promise<Reading>}
 */
async function look({ pixels, width: wide, height: high, channels }, paper, network) {
  const longest = Math.max(wide, high);
  const side = Math.min(Math.max(longest, SIDES[0]), SIDES[1]);
  const [width, height] = [wide, high].map((each) => Math.max(rint(Math.max(rint((each * side) / longest), 1) / STRIDE), 1) * STRIDE);
  const least = rint((NARROWEST * Math.max(width, height)) / STRIDE) * STRIDE;
  const [across, down] = [Math.max(width, least), Math.max(height, least)];
  const [left, top] = [(across - width) >> 1, (down - height) >> 1];
  const picture = new Float32Array(3 * across * down);
  const plane = new Float32Array(wide * high);
  for (let c = 0; c < 3; c++) {
    // A grey picture has one channel for all three.
    if (channels === 1 && c) picture.copyWithin(c * across * down, 0, across * down);
    else {
      for (let i = 0; i < plane.length; i++) {
        const alpha = channels === 4 ? pixels[4 * i + 3] / 255 : 1;
        plane[i] = (pixels[channels * i + c] / 255) * alpha + paper * (1 - alpha);
      }
      const shown = resized(plane, wide, high, width, height, 1, side < longest ? "lines" : "points");
      // The network expects blue first.
      const start = (channels === 1 ? 0 : 2 - c) * across * down;
      if (across > width || down > height) picture.fill(borderTone(plane, wide, high), start, start + across * down);
      for (let row = 0; row < height; row++) picture.set(shown.subarray(row * width, (row + 1) * width), start + (top + row) * across + left);
    }
  }
  const found = await network(picture, across, down);
  const box = /** @type {import("./raster.js").Box} */ ([left, top, left + width, top + height]);
  const [ink, presence] = [0, 1].map((c) => found.slice(c * across * down, (c + 1) * across * down).map((value) => 1 / (1 + Math.exp(-value))));
  const grey = ink.map((_, i) => GREY[2] * picture[i] + GREY[1] * picture[i + ink.length] + GREY[0] * picture[i + 2 * ink.length]);
  const longer = Math.max(across, down);
  const middle = [width, height].map((side, axis) => {
    const offset = part(found.subarray((2 + axis) * across * down, (3 + axis) * across * down), across, down, box);
    return offset.map((each, i) => ((axis ? Math.floor(i / width) : i % width) + each * longer) / side);
  });
  return { ink: part(byTone(ink, grey, across, down), across, down, box), presence: part(presence, across, down, box), middle, width, height };
}

/** Returns the median of a plane along its border. @param {Float32Array} plane @param {number} width @param {number} height */
function borderTone(plane, width, height) {
  const border = [...plane.subarray(0, width), ...plane.subarray((height - 1) * width)];
  for (let row = 0; row < height; row++) border.push(plane[row * width], plane[(row + 1) * width - 1]);
  border.sort((a, b) => a - b);
  const half = border.length >> 1;
  return (border[half - 1] + border[half]) / 2;
}

/**
 * Returns the ink, with each area of one tone set to all or nothing where the network is unsure.
 * @param {Float32Array} ink @param {Float32Array} grey brightness @param {number} width @param {number} height
 */
function byTone(ink, grey, width, height) {
  const { labels, boxes } = components(where(steps(grey, width, height), (step) => step < ONE_TONE), width, height, 4);
  const votes = new Float64Array(boxes.length);
  ink.forEach((value, i) => { votes[labels[i]] += value / boxes[labels[i]].area; });
  return ink.map((value, i) => {
    const vote = votes[labels[i]];
    return labels[i] && vote > DOUBT && vote < 1 - DOUBT ? Number(vote > 0.5) : value;
  });
}

/**
 * Returns the brightness of a picture at a size; a transparent one lies on the ground that the network sees.
 * @param {{pixels: Uint8Array, width: number, height: number, channels: number}} plane @param {number} width @param {number} height
 */
export function brightness({ pixels, width: wide, height: high, channels }, width, height) {
  const grey = new Float32Array(wide * high);
  const paper = channels === 4 ? ground(pixels, wide, high) : 1;
  for (let i = 0; i < grey.length; i++) {
    if (channels === 1) grey[i] = pixels[i] / 255;
    else {
      const alpha = pixels[4 * i + 3] / 255;
      grey[i] = ((GREY[0] * pixels[4 * i] + GREY[1] * pixels[4 * i + 1] + GREY[2] * pixels[4 * i + 2]) / 255) * alpha + paper * (1 - alpha);
    }
  }
  return width === wide && height === high ? grey : refitted(grey, wide, high, width, height).map((value) => Math.max(0, Math.min(1, value)));
}

/**
 * Returns the ground for a transparent picture: white, or black if the edge of the opaque part is light.
 * @param {Uint8Array} pixels @param {number} width @param {number} height
 */
function ground(pixels, width, height) {
  const alpha = Float32Array.from({ length: width * height }, (_, i) => pixels[4 * i + 3]);
  const least = extreme(alpha, width, height, 1, -1);
  let [seen, edge] = [0, 0];
  for (let i = 0; i < alpha.length; i++) {
    const share = alpha[i] - least[i];
    seen += ((GREY[0] * pixels[4 * i] + GREY[1] * pixels[4 * i + 1] + GREY[2] * pixels[4 * i + 2]) / 255) * share;
    edge += share;
  }
  return seen < 0.6 * Math.max(edge, 1e-6) ? 1 : 0;
}

/** Returns the presence at another size. @param {Reading} reading @param {number} width @param {number} height */
export const presenceAt = (reading, width, height) => resized(reading.presence, reading.width, reading.height, width, height, 1, "points");

/**
 * Returns the lines of the picture. Local regressions of ink on brightness and on its steps restore the detail that the
 * network did not see: He, Sun and Tang, "Guided Image Filtering", 2013, and He and Sun, "Fast Guided Filter", 2015.
 * @param {Reading} reading @param {Float32Array} grey brightness of the picture at a size @param {number} width @param {number} height
 */
export function inkAt({ ink, width: wide, height: high }, grey, width, height) {
  const small = resized(grey, width, height, wide, high, 1, Math.max(wide, high) < Math.max(width, height) ? "lines" : "points");
  const step = steps(small, wide, high);
  /** @param {(i: number) => number} value */
  const mean = (value) => filtered(Float32Array.from(ink, (_, i) => value(i)), wide, high, AVERAGE);
  const [greys, rises, inks] = [mean((i) => small[i]), mean((i) => step[i]), mean((i) => ink[i])];
  const [squares, risen] = [mean((i) => small[i] ** 2), mean((i) => step[i] ** 2)];
  const [both, byGrey, bySteps] = [mean((i) => small[i] * step[i]), mean((i) => small[i] * ink[i]), mean((i) => step[i] * ink[i])];
  const slopes = [new Float32Array(ink.length), new Float32Array(ink.length)];
  for (let i = 0; i < ink.length; i++) {
    const [a, b] = [squares[i] - greys[i] ** 2 + FLAT, risen[i] - rises[i] ** 2 + FLAT];
    const [ab, ai, bi] = [both[i] - greys[i] * rises[i], byGrey[i] - greys[i] * inks[i], bySteps[i] - rises[i] * inks[i]];
    slopes[0][i] = (b * ai - ab * bi) / (a * b - ab * ab);
    slopes[1][i] = (a * bi - ab * ai) / (a * b - ab * ab);
  }
  const [alongGrey, alongSteps] = slopes.map((slope) => mean((i) => slope[i]));
  /** @param {Float32Array} values */
  const enlarged = (values) => resized(values, wide, high, width, height, 1, "points");
  const rest = enlarged(ink.map((value, i) => value - alongGrey[i] * small[i] - alongSteps[i] * step[i]));
  const [steep, edged, rise] = [enlarged(alongGrey), enlarged(alongSteps), steps(grey, width, height)];
  return grey.map((value, i) => Math.max(0, Math.min(1, steep[i] * value + edged[i] * rise[i] + rest[i])));
}

/** Returns the difference in brightness between each pixel's neighbours. @param {Float32Array} grey @param {number} width @param {number} height */
function steps(grey, width, height) {
  const low = extreme(grey, width, height, 1, -1);
  return extreme(grey, width, height, 1, 1).map((high, i) => high - low[i]);
}
