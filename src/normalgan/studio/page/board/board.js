/** Board: a pane of the drawing or of its result: the sheet, and above it points, suggestions and the tool's nib. */

import { clear, context2d } from "../drawing/canvas.js";
import { Camera } from "./camera.js";
import { drawAreas, drawGuides, drawHints, drawMaskStroke, drawRings, drawSuggestions, drawVote } from "./marks.js";
import { drawSelection } from "./selection_frame.js";
import { Sheet } from "./sheet.js";

/** @typedef {{x: number, y: number}} Point */

/** Whether a sheet shows two documents alike. @param {import("../drawing/document.js").Doc} a @param {import("../drawing/document.js").Doc} b */
function showsAlike(a, b) {
  if (a.pictures !== b.pictures || a.active !== b.active || a.layers.length !== b.layers.length) return false;
  return a.layers.every(({ id, visible, strokes }, i) => {
    const other = b.layers[i];
    return id === other.id && visible === other.visible && strokes === other.strokes;
  });
}

export class Board {
  /**
   * @param {HTMLCanvasElement} canvas above, which takes the pointer
   * @param {HTMLCanvasElement} below for the sheet
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../drawing/ink.js").Inks} inks
   * @param {import("./camera.js").View} view shared by all panes
   * @param {HTMLElement} [focus] takes the keys; by default the canvas
   */
  constructor(canvas, below, editor, inks, view, focus = canvas) {
    this.canvas = canvas;
    this.focus = focus;
    this.context = context2d(canvas);
    this.editor = editor;
    this.view = view;
    this.camera = new Camera(view);
    this.camera.doc = editor.doc;
    this.sheet = new Sheet(below, editor, inks, this.camera);
    /** @type {Point | null} where the keyboard's cursor is, in the drawing */
    this.cursor = null;
    /** @type {Point | null} where the pointer is, in the drawing */
    this.pointer = null;
    /** Returns the area between lines about a point, and what it is. @type {(at: Point) => import("../drawing/areas.js").Vote | null} */
    this.voteAt = () => null;
    /** Whether points are on show. @type {() => boolean} */
    this.marked = () => true;
    /** Called after each picture, for what floats above. @type {() => void} */
    this.onDrawn = () => {};
    /** Called when the camera has moved. @type {() => void} */
    this.onMoved = () => {};
    this.frame = 0;
    let shown = editor.doc;
    editor.addEventListener("change", () => {
      inks.sync(editor.doc);
      this.camera.doc = editor.doc;
      // A point that moves leaves the sheet as it is.
      if (!showsAlike(editor.doc, shown)) this.sheet.redraw();
      if (editor.doc.width !== shown.width || editor.doc.height !== shown.height) this.moved();
      shown = editor.doc;
      this.redraw();
    });
    editor.addEventListener("drawing", (event) => this.sheet.redraw(/** @type {CustomEvent} */ (event).detail.box));
    for (const name of ["state", "marks"]) editor.addEventListener(name, () => this.redraw());
    view.addEventListener("change", () => this.moved());
    new ResizeObserver(() => this.#resized()).observe(canvas);
    inks.sync(editor.doc);
  }

  /** Whether the pane is on show. */
  get visible() {
    return this.canvas.clientWidth > 0;
  }

  get pane() {
    return this.camera.pane;
  }

  /** Draws all anew, after the camera has moved. */
  moved() {
    this.sheet.redraw();
    this.redraw();
    this.onMoved();
  }

  /** Draws what lies above the sheet with the next frame. */
  redraw() {
    this.frame ||= requestAnimationFrame(() => this.#draw());
  }

  #resized() {
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) return; // another pane has all the room
    const [width, height] = [clientWidth, clientHeight].map((side) => Math.round(side * devicePixelRatio));
    [this.canvas.width, this.canvas.height] = [width, height];
    this.camera.pane = { width: clientWidth, height: clientHeight };
    this.sheet.resize(width, height);
    this.onMoved();
    this.#draw();
  }

  #draw() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { context, camera, editor } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    clear(context);
    context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    if (this.marked()) drawGuides(context, camera, editor);
    const over = this.cursor ?? this.pointer;
    if (editor.tool === "mask" && editor.fills && over) drawVote(context, camera, this.voteAt(over), over);
    drawMaskStroke(context, camera, editor);
    drawAreas(context, camera, editor);
    drawSuggestions(context, camera, editor);
    if (this.marked()) drawHints(context, camera, editor);
    drawSelection(context, camera, editor);
    drawRings(context, camera, editor);
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
    if (!at || (!width && !this.cursor) || (editor.tool === "mask" && editor.fills && !this.cursor)) return;
    const { x, y } = camera.toPane(at.x, at.y);
    const radius = Math.max(2, ((width ?? 8) / 2) * camera.scale);
    for (const [colour, line] of [["rgb(255 255 255 / 80%)", 3], ["rgb(40 40 60 / 80%)", 1]]) {
      [context.strokeStyle, context.lineWidth] = [/** @type {string} */ (colour), /** @type {number} */ (line)];
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
