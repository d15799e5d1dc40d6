/** Board: a pane of the drawing or of its result, with points, suggestions and the tool's cursor above the sheet. */

import { clear, context2d } from "../drawing/canvas.js";
import { Camera } from "./camera.js";
import { drawAreas, drawGuides, drawHints, drawMaskStroke, drawRings, drawSuggestions, drawTint, drawVote } from "./marks.js";
import { drawSelection } from "./selection_frame.js";
import { Sheet } from "./sheet.js";

/** @typedef {{x: number, y: number}} Point */

/** Whether two documents look the same on a sheet. @param {import("../drawing/document.js").Doc} a @param {import("../drawing/document.js").Doc} b */
function showsAlike(a, b) {
  if (a.pictures !== b.pictures || a.active !== b.active || a.layers.length !== b.layers.length) return false;
  return a.layers.every(({ id, visible, strokes }, i) => {
    const other = b.layers[i];
    return id === other.id && visible === other.visible && strokes === other.strokes;
  });
}

export class Board {
  /**
   * @param {HTMLCanvasElement} canvas the upper canvas, which receives pointer events
   * @param {HTMLCanvasElement} below the lower canvas, for the sheet
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../drawing/ink.js").Inks} inks
   * @param {import("./camera.js").View} view shared by all panes
   * @param {HTMLElement} [focus] the element that receives key events; by default the canvas
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
    /** @type {Point | null} position of the keyboard cursor in the drawing */
    this.cursor = null;
    /** @type {Point | null} position of the pointer in the drawing */
    this.pointer = null;
    /** Returns the enclosed area at a point, and whether it is object. @type {(at: Point) => import("../drawing/areas.js").Vote | null} */
    this.voteAt = () => null;
    /** Returns the area between lines at a point. @type {(at: Point) => import("../drawing/areas.js").Area | null} */
    this.areaAt = () => null;
    /** Whether points are shown. @type {() => boolean} */
    this.marked = () => true;
    /** Called after each redraw, to update floating elements. @type {() => void} */
    this.onDrawn = () => {};
    /** Called when the camera has moved. @type {() => void} */
    this.onMoved = () => {};
    this.frame = 0;
    let shown = editor.doc;
    editor.addEventListener("change", () => {
      inks.sync(editor.doc);
      this.camera.doc = editor.doc;
      // Moving a point does not change the sheet.
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

  /** Whether the pane is visible. */
  get visible() {
    return this.canvas.clientWidth > 0;
  }

  get pane() {
    return this.camera.pane;
  }

  /** Redraws everything after the camera has moved. */
  moved() {
    this.sheet.redraw();
    this.redraw();
    this.onMoved();
  }

  /** Redraws everything above the sheet in the next frame. */
  redraw() {
    this.frame ||= requestAnimationFrame(() => this.#draw());
  }

  #resized() {
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) return; // another pane fills the window
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
    if (["region", "fill"].includes(editor.tool) && over) drawTint(context, camera, this.areaAt(over));
    drawMaskStroke(context, camera, editor);
    drawAreas(context, camera, editor);
    drawSuggestions(context, camera, editor);
    if (this.marked()) drawHints(context, camera, editor);
    drawSelection(context, camera, editor);
    drawRings(context, camera, editor);
    this.#nib();
    this.onDrawn();
  }

  /** Draws the outline of the tool at the pointer or the keyboard cursor. */
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
