/** Structures: tiles of scales, fur and the like, as normalgan.inference.structures has them; for the page and its workers. */

/** @typedef {{side: number, right: Float32Array, down: Float32Array}} Slopes pixels of height for a pixel of way */
/** @typedef {Slopes[]} Tile each level half as large as the one before: its means */
/** @typedef {import("./document.js").Structure} Structure */

/** Root mean square of a tile's slopes at full strength. */
const STEEP = 0.6;
/** Root mean square of the slopes, for heights from 0 to 1, below which a picture counts as flat. */
const EVEN = 1e-4;
/** Kernel for smoothing the levels of a picture. */
const SMOOTHED = [1 / 16, 4 / 16, 6 / 16, 4 / 16, 1 / 16];

/** @type {Map<string, Promise<Tile>>} by the kind, or by the picture */
const known = new Map();

/**
 * Returns the tile of a structure.
 * @param {string} kind @param {string} [picture] base64 of a PNG, of a structure of one's own
 * @returns {Promise<Tile>}
 */
export function tileOf(kind, picture) {
  const key = picture ?? kind;
  const found = known.get(key) ?? (picture === undefined ? builtIn(kind) : ofPicture(picture));
  known.set(key, found);
  found.catch(() => known.delete(key)); // the next attempt may succeed
  return found;
}

/** @param {string} kind */
async function builtIn(kind) {
  const response = await fetch(new URL(`../structure_${kind}.bin`, import.meta.url));
  if (!response.ok) throw new Error(response.statusText);
  const view = new DataView(await response.arrayBuffer());
  return tileOfHeights(Float32Array.from({ length: view.byteLength / 2 }, (_, i) => view.getUint16(2 * i, true)));
}

/** @param {string} picture */
async function ofPicture(picture) {
  const bytes = Uint8Array.from(atob(picture), (letter) => letter.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
  const { width: side } = bitmap;
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(side, side).getContext("2d"));
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, side, side);
  const heights = Float32Array.from({ length: side * side }, (_, i) => (data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) / 765);
  // Smoothed, because 256 levels would give visible steps.
  return tileOfHeights(smoothed(smoothed(heights, side, 1), side, side));
}

/** @param {Float32Array} values @param {number} side @param {number} step 1 is across, the side is down */
function smoothed(values, side, step) {
  const across = step === 1;
  return values.map((_, i) => {
    const at = across ? i % side : Math.floor(i / side);
    return SMOOTHED.reduce((sum, share, k) => sum + share * values[i + (((at + k - 2 + side) % side) - at) * step], 0);
  });
}

/** Returns the tile of heights in any unit. @param {Float32Array} heights of a square @returns {Tile} */
function tileOfHeights(heights) {
  const side = Math.sqrt(heights.length);
  const [right, down] = [new Float32Array(heights.length), new Float32Array(heights.length)];
  for (let y = 0, i = 0; y < side; y++) {
    const [above, below] = [((y + side - 1) % side) * side, ((y + 1) % side) * side];
    for (let x = 0; x < side; x++, i++) {
      right[i] = (heights[y * side + ((x + 1) % side)] - heights[y * side + ((x + side - 1) % side)]) / 2;
      down[i] = (heights[below + x] - heights[above + x]) / 2;
    }
  }
  const steepness = Math.sqrt(right.reduce((sum, value, i) => sum + value * value + down[i] * down[i], 0) / heights.length);
  const [low, high] = heights.reduce(([least, most], value) => [Math.min(least, value), Math.max(most, value)], [Infinity, -Infinity]);
  const scale = steepness > EVEN * (high - low) && high > low ? STEEP / steepness : 0;
  const levels = [{ side, right: right.map((value) => value * scale), down: down.map((value) => value * scale) }];
  for (let last = levels[0]; last.side % 2 === 0; last = levels[levels.length - 1]) {
    levels.push({ side: last.side / 2, right: halved(last.right, last.side), down: halved(last.down, last.side) });
  }
  return levels;
}

/** Returns the means of two by two values. @param {Float32Array} values @param {number} side */
function halved(values, side) {
  const half = side / 2;
  return Float32Array.from({ length: half * half }, (_, i) => {
    const at = 2 * Math.floor(i / half) * side + 2 * (i % half);
    return (values[at] + values[at + 1] + values[at + side] + values[at + side + 1]) / 4;
  });
}

/**
 * Returns a function that gives the slope of a structure at a point, to the right and down.
 * @param {Tile} tile @param {Structure} structure @param {number} [scale] pixels of the map for one of the drawing
 * @returns {(x: number, y: number, out: number[]) => void} x, y: in pixels of the map
 */
export function slopesAt(tile, { period, turn = 0, x: left = 0, y: top = 0, flipped = false }, scale = 1) {
  const level = Math.min(Math.max(Math.round(Math.log2(tile[0].side / (period * scale))), 0), tile.length - 1);
  const { side, right, down } = tile[level];
  const [cos, sin, across] = [Math.cos(turn), Math.sin(turn), flipped ? -1 : 1];
  const fine = side / (period * scale);
  /** @param {number} value */
  const wrapped = (value) => ((value % side) + side) % side;
  return (x, y, out) => {
    const [beside, below] = [x - left * scale, y - top * scale];
    const [u, v] = [across * (cos * beside + sin * below) * fine - 0.5, (cos * below - sin * beside) * fine - 0.5];
    const [column, row] = [Math.floor(u), Math.floor(v)];
    const [far, low] = [u - column, v - row];
    const [first, second] = [wrapped(column), wrapped(column + 1)];
    const [upper, lower] = [wrapped(row) * side, wrapped(row + 1) * side];
    /** @param {Float32Array} values */
    const between = (values) =>
      (1 - low) * ((1 - far) * values[upper + first] + far * values[upper + second]) + low * ((1 - far) * values[lower + first] + far * values[lower + second]);
    const [own, under] = [between(right), between(down)];
    out[0] = cos * across * own - sin * under;
    out[1] = sin * across * own + cos * under;
  };
}
