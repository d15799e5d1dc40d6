/** Ink: the strokes of a document as pixels, finer than the drawing so that zooming stays crisp. */

import { decoded, hasHoles } from "./pictures.js";
import { boxOf, drawPiece, drawStroke, prepare } from "./strokes.js";

/** Finer than this many pixels a side, or than threefold, costs more than it shows. */
const FINE = 1536;
const MOST = 3;

export class Ink {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.context = this.canvas.getContext("2d", { willReadFrequently: true });
    this.width = this.height = this.scale = 0;
    /** @type {import("./document.js").Stroke[]} */
    this.drawn = [];
    this.live = null;
    this.pieces = 0;
  }

  /** Makes the pixels those of a document; what was drawn already is kept. @param {import("./document.js").Doc} doc */
  sync(doc) {
    const begun = this.drawn.length <= doc.strokes.length && this.drawn.every((each, i) => each === doc.strokes[i]);
    const sized = doc.width === this.width && doc.height === this.height;
    // The stroke that was just drawn with the hand is there already, if it is the next.
    if (this.live && begun && sized && doc.strokes[this.drawn.length] === this.live) {
      this.drawn = [...this.drawn, this.live];
      this.live = null;
    }
    if (!begun || !sized || this.live) this.#clear(doc);
    for (const stroke of doc.strokes.slice(this.drawn.length)) drawStroke(this.context, stroke, decoded);
    this.drawn = doc.strokes;
  }

  /**
   * Draws what a stroke has got since the last call; `sync` with it as the last stroke keeps it.
   * @param {import("./document.js").Line} line
   * @param {boolean} ended
   * @returns {{left: number, top: number, right: number, bottom: number}} where something changed, in the drawing
   */
  draw(line, ended) {
    if (this.live !== line) [this.live, this.pieces] = [line, 0];
    prepare(this.context, line.kind);
    const count = line.points.length / 3;
    const box = boxOf(line, Math.max(0, this.pieces - 1));
    for (; this.pieces < count - 1; this.pieces++) drawPiece(this.context, line, this.pieces, false);
    if (ended) drawPiece(this.context, line, count - 1, true);
    return box;
  }

  /**
   * Returns the drawing as a PNG in its own size: on white paper, or on none where a picture was cut out,
   * since its opacity tells where the object is.
   * @returns {Promise<Blob>}
   */
  png() {
    const page = new OffscreenCanvas(this.width, this.height);
    const context = page.getContext("2d", { willReadFrequently: true });
    const pictures = this.drawn.filter((stroke) => stroke.kind === "picture");
    if (!pictures.length || !pictures.every((stroke) => hasHoles(stroke.picture))) {
      context.fillStyle = "#fff";
      context.fillRect(0, 0, this.width, this.height);
    }
    context.imageSmoothingQuality = "high";
    context.drawImage(this.canvas, 0, 0, this.width, this.height);
    return page.convertToBlob({ type: "image/png" });
  }

  /** @param {import("./document.js").Doc} doc */
  #clear(doc) {
    this.live = null;
    this.drawn = [];
    [this.width, this.height] = [doc.width, doc.height];
    this.scale = Math.max(1, Math.min(MOST, Math.floor(FINE / Math.max(doc.width, doc.height))));
    // Setting the size empties the canvas and resets its state.
    [this.canvas.width, this.canvas.height] = [doc.width * this.scale, doc.height * this.scale];
    this.context.scale(this.scale, this.scale);
    this.context.imageSmoothingQuality = "high";
  }
}
