/** Sheet: the paper, pictures and ink of a pane, redrawn only where they changed. */

import { clear, context2d } from "../drawing/canvas.js";
import { isPictured } from "../drawing/ink.js";
import { invertedPaper } from "../drawing/paper_tone.js";
import { decoded } from "../drawing/pictures.js";
import { drawPicture } from "../drawing/strokes.js";

/** @typedef {{left: number, top: number, right: number, bottom: number}} Box in pixels of the drawing */
/**
 * @typedef {object} Part a vertical strip of the pane
 * @property {number} from start as a fraction of the pane's width
 * @property {number} to
 * @property {boolean} lines whether the ink is drawn
 * @property {boolean} paper whether paper and pictures are drawn below the ink
 */

/** Opacity of the lines of inactive layers. */
const OTHERS = 0.4;
const ALL = { left: -Infinity, top: -Infinity, right: Infinity, bottom: Infinity };
/** @type {Part[]} */
const WHOLE = [{ from: 0, to: 1, lines: true, paper: true }];

export class Sheet {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../drawing/ink.js").Inks} inks
   * @param {import("./camera.js").Camera} camera
   */
  constructor(canvas, editor, inks, camera) {
    this.canvas = canvas;
    this.editor = editor;
    this.inks = inks;
    this.camera = camera;
    this.context = context2d(canvas);
    this.parts = WHOLE;
    /** @type {HTMLCanvasElement | null} a tint over the whole drawing, below the ink */
    this.veil = null;
    /** @type {WeakMap<import("../drawing/ink.js").Ink, {pictures: object[], paper: HTMLCanvasElement | null, canvas: HTMLCanvasElement}>} ink without the paper of its pictures */
    this.lifted = new WeakMap();
    /** @type {Box | null} the region to redraw in the next frame */
    this.stale = null;
    this.frame = 0;
  }

  /** Redraws a region in the next frame. @param {Box} [box] */
  redraw(box = ALL) {
    const { stale } = this;
    this.stale = stale
      ? {
          left: Math.min(stale.left, box.left), top: Math.min(stale.top, box.top),
          right: Math.max(stale.right, box.right), bottom: Math.max(stale.bottom, box.bottom),
        }
      : box;
    this.frame ||= requestAnimationFrame(() => this.#draw());
  }

  /** Resizes the sheet and redraws it at once, because resizing clears the canvas and would make it flicker. @param {number} width @param {number} height */
  resize(width, height) {
    [this.canvas.width, this.canvas.height] = [width, height];
    this.stale = ALL;
    this.#draw();
  }

  #draw() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { canvas, context } = this;
    // A sheet that was hidden is out of date.
    const stale = canvas.hidden ? ALL : this.stale ?? ALL;
    this.stale = null;
    // Without a graphics card, blending even an empty sheet takes most of the time of a frame.
    canvas.hidden = !this.veil && this.parts.every(({ lines, paper }) => !lines && !paper);
    if (canvas.hidden) return;
    const { width, height } = canvas;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.save();
    if (Number.isFinite(stale.left)) this.#clip(stale);
    clear(context);
    for (const { from, to, lines, paper } of this.parts) {
      context.save();
      context.beginPath();
      context.rect(Math.round(from * width), 0, Math.round(to * width) - Math.round(from * width), height);
      context.clip();
      this.#part(lines, paper, stale);
      context.restore();
    }
    context.restore();
  }

  /** @param {Box} box */
  #clip({ left, top, right, bottom }) {
    const ratio = devicePixelRatio;
    const corners = [[left, top], [right, top], [right, bottom], [left, bottom]].map(([x, y]) => this.camera.toPane(x, y));
    // The box is rounded to whole pixels; otherwise its edges would be blended twice.
    const [x, y] = [corners.map((each) => each.x), corners.map((each) => each.y)].map((all) => Math.floor(Math.min(...all) * ratio) - 1);
    const [x2, y2] = [corners.map((each) => each.x), corners.map((each) => each.y)].map((all) => Math.ceil(Math.max(...all) * ratio) + 1);
    this.context.beginPath();
    this.context.rect(x, y, x2 - x, y2 - y);
    this.context.clip();
  }

  /**
   * Returns a layer's ink without the paper of its pictures, which would darken the result below it.
   * @param {import("../drawing/document.js").Layer} layer @param {Box} stale what has changed in it
   */
  #withoutPaper(layer, stale) {
    const { doc: { width, height } } = this.editor;
    const ink = this.inks.of(layer);
    const pictures = layer.strokes.filter(({ kind }) => kind === "picture");
    let known = this.lifted.get(ink);
    const { canvas: drawn } = ink;
    const sized = known?.canvas.width === drawn.width && known.canvas.height === drawn.height;
    const before = known?.pictures;
    if (!known || !sized || before?.length !== pictures.length || pictures.some((each, i) => each !== before[i])) {
      known = { pictures, paper: invertedPaper({ width, height, strokes: pictures }), canvas: document.createElement("canvas") };
      this.lifted.set(ink, known);
      stale = ALL;
    }
    const { paper, canvas } = known;
    if (!paper) return drawn;
    if (stale === ALL) [canvas.width, canvas.height] = [drawn.width, drawn.height];
    const context = context2d(canvas);
    const clamp = (/** @type {number} */ value, /** @type {number} */ most) => Math.max(0, Math.min(most, value));
    const [left, right] = [Math.floor(clamp(stale.left, width) * ink.scale), Math.ceil(clamp(stale.right, width) * ink.scale)];
    const [top, bottom] = [Math.floor(clamp(stale.top, height) * ink.scale), Math.ceil(clamp(stale.bottom, height) * ink.scale)];
    context.save();
    context.beginPath();
    context.rect(left, top, right - left, bottom - top);
    context.clip();
    context.globalCompositeOperation = "copy";
    context.drawImage(drawn, 0, 0);
    context.globalCompositeOperation = "color-dodge";
    context.drawImage(paper, 0, 0, canvas.width, canvas.height);
    context.globalCompositeOperation = "destination-in"; // nothing where ink was erased
    context.drawImage(drawn, 0, 0);
    context.restore();
    return canvas;
  }

  /** @param {boolean} lines @param {boolean} paper @param {Box} stale */
  #part(lines, paper, stale) {
    const { context, camera } = this;
    const { doc, layer: worked } = this.editor;
    const layers = doc.layers.filter(({ visible }) => visible);
    const ratio = devicePixelRatio;
    context.setTransform(...camera.transform(ratio));
    const zoom = (camera.scale * ratio) / this.inks.of(worked).scale;
    context.imageSmoothingEnabled = zoom < 8;
    // Mipmaps are slow and only matter when the ink is much reduced.
    context.imageSmoothingQuality = zoom < 0.6 ? "medium" : "low";
    if (paper) {
      context.fillStyle = "#fff";
      context.fillRect(0, 0, doc.width, doc.height);
    }
    // A reference picture may lie next to the paper.
    if (paper) for (const picture of doc.pictures.filter((each) => each.visible)) {
      context.globalAlpha = picture.opacity;
      drawPicture(context, decoded(picture.picture), picture);
    }
    context.globalAlpha = 1;
    context.beginPath();
    context.rect(0, 0, doc.width, doc.height);
    context.clip();
    if (this.veil) context.drawImage(this.veil, 0, 0, doc.width, doc.height);
    // The paper of an imported drawing must not hide reference pictures.
    const blended = doc.pictures.length > 0 || layers.length > 1 || !paper;
    if (lines) for (const layer of layers) {
      // Inactive layers are faded.
      context.globalAlpha = paper && layer !== worked ? OTHERS : 1;
      const fills = paper && this.inks.underLines(layer);
      if (fills) {
        context.globalCompositeOperation = "source-over";
        context.drawImage(fills, 0, 0, doc.width, doc.height);
      }
      context.globalCompositeOperation = blended || (fills && isPictured(layer.strokes)) ? "multiply" : "source-over";
      context.drawImage(paper ? this.inks.of(layer).canvas : this.#withoutPaper(layer, stale), 0, 0, doc.width, doc.height);
    }
    context.globalAlpha = 1;
    context.globalCompositeOperation = "source-over";
  }
}
