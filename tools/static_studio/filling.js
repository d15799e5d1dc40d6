/** Filling: what the lines of a drawing enclose, with small gaps closed, as normalgan.inference.mask.filling and outline_mask do it in Python. */

import { lineWidth } from "./prepare.js";
import { above, blurred, both, boxOf, either, enclosedBy, refitted, rint, sumOf, thicker, without } from "./raster.js";

export const SIDE = 512;
export const INKED = 0.35;
/** Half the widths of gaps, as shares of the span: those closed in any case, and if most of the outline is open. */
const [SMALL, LARGE] = [[0, 0.005, 0.012, 0.018], [0.026, 0.04, 0.06]];
const MARGIN = 0.06;
const [ENOUGH, FAILED] = [0.93, 0.5];

/** Returns the size at which the object is decided. @param {number} width @param {number} height @returns {[number, number]} */
export function decided(width, height) {
  const longest = Math.max(width, height);
  const side = Math.min(Math.max(longest, SIDE / 2), SIDE);
  return side === longest ? [width, height] : [Math.max(rint((width * side) / longest), 1), Math.max(rint((height * side) / longest), 1)];
}

/** Returns a mask that was found at another size. @param {Uint8Array} mask @param {number} wide @param {number} high @param {number} width @param {number} height */
export function enlarged(mask, wide, high, width, height) {
  return above(refitted(blurred(mask, wide, high, 0.8), wide, high, width, height), 0.5);
}

/**
 * Returns the mask of what lines enclose, how much of the ink encloses anything, and whether a wide gap was closed.
 * @param {Uint8Array} lines @param {number} width @param {number} height
 */
export function fillOutline(lines, width, height) {
  const box = boxOf(lines, width, height, 0);
  if (!box) return { mask: new Uint8Array(lines.length), closed: 0, guessed: false };
  const span = Math.max(box[2] - box[0], box[3] - box[1]);
  const margin = Math.floor(MARGIN * span) + 2;
  const [padded, rows] = [width + 2 * margin, height + 2 * margin];
  const inked = new Uint8Array(padded * rows);
  for (let y = 0; y < height; y++) inked.set(lines.subarray(y * width, (y + 1) * width), (y + margin) * padded + margin);
  const filling = new Filling(inked, padded, rows, span);
  filling.take(SMALL);
  const before = filling.closed;
  if (before < FAILED) filling.take(LARGE);
  const filled = filling.mask();
  const mask = new Uint8Array(lines.length);
  for (let y = 0; y < height; y++) mask.set(filled.subarray((y + margin) * padded + margin, (y + margin) * padded + margin + width), y * width);
  return { mask, closed: filling.closed, guessed: filling.closed > before };
}

/** An inside that grows while gaps are closed. */
class Filling {
  /** @param {Uint8Array} inked @param {number} width @param {number} height @param {number} span */
  constructor(inked, width, height, span) {
    this.inked = inked;
    this.width = width;
    this.height = height;
    this.span = span;
    this.line = lineWidth(inked, width, height);
    this.count = sumOf(inked);
    this.inside = new Uint8Array(inked.length);
    /** @type {Uint8Array} */
    this.near = this.inside;
    this.closed = 0;
  }

  /** Returns the inside with its lines. */
  mask() {
    return enclosedBy(either(this.inside, both(this.inked, this.near)), this.width, this.height);
  }

  /** Adds what is enclosed by lines made thicker, step by step until that is enough. @param {number[]} gaps */
  take(gaps) {
    const { inked, inside, width, height } = this;
    for (const share of gaps) {
      if (this.closed > ENOUGH) return;
      const gap = share * this.span;
      const thick = thicker(inked, width, height, gap);
      const enclosed = enclosedBy(thick, width, height);
      let fresh = without(without(enclosed, thick), inside);
      if (!fresh.includes(1)) continue;
      if (gap) fresh = this.grown(fresh, gap);
      for (let i = 0; i < fresh.length; i++) if (fresh[i]) inside[i] = 1;
      this.near = thicker(inside, width, height, this.line + 1.5);
      this.closed = sumOf(both(inked, this.near)) / this.count;
    }
  }

  /** Returns seeds with all within reach that is not behind a line. @param {Uint8Array} seeds @param {number} reach */
  grown(seeds, reach) {
    const { inked, width, height } = this;
    const room = thicker(seeds, width, height, reach + 0.5);
    const grown = seeds.slice();
    let edge = [...seeds.keys()].filter((at) => seeds[at]);
    for (let step = 0; step < Math.ceil(reach * Math.SQRT2); step++) {
      const next = [];
      for (const at of edge) {
        for (const other of [at - 1, at + 1, at - width, at + width]) {
          if (grown[other] || !room[other] || inked[other]) continue;
          grown[other] = 1;
          next.push(other);
        }
      }
      edge = next;
    }
    return grown;
  }
}
