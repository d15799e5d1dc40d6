/** Sheet: paper, traced picture and ink, drawn where they changed. */

import { context2d } from "./canvas.js";
import { decoded } from "./pictures.js";

/** @typedef {{left: number, top: number, right: number, bottom: number}} Box in pixels of the drawing */

const ALL = { left: -Infinity, top: -Infinity, right: Infinity, bottom: Infinity };

export class Sheet {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import("./editor.js").Editor} editor
   * @param {import("./ink.js").Ink} ink
   * @param {import("./camera.js").Camera} camera
   */
  constructor(canvas, editor, ink, camera) {
    this.canvas = canvas;
    this.editor = editor;
    this.ink = ink;
    this.camera = camera;
    this.context = context2d(canvas);
    /** @type {Box | null} what is to be drawn with the next frame */
    this.stale = null;
    this.frame = 0;
  }

  /** Draws a part with the next frame. @param {Box} [box] */
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

  /**
   * Takes the size of its pane; at once, or it would flicker, as setting a size empties a canvas.
   * @param {number} width @param {number} height
   */
  resize(width, height) {
    [this.canvas.width, this.canvas.height] = [width, height];
    this.stale = ALL;
    this.#draw();
  }

  #draw() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { context, camera } = this;
    const { doc } = this.editor;
    const { left, top, right, bottom } = this.stale ?? ALL;
    this.stale = null;
    const ratio = devicePixelRatio;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.save();
    if (Number.isFinite(left)) {
      // Whole pixels, or edges would be blended twice.
      const [x, y] = [left * camera.scale + camera.x, top * camera.scale + camera.y].map((at) => Math.floor(at * ratio) - 1);
      const [x2, y2] = [right * camera.scale + camera.x, bottom * camera.scale + camera.y].map((at) => Math.ceil(at * ratio) + 1);
      context.beginPath();
      context.rect(x, y, x2 - x, y2 - y);
      context.clip();
    }
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.setTransform(ratio * camera.scale, 0, 0, ratio * camera.scale, ratio * camera.x, ratio * camera.y);
    context.fillStyle = "#fff";
    context.fillRect(0, 0, doc.width, doc.height);
    context.beginPath();
    context.rect(0, 0, doc.width, doc.height);
    context.clip();
    const zoom = (camera.scale * ratio) / this.ink.scale;
    context.imageSmoothingEnabled = zoom < 8;
    // Mipmaps are dear, and only show where it gets much smaller.
    context.imageSmoothingQuality = zoom < 0.6 ? "medium" : "low";
    for (const layer of doc.layers.filter((each) => each.visible)) {
      context.globalAlpha = layer.opacity;
      context.drawImage(decoded(layer.picture), layer.x, layer.y, layer.width, layer.height);
    }
    context.globalAlpha = 1;
    // The paper of an imported drawing must not hide what is traced.
    if (doc.layers.length) context.globalCompositeOperation = "multiply";
    context.drawImage(this.ink.canvas, 0, 0, doc.width, doc.height);
    context.restore();
  }
}
