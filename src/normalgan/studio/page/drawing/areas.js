/** Areas: find the areas enclosed by lines, which a click flips between object and hole. */

import { context2d } from "./canvas.js";
import { inkAt } from "./ink.js";

/** Longer side in pixels at which areas are searched while the pointer moves. */
const SIDE = 512;
/** Minimum darkness of a line that separates two areas: 0 as the paper, 1 as the darkest ink. */
const INKED = 0.35;
/** Share of a picture's pixels that are its darkest ink. */
const DARKEST = 0.01;
/** Minimum difference between paper and ink in levels; less is grain. */
const CONTRAST = 48;
const OBJECT = [91, 98, 224, 115];
const HOLE = [208, 52, 44, 90];

/** @typedef {{shows: (x: number, y: number) => boolean, open: boolean, pictures: Record<"object" | "hole", HTMLCanvasElement>}} Area of the
 *   drawing; open: it reaches the paper's edge; pictures: its tint */
/** @typedef {{area: Area, object: boolean}} Vote object: whether most of the area is */

export class Areas {
  constructor() {
    /** @type {{strokes: object, width: number, height: number, inked: Uint8Array, wide: number, high: number} | null} */
    this.lines = null;
    /** @type {{lines: object, area: Uint8Array, found: Area} | null} result of the last query */
    this.last = null;
  }

  /**
   * Returns the area at a point; null on a line.
   * @param {import("./document.js").Doc} doc @param {import("./document.js").Layer} layer @param {number} x @param {number} y
   * @returns {Area | null}
   */
  at({ width, height }, { strokes }, x, y) {
    if (x < 0 || y < 0 || x >= width || y >= height || !strokes.length) return null;
    if (this.lines?.strokes !== strokes || this.lines.width !== width || this.lines.height !== height) {
      const { canvas, pixels } = inkAt({ width, height, strokes }, Math.min(SIDE, Math.max(width, height)));
      this.lines = { strokes, width, height, inked: inkedIn(pixels()), wide: canvas.width, high: canvas.height };
    }
    const { lines } = this;
    const { inked, wide, high } = lines;
    const place = (/** @type {number} */ right, /** @type {number} */ down) =>
      Math.min(high - 1, Math.floor((down / height) * high)) * wide + Math.min(wide - 1, Math.floor((right / width) * wide));
    const first = place(x, y);
    if (inked[first]) return null;
    if (this.last?.lines === lines && this.last.area[first]) return this.last.found;
    const area = new Uint8Array(inked.length);
    const stack = [first];
    area[first] = 1;
    let open = false;
    while (stack.length) {
      const at = /** @type {number} */ (stack.pop());
      const column = at % wide;
      open ||= column === 0 || column === wide - 1 || at < wide || at >= inked.length - wide;
      for (const to of [column > 0 ? at - 1 : -1, column < wide - 1 ? at + 1 : -1, at - wide, at + wide]) {
        if (to < 0 || to >= inked.length || inked[to] || area[to]) continue;
        area[to] = 1;
        stack.push(to);
      }
    }
    const found = { shows: (/** @type {number} */ right, /** @type {number} */ down) => area[place(right, down)] > 0, open, pictures: { object: pictureOf(area, wide, high, OBJECT), hole: pictureOf(area, wide, high, HOLE) } };
    this.last = { lines, area, found };
    return found;
  }
}

/** Returns where there are lines: pixels of any colour that are dark compared with the paper, which may be photographed. @param {{channels: 1 | 4, bytes: Uint8Array}} pixels */
function inkedIn({ channels, bytes }) {
  const light = Uint8Array.from({ length: bytes.length / channels }, (_, i) => {
    if (channels === 1) return bytes[i];
    const [red, green, blue, alpha] = bytes.subarray(4 * i, 4 * i + 4);
    return 255 - ((255 - Math.min(red, green, blue)) * alpha) / 255;
  });
  // The paper covers most of a picture.
  const [dark, paper] = channels === 1 ? [0, 255] : levelsOf(light, [DARKEST, 0.5]);
  const least = INKED * Math.max(paper - dark, CONTRAST);
  return light.map((level) => Number(paper - level > least));
}

/** Returns the levels below which these shares of the pixels lie, in ascending order. @param {Uint8Array} light @param {number[]} shares */
function levelsOf(light, shares) {
  const counts = new Uint32Array(256);
  for (const level of light) counts[level] += 1;
  let [level, below] = [0, counts[0]];
  return shares.map((share) => {
    while (below < share * light.length && level < 255) below += counts[++level];
    return level;
  });
}

/**
 * Returns the front layer whose lines enclose a point, or else the only layer with lines; null if there is none.
 * @param {import("./document.js").Doc} doc @param {{x: number, y: number}} at
 */
export function layerAt(doc, { x, y }) {
  const drawn = doc.layers.filter(({ visible, strokes }) => visible && strokes.length);
  const around = drawn.findLast((layer) => new Areas().at(doc, layer, x, y)?.open === false);
  return around ?? (drawn.length === 1 ? drawn[0] : null);
}

/** @param {Uint8Array} area @param {number} width @param {number} height @param {number[]} colour */
function pictureOf(area, width, height, colour) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const image = new ImageData(width, height);
  for (let i = 0; i < area.length; i++) if (area[i]) image.data.set(colour, 4 * i);
  context2d(canvas).putImageData(image, 0, 0);
  return canvas;
}
