/** PNG: writes a map with 8 or 16 bits, with the same levels as normalgan.normals. A canvas has only 8 bits, and alters transparent colours. */

import { NORMAL_MAP } from "./constants.js";
import { rint } from "./raster.js";

const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10];
const COLOUR = { 3: 2, 4: 6 };
const CRC = Uint32Array.from({ length: 256 }, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; bit++) value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
  return value;
});

/**
 * Returns the levels of a map row by row: red, green, blue and, if there is one, opacity. Off the object it is flat.
 * @param {Float32Array} normals x, y, z of each pixel, unit
 * @param {Uint8Array} mask the object
 * @param {Float32Array | null} alpha opacity, 0 to 1; normals are kept wherever it is above 0
 * @param {boolean} down whether green points down
 * @param {8 | 16} bits
 * @returns {Uint16Array}
 */
export function levelsOf(normals, mask, alpha, down, bits) {
  const top = 2 ** bits - 1;
  const channels = alpha ? 4 : 3;
  const out = new Uint16Array(channels * mask.length);
  for (let i = 0, to = 0; i < mask.length; i++, to += channels) {
    const there = alpha ? alpha[i] > 0 : mask[i] > 0;
    for (let c = 0; c < 3; c++) {
      const value = there ? normals[3 * i + c] * (down && c === 1 ? -1 : 1) : c === 2 ? 1 : 0;
      out[to + c] = Math.max(0, Math.min(top, rint(value * (top / 2) + top / 2)));
    }
    if (alpha) out[to + 3] = rint(Math.fround(alpha[i] * top)); // in single precision, as in Python
  }
  return out;
}

const { PADDING } = NORMAL_MAP;

/**
 * Gives transparent pixels around the object about the colour of its nearest pixel, in place, because engines blend neighbours.
 * @param {Uint16Array} levels with opacity @param {number} width @param {number} height
 */
export function padEdge(levels, width, height) {
  const filled = new Uint8Array(width * height);
  for (let i = 0; i < filled.length; i++) filled[i] = levels[4 * i + 3] ? 1 : 0;
  let edge = [...filled.keys()].filter((at) => filled[at]);
  for (let round = 0; round < PADDING; round++) {
    const next = [];
    for (const at of edge) {
      const [x, y] = [at % width, Math.floor(at / width)];
      for (let dy = -1; dy <= 1; dy++) {
        for (let dx = -1; dx <= 1; dx++) {
          if (dx && dy && round % 2) continue; // alternates between eight and four neighbours: an octagon is nearly round
          if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) continue;
          const to = at + dy * width + dx;
          if (filled[to]) continue;
          filled[to] = 1;
          levels.copyWithin(4 * to, 4 * at, 4 * at + 3);
          next.push(to);
        }
      }
    }
    edge = next;
  }
}

/** @param {Uint8Array} bytes */
function crcOf(bytes) {
  let value = 0xffffffff;
  for (const byte of bytes) value = CRC[(value ^ byte) & 255] ^ (value >>> 8);
  return (value ^ 0xffffffff) >>> 0;
}

/** @param {string} kind of four letters @param {Uint8Array} content @returns {Uint8Array<ArrayBuffer>} */
function chunk(kind, content) {
  const out = new Uint8Array(12 + content.length);
  const view = new DataView(out.buffer);
  view.setUint32(0, content.length);
  for (let i = 0; i < 4; i++) out[4 + i] = kind.charCodeAt(i);
  out.set(content, 8);
  view.setUint32(8 + content.length, crcOf(out.subarray(4, 8 + content.length)));
  return out;
}

/**
 * Returns levels as a PNG (https://www.w3.org/TR/png-3/), with each row as the difference from the row above.
 * @param {Uint16Array} levels row by row @param {number} width @param {number} height @param {8 | 16} bits
 * @returns {Promise<Blob>}
 */
export async function encodePng(levels, width, height, bits) {
  const channels = /** @type {3 | 4} */ (levels.length / (width * height));
  const line = (width * channels * bits) / 8;
  const rows = new Uint8Array((line + 1) * height);
  let above = new Uint8Array(line);
  for (let y = 0, from = 0; y < height; y++) {
    const row = new Uint8Array(line);
    for (let at = 0; at < line; from++) {
      if (bits === 16) row[at++] = levels[from] >> 8;
      row[at++] = levels[from] & 255;
    }
    const start = y * (line + 1);
    rows[start] = 2; // the filter "up"
    for (let at = 0; at < line; at++) rows[start + 1 + at] = row[at] - above[at];
    above = row;
  }
  const head = new Uint8Array(13);
  const view = new DataView(head.buffer);
  view.setUint32(0, width);
  view.setUint32(4, height);
  head.set([bits, COLOUR[channels]], 8);
  const packed = new Response(new Blob([rows]).stream().pipeThrough(new CompressionStream("deflate")));
  const data = new Uint8Array(await packed.arrayBuffer());
  const parts = [Uint8Array.from(SIGNATURE), chunk("IHDR", head), chunk("IDAT", data), chunk("IEND", new Uint8Array())];
  return new Blob(parts, { type: "image/png" });
}
