/** Board: the pane of the drawing: the sheet, and above it points, suggestions and the tool's nib. */

import { Camera } from "./camera.js";
import { context2d } from "./canvas.js";
import { drawAreas, drawHints, drawSuggestions } from "./marks.js";
import { Sheet } from "./sheet.js";

export class Board {
  /**
   * @param {HTMLCanvasElement} canvas above, which takes pointer and keys
   * @param {HTMLCanvasElement} below for the sheet
   * @param {import("./editor.js").Editor} editor
   * @param {import("./ink.js").Ink} ink
   */
  constructor(canvas, below, editor, ink) {
    this.canvas = canvas;
    this.context = context2d(canvas);
    this.editor = editor;
    this.ink = ink;
    this.camera = new Camera();
    this.sheet = new Sheet(below, editor, ink, this.camera);
    this.pane = { width: 1, height: 1 };
    /** @type {{x: number, y: number} | null} where the keyboard's cursor is, in the drawing */
    this.cursor = null;
    /** @type {{x: number, y: number} | null} where the pointer is, in the drawing */
    this.pointer = null;
    /** Called after each picture, for what floats above. @type {() => void} */
    this.onDrawn = () => {};
    this.frame = 0;
    let shown = editor.doc;
    editor.addEventListener("change", () => {
      ink.sync(editor.doc);
      // A point that moves leaves the sheet as it is.
      if (editor.doc.strokes !== shown.strokes || editor.doc.layers !== shown.layers) this.sheet.redraw();
      if (editor.doc.width !== shown.width || editor.doc.height !== shown.height) this.fit();
      shown = editor.doc;
      this.redraw();
    });
    editor.addEventListener("open", () => this.fit());
    editor.addEventListener("state", () => this.redraw());
    new ResizeObserver(() => this.#resized()).observe(canvas);
    ink.sync(editor.doc);
  }

  /** Shows all of the drawing. */
  fit() {
    this.camera.fit(this.pane, this.editor.doc);
    this.moved();
  }

  /** Zooms around the middle. @param {number} factor */
  zoom(factor) {
    this.camera.zoom(this.pane.width / 2, this.pane.height / 2, factor);
    this.moved();
  }

  /** Draws all anew, after the camera has moved. */
  moved() {
    this.sheet.redraw();
    this.redraw();
  }

  /** Draws what lies above the sheet with the next frame. */
  redraw() {
    this.frame ||= requestAnimationFrame(() => this.#draw());
  }

  #resized() {
    const { clientWidth, clientHeight } = this.canvas;
    const [width, height] = [clientWidth, clientHeight].map((side) => Math.round(side * devicePixelRatio));
    [this.canvas.width, this.canvas.height] = [width, height];
    this.pane = { width: clientWidth, height: clientHeight };
    if (this.camera.fitted) this.camera.fit(this.pane, this.editor.doc);
    this.sheet.resize(width, height);
    this.#draw();
  }

  #draw() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { context, camera, editor } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    drawAreas(context, camera, editor);
    drawSuggestions(context, camera, editor);
    drawHints(context, camera, editor);
    this.#nib();
    this.onDrawn();
  }

  /** Draws how wide the tool is, where the pointer or the keyboard's cursor is. */
  #nib() {
    const { context, camera, editor } = this;
    const at = this.cursor ?? this.pointer;
    /** @type {Record<string, number | undefined>} */
    const widths = editor.widths;
    const width = widths[editor.tool];
    if (!at || (!width && !this.cursor)) return;
    const { x, y } = camera.toPane(at.x, at.y);
    const radius = Math.max(2, ((width ?? 8) / 2) * camera.scale);
    for (const { colour, line } of [{ colour: "rgb(255 255 255 / 80%)", line: 3 }, { colour: "rgb(40 40 60 / 80%)", line: 1 }]) {
      [context.strokeStyle, context.lineWidth] = [colour, line];
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      if (this.cursor) for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.moveTo(x + dx * (radius + 3), y + dy * (radius + 3));
        context.lineTo(x + dx * (radius + 12), y + dy * (radius + 12));
      }
      context.stroke();
    }
  }
}
