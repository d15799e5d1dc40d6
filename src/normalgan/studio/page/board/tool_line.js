/** Line tool: pen and eraser. */

import { MOST_STROKES, withStroke } from "../drawing/document.js";
import { quickShape } from "../drawing/quick_shape.js";
import { rounded } from "../drawing/simplify.js";
import { Smoother } from "../drawing/smoothing.js";
import { text } from "../text/text.js";

/** @typedef {import("./tools.js").Touch} Touch */

/** Angle in radians within which a straight line snaps to horizontal, vertical or diagonal. */
const SNAP = 0.06;
const ALL = { left: -Infinity, top: -Infinity, right: Infinity, bottom: Infinity };
/** Milliseconds that a pen must be held still at the end of a stroke to turn it into a shape; its maximum movement meanwhile; and the minimum length of the stroke, in pane pixels. */
const [HELD, STIRRED, LEAST_WAY] = [600, 4, 30];
/** Simulated pointers in tests pause whenever the machine is busy, so tests set a longer time. */
const heldFor = () => Number(document.documentElement.dataset.held ?? HELD);

/** Pen and eraser: draw a stroke from press to release. */
export class LineTool {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../drawing/ink.js").Inks} inks
   * @param {import("../elements/status.js").Announce} announce
   */
  constructor(editor, inks, announce) {
    this.editor = editor;
    this.inks = inks;
    this.announce = announce;
    /** @type {Touch | null} where the pen may be held still */
    this.rest = null;
    this.waiting = 0;
    /** @type {import("../drawing/document.js").Line | null} the original stroke, if it was turned into a shape */
    this.raw = null;
    /** @type {import("../drawing/document.js").Line | null} */
    this.line = null;
    /** @type {Touch | null} start of a straight line */
    this.start = null;
    this.smoother = new Smoother(0, 1);
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    const kind = editor.tool === "eraser" || touch.eraser ? "eraser" : "pen";
    const { colour, symmetry, doc } = editor;
    const carve = kind === "pen" ? editor.carves * editor.carveHeight : 0;
    if (editor.layer.strokes.length >= MOST_STROKES) {
      this.announce(text.tooManyStrokes, "warning");
      return;
    }
    this.line = {
      kind, size: editor.widths[kind], points: [], ...(kind === "pen" && colour !== "#000000" && { colour }), ...(carve && { carve }),
      ...(symmetry && { mirror: doc.width / 2 }),
    };
    this.start = editor.straight || touch.straight ? touch : null;
    this.rest = this.raw = null;
    this.smoother = new Smoother(editor.smoothing, touch.scale);
    this.move(touch);
  }

  /** @param {Touch} touch */
  move(touch) {
    if (!this.line) return;
    if (this.start) {
      this.#straight(touch);
      return;
    }
    if (this.raw) {
      if (!this.rest || Math.hypot(touch.x - this.rest.x, touch.y - this.rest.y) * touch.scale < LEAST_WAY) return;
      this.#goOn(touch);
    }
    this.#wait(touch);
    this.#add(this.smoother.move(touch));
    this.editor.draw(this.inks.draw(this.editor.layer, this.line, false));
  }

  up() {
    if (!this.line) return;
    const { line, raw, editor } = this;
    clearTimeout(this.waiting);
    if (!this.start && !raw) this.#add(this.smoother.end());
    this.line = this.raw = null;
    editor.guide = null;
    if (raw) {
      // Undo restores the original stroke.
      const before = editor.doc;
      editor.commit(withStroke(before, raw));
      editor.commit(withStroke(before, line));
      this.announce(text.shaped); // announced again, now that the stroke is finished
      return;
    }
    editor.draw(this.inks.draw(editor.layer, line, true), true);
    editor.commit(withStroke(editor.doc, line));
  }

  cancel() {
    if (!this.line) return;
    clearTimeout(this.waiting);
    this.line = this.raw = null;
    this.editor.guide = null;
    this.inks.sync(this.editor.doc);
    this.editor.draw(ALL, true);
    this.editor.drop();
  }

  /** Starts the timer for a pen that is held still. Keyboard strokes have no pane position and are ignored. @param {Touch} touch */
  #wait(touch) {
    if (!touch.pane || this.line?.kind !== "pen") return;
    if (this.rest && Math.hypot(touch.x - this.rest.x, touch.y - this.rest.y) * touch.scale < STIRRED) return;
    this.rest = touch;
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      // On a busy page, later movements only arrive with the next frame.
      requestAnimationFrame(() => this.rest === touch && this.#shape(touch));
    }, heldFor());
  }

  /** Restores the original stroke, because the pen was only pausing. @param {Touch} touch */
  #goOn({ scale }) {
    const { raw, editor, inks } = this;
    if (!raw) return;
    [this.line, this.raw, editor.guide] = [raw, null, null];
    const [x, y, pressure] = raw.points.slice(-3);
    this.smoother = new Smoother(editor.smoothing, scale);
    this.smoother.move({ x, y, pressure });
    inks.sync(editor.doc);
    editor.draw(ALL, true);
  }

  /** Turns the stroke into a shape, if it resembles one. @param {Touch} touch */
  #shape(touch) {
    const { line, editor, inks } = this;
    const { scale } = touch;
    if (!line) return;
    const end = this.smoother.end();
    const points = [...line.points, ...(end ? [end.x, end.y, end.pressure] : [])];
    const places = Array.from({ length: points.length / 3 }, (_, i) => ({ x: points[3 * i], y: points[3 * i + 1] }));
    const way = places.slice(1).reduce((sum, { x, y }, i) => sum + Math.hypot(x - places[i].x, y - places[i].y), 0);
    const shape = way * scale < LEAST_WAY ? null : quickShape(places);
    if (!shape) return;
    this.raw = { ...line, points };
    const pressure = rounded(points.reduce((sum, value, i) => (i % 3 === 2 ? sum + value : sum), 0) / places.length);
    // Lines are curved between points, but a repeated point gives a sharp corner.
    this.line = { ...line, points: shape.points.flatMap(({ x, y }) => Array.from({ length: shape.sharp ? 2 : 1 }, () => [rounded(x), rounded(y), pressure]).flat()) };
    // The end of the line can still be moved.
    if (shape.points.length === 2) this.start = { ...touch, ...shape.points[0] };
    inks.sync(editor.doc); // without the stroke
    editor.draw(ALL, true);
    editor.guide = this.line;
    editor.mark();
    this.announce(text.shaped);
  }

  /** Shows a straight line to the pointer, snapped to horizontal, vertical or diagonal. @param {Touch} touch */
  #straight(touch) {
    const { line, start, editor } = this;
    if (!line || !start) return;
    let [dx, dy] = [touch.x - start.x, touch.y - start.y];
    const [length, angle] = [Math.hypot(dx, dy), Math.atan2(dy, dx)];
    const exact = Math.round(angle / (Math.PI / 4)) * (Math.PI / 4);
    if (Math.abs(angle - exact) < SNAP) [dx, dy] = [length * Math.cos(exact), length * Math.sin(exact)];
    line.points = [rounded(start.x), rounded(start.y), 0.5];
    if (length > 0) line.points.push(rounded(start.x + dx), rounded(start.y + dy), 0.5);
    editor.guide = line;
    editor.mark();
  }

  /** @param {{x: number, y: number, pressure: number} | null} at */
  #add(at) {
    if (!at || !this.line) return;
    const point = [rounded(at.x), rounded(at.y), rounded(at.pressure)];
    const last = this.line.points.slice(-3);
    if (point.some((value, i) => value !== last[i])) this.line.points.push(...point);
  }
}
