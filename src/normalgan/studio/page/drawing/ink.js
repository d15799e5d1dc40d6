/** Ink: the strokes of each layer as pixels, finer than the drawing so that zooming stays crisp. */

import { context2d } from "./canvas.js";
import { linesOf } from "./document.js";
import { paperOf } from "./paper_ground.js";
import { decoded, hasHoles } from "./pictures.js";
import { averaged } from "./pixels.js";
import { boxOf, drawPiece, drawStroke, prepare, sidesOf } from "./strokes.js";

/** @typedef {{left: number, top: number, right: number, bottom: number}} Box in pixels of the drawing */

/** Maximum side of the ink in pixels, and maximum scale; more is slow and not visible. */
const FINE = 1536;
const MOST = 3;
/** Darkest level that counts as white paper. */
export const WHITE = 250;
const ALL = { left: -Infinity, top: -Infinity, right: Infinity, bottom: Infinity };

/** @param {Box | null} a @param {Box} b @returns {Box} */
const united = (a, b) => a
  ? {
      left: Math.min(a.left, b.left), top: Math.min(a.top, b.top),
      right: Math.max(a.right, b.right), bottom: Math.max(a.bottom, b.bottom),
    }
  : b;

/**
 * Returns whether the ink is grey or coloured, and whether white paper lies under it.
 * @param {import("./document.js").Stroke[]} strokes
 * @returns {{channels: 1 | 4, onPaper: boolean}}
 */
export function kindOf(strokes) {
  const pictures = strokes.filter((stroke) => stroke.kind === "picture");
  return { channels: pictures.length ? 4 : 1, onPaper: !pictures.length || !pictures.every((stroke) => !stroke.paper && hasHoles(stroke.picture)) };
}

/** Whether there are pictures, whose paper or paint would hide fills under it. @param {import("./document.js").Stroke[]} strokes */
export const isPictured = (strokes) => strokes.some(({ kind }) => kind === "picture");

/** Whether imported pictures have paper, which would hide what is under it. @param {import("./document.js").Stroke[]} strokes */
export function hasPaper(strokes) {
  const { channels, onPaper } = kindOf(strokes);
  return channels === 4 && onPaper;
}

/** @typedef {{width: number, height: number, strokes: import("./document.js").Stroke[]}} Drawn a layer's strokes, and the size of its paper */

/**
 * Returns the paper of a layer's pictures, which an eraser leaves there; null if they have none.
 * @param {CanvasRenderingContext2D} context in pixels of the drawing @param {Drawn} drawn
 */
function patternOf(context, { width, height, strokes }) {
  const pictures = strokes.filter(({ kind }) => kind === "picture");
  if (!hasPaper(pictures)) return null;
  const paper = paperOf({ width, height, strokes: pictures });
  const pattern = context.createPattern(paper, "no-repeat");
  pattern?.setTransform(new DOMMatrix().scale(width / paper.width, height / paper.height));
  return pattern;
}

/** Returns a layer's fills and what erases them; nothing if there are no fills. @param {import("./document.js").Stroke[]} strokes */
function fillsOf(strokes) {
  const some = strokes.filter(({ kind }) => kind === "fill" || kind === "eraser");
  return some.every(({ kind }) => kind === "eraser") ? [] : some;
}

/**
 * Draws strokes at another size than their own.
 * @param {Drawn} doc
 * @param {number} longest longer side in pixels
 * @param {"lines" | "fills"} what
 * @returns {{canvas: HTMLCanvasElement, scale: number, pixels: () => {channels: 1 | 4, bytes: Uint8Array}}} the lines on
 *   nothing; and as the server takes them
 */
export function inkAt(doc, longest, what = "lines") {
  const strokes = what === "lines" ? linesOf(doc.strokes) : fillsOf(doc.strokes);
  const scale = longest / Math.max(doc.width, doc.height);
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [Math.max(1, Math.round(doc.width * scale)), Math.max(1, Math.round(doc.height * scale))];
  const context = context2d(canvas, { willReadFrequently: true });
  context.scale(canvas.width / doc.width, canvas.height / doc.height);
  context.imageSmoothingQuality = "high";
  const paper = what === "lines" && strokes.some(({ kind }) => kind === "eraser") ? patternOf(context, doc) : null;
  for (const stroke of strokes) drawStroke(context, stroke, decoded, paper);
  const { channels, onPaper } = kindOf(strokes);
  const pixels = () => ({ channels, bytes: averaged(context, [0, 0, canvas.width, canvas.height], 1, channels, onPaper) });
  return { canvas, scale, pixels };
}

/**
 * Draws the lines of all visible layers at another size; each eraser only affects its own layer.
 * @param {import("./document.js").Doc} doc
 * @param {number} longest longer side in pixels
 * @param {boolean} [filled] whether the filled areas are drawn too
 * @returns {HTMLCanvasElement} lines on nothing
 */
export function linesAt(doc, longest, filled = false) {
  const { width, height } = doc;
  const layers = doc.layers.filter(({ visible }) => visible);
  const [first, ...others] = layers.map(({ strokes }) => {
    const { canvas } = inkAt({ width, height, strokes }, longest);
    if (filled) {
      const context = context2d(canvas);
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.globalCompositeOperation = isPictured(strokes) ? "multiply" : "destination-over";
      context.drawImage(inkAt({ width, height, strokes }, longest, "fills").canvas, 0, 0);
    }
    return canvas;
  });
  if (!first) return inkAt({ width, height, strokes: [] }, longest).canvas;
  const context = context2d(first);
  context.setTransform(1, 0, 0, 1, 0, 0);
  for (const [i, canvas] of others.entries()) {
    // The paper of an imported picture would hide what is behind it.
    context.globalCompositeOperation = hasPaper(layers[i + 1].strokes) ? "multiply" : "source-over";
    context.drawImage(canvas, 0, 0);
  }
  return first;
}

export class Ink {
  /** @param {number} [scale] ink pixels per drawing pixel; 0 chooses automatically */
  constructor(scale = 0) {
    this.canvas = document.createElement("canvas");
    this.context = context2d(this.canvas, { willReadFrequently: true });
    /**
     * The same ink at the drawing's own size, if it has pictures and the canvas is larger: enlarged and averaged, they would not be what they were.
     * @type {CanvasRenderingContext2D | null}
     */
    this.plain = null;
    this.fixed = scale;
    this.width = this.height = this.scale = 0;
    /** @type {import("./document.js").Stroke[]} */
    this.drawn = [];
    /** @type {import("./document.js").Line | null} the current stroke */
    this.live = null;
    /** @type {{pictures: import("./document.js").Stroke[], pattern: CanvasPattern | null}} what erasers leave of pictures */
    this.paper = { pictures: [], pattern: null };
    this.pieces = 0;
    /** @type {Box | null} the box that has changed since the last call of `pixels` */
    this.stale = ALL;
  }

  /** Makes the pixels match the strokes, and only draws new strokes if the others are unchanged. @param {Drawn} doc */
  sync(doc) {
    const begun = this.drawn.length <= doc.strokes.length && this.drawn.every((each, i) => each === doc.strokes[i]);
    const sized = doc.width === this.width && doc.height === this.height;
    // If the next stroke is the current one, it has already been drawn.
    if (this.live && begun && sized && doc.strokes[this.drawn.length] === this.live) {
      this.drawn = [...this.drawn, this.live];
      this.live = null;
    }
    const pictured = this.plain !== null || this.scale === 1 || !doc.strokes.some(({ kind }) => kind === "picture");
    if (!begun || !sized || !pictured || this.live) this.#clear(doc);
    for (const stroke of doc.strokes.slice(this.drawn.length)) {
      const paper = stroke.kind === "eraser" ? this.#paper(doc.strokes) : null;
      for (const context of this.#contexts()) drawStroke(context, stroke, decoded, paper);
      this.stale = united(this.stale, stroke.kind === "picture" ? ALL : boxOf(stroke, 0));
    }
    this.drawn = doc.strokes;
  }

  /**
   * Draws the new part of the current stroke; a later `sync` with it as the last stroke keeps it.
   * @param {import("./document.js").Line} line
   * @param {boolean} ended
   * @returns {Box} where something changed
   */
  draw(line, ended) {
    if (this.live !== line) [this.live, this.pieces] = [line, 0];
    const count = line.points.length / 3;
    const box = boxOf(line, Math.max(0, this.pieces - 1));
    const sides = sidesOf(line, Math.max(0, this.pieces - 1));
    const paper = line.kind === "eraser" ? this.#paper(this.drawn) : null;
    for (const context of this.#contexts()) {
      prepare(context, line.kind, line.colour, paper);
      for (let i = this.pieces; i < count - 1; i++) for (const side of sides) drawPiece(context, side, i, false);
      if (ended) for (const side of sides) drawPiece(context, side, count - 1, true);
    }
    this.pieces = Math.max(this.pieces, count - 1);
    this.stale = united(this.stale, box);
    return box;
  }

  /**
   * Returns the drawing at its own size: grey on white paper if all strokes are black, otherwise in colour; and without
   * paper if a picture was cut out, because its opacity then shows the object.
   * @param {boolean} whole whether the whole drawing is returned, or only the box that has changed since the last call
   * @returns {{channels: 1 | 4, box: [number, number, number, number], bytes: Uint8Array}} left, top, right, bottom
   */
  pixels(whole) {
    const { channels, onPaper } = kindOf(this.drawn);
    const { left, top, right, bottom } = whole ? ALL : this.stale ?? { left: 0, top: 0, right: 0, bottom: 0 };
    this.stale = null;
    /** @param {number} value @param {number} most */
    const clamp = (value, most) => Math.max(0, Math.min(most, value));
    const box = /** @type {[number, number, number, number]} */ ([
      clamp(Math.floor(left), this.width), clamp(Math.floor(top), this.height),
      clamp(Math.ceil(right), this.width), clamp(Math.ceil(bottom), this.height),
    ]);
    return { channels, box, bytes: averaged(this.plain ?? this.context, box, this.plain ? 1 : this.scale, channels, onPaper) };
  }

  /** Returns what an eraser leaves of pictures. @param {import("./document.js").Stroke[]} strokes */
  #paper(strokes) {
    const pictures = strokes.filter(({ kind }) => kind === "picture");
    const { paper, context, width, height } = this;
    if (pictures.length !== paper.pictures.length || pictures.some((each, i) => each !== paper.pictures[i])) {
      this.paper = { pictures, pattern: patternOf(context, { width, height, strokes: pictures }) };
    }
    return this.paper.pattern;
  }

  #contexts() {
    return this.plain ? [this.context, this.plain] : [this.context];
  }

  /** Returns whether there is no ink, or all of it was erased. */
  isBlank() {
    const { stale } = this;
    const { bytes, channels } = this.pixels(true);
    this.stale = stale; // nothing has been sent to the server
    return bytes.every((value, i) => (channels === 4 && i % 4 === 3) || value > WHITE);
  }

  /** @param {Drawn} doc */
  #clear(doc) {
    this.live = null;
    this.drawn = [];
    this.stale = ALL;
    [this.width, this.height] = [doc.width, doc.height];
    this.scale = this.fixed || Math.max(1, Math.min(MOST, Math.floor(FINE / Math.max(doc.width, doc.height))));
    // Setting the size clears the canvas and resets its state.
    [this.canvas.width, this.canvas.height] = [doc.width * this.scale, doc.height * this.scale];
    this.context.scale(this.scale, this.scale);
    this.context.imageSmoothingQuality = "high";
    this.plain = null;
    if (this.scale === 1 || !doc.strokes.some(({ kind }) => kind === "picture")) return;
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [doc.width, doc.height];
    this.plain = context2d(canvas, { willReadFrequently: true });
    this.plain.imageSmoothingQuality = "high";
  }
}

/** The ink of each layer. */
export class Inks {
  constructor() {
    /** @type {Map<number, Ink>} by the layer's id */
    this.known = new Map();
    /** @type {Map<number, Ink>} the areas of layers that have any, by the layer's id */
    this.filled = new Map();
  }

  /** Whether a stroke is being drawn. */
  get live() {
    return [...this.known.values()].some((ink) => ink.live !== null);
  }

  /** @param {import("./document.js").Layer} layer @returns {Ink} */
  of({ id }) {
    const ink = this.known.get(id) ?? new Ink();
    this.known.set(id, ink);
    return ink;
  }

  /** Returns the filled areas of a layer, if it has any. @param {import("./document.js").Layer} layer */
  underLines({ id }) {
    return this.filled.get(id)?.canvas;
  }

  /**
   * Draws the new part of the current stroke of a layer, see `Ink.draw`.
   * @param {import("./document.js").Layer} layer @param {import("./document.js").Line} line @param {boolean} ended
   */
  draw(layer, line, ended) {
    if (line.kind === "eraser") this.filled.get(layer.id)?.draw(line, ended);
    return this.of(layer).draw(line, ended);
  }

  /** Makes the pixels match a document. @param {import("./document.js").Doc} doc */
  sync({ width, height, layers }) {
    const before = this.filled;
    this.filled = new Map();
    for (const layer of layers) {
      this.of(layer).sync({ width, height, strokes: linesOf(layer.strokes) });
      const strokes = fillsOf(layer.strokes);
      if (strokes.length) this.filled.set(layer.id, before.get(layer.id) ?? new Ink());
      this.filled.get(layer.id)?.sync({ width, height, strokes });
    }
    const ids = new Set(layers.map(({ id }) => id));
    for (const id of this.known.keys()) if (!ids.has(id)) this.known.delete(id);
  }
}
