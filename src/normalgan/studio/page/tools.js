/** Tools: what a gesture does, whether it comes from a pointer or from the keyboard. */

import { MOST_AREAS, anchorOf, changedHint, withArea, withHint, withStroke } from "./document.js";
import { nearest } from "./marks.js";
import { meanNormal, normalAt } from "./normal.js";
import { Smoother } from "./smoothing.js";
import { text } from "./text.js";

/** @typedef {{x: number, y: number, pressure: number, reach: number}} Touch in the drawing; reach: what counts as hit */

export const MOST_HINTS = 200;
/**
 * @typedef {object} Tool what works on the board from the pointer's or the keyboard's press to its end
 * @property {(touch: Touch) => void} down
 * @property {(touch: Touch) => void} move
 * @property {() => void} up
 * @property {() => void} cancel
 */
/** @param {number} value */
const round = (value) => Math.round(value * 100) / 100;

/** Pen and eraser: a stroke from down to up. */
export class LineTool {
  /** @param {import("./board.js").Board} board */
  constructor(board) {
    this.board = board;
    /** @type {import("./document.js").Line | null} */
    this.line = null;
    this.smoother = new Smoother(0, 1);
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor, camera } = this.board;
    const kind = editor.tool === "eraser" ? "eraser" : "pen";
    this.line = { kind, size: editor.widths[kind], points: [] };
    this.smoother = new Smoother(editor.smoothing, camera.scale);
    this.move(touch);
  }

  /** @param {Touch} touch */
  move(touch) {
    if (!this.line) return;
    this.#add(this.line, this.smoother.move(touch));
    this.board.sheet.redraw(this.board.ink.draw(this.line, false));
    this.board.editor.draw();
  }

  up() {
    if (!this.line) return;
    const { line, board } = this;
    const end = this.smoother.end();
    if (end) this.#add(line, end);
    this.line = null;
    board.sheet.redraw(board.ink.draw(line, true));
    board.editor.commit(withStroke(board.editor.doc, line));
  }

  cancel() {
    if (!this.line) return;
    this.line = null;
    this.board.ink.sync(this.board.editor.doc);
    this.board.sheet.redraw();
    this.board.editor.drop();
  }

  /** @param {import("./document.js").Line} line @param {{x: number, y: number, pressure: number}} tip */
  #add(line, { x, y, pressure }) {
    const point = [round(x), round(y), round(pressure)];
    const last = line.points.slice(-3);
    if (point.some((value, i) => value !== last[i])) line.points.push(...point);
  }
}

/** Points: a click pins or chooses one, dragging moves it. */
export class HintTool {
  /**
   * @param {import("./board.js").Board} board
   * @param {() => import("./painter.js").Painted | null} map what was painted last
   * @param {(words: string) => void} announce
   */
  constructor(board, map, announce) {
    this.board = board;
    this.map = map;
    this.announce = announce;
    /** @type {{index: number, dx: number, dy: number, from: Touch, moved: boolean} | null} */
    this.held = null;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this.board;
    const { doc } = editor;
    const index = nearest(doc.hints, touch, touch.reach);
    if (index >= 0) {
      const { x, y } = doc.hints[index];
      this.held = { index, dx: x - touch.x, dy: y - touch.y, from: touch, moved: false };
      editor.set({ chosen: index });
      return;
    }
    const suggestion = nearest(editor.suggestions, touch, touch.reach);
    if (suggestion >= 0) this.accept(suggestion);
    else this.add(touch, normalAt(this.map(), touch.x / doc.width, touch.y / doc.height));
  }

  /** @param {Touch} touch */
  move(touch) {
    const { held, board } = this;
    if (!held) return;
    held.moved ||= Math.hypot(touch.x - held.from.x, touch.y - held.from.y) > touch.reach / 4;
    if (!held.moved) return;
    const at = this.#inside({ x: touch.x + held.dx, y: touch.y + held.dy });
    board.editor.preview(changedHint(board.editor.history.state, held.index, at));
  }

  up() {
    if (this.held?.moved) this.board.editor.commit(this.board.editor.doc);
    this.held = null;
  }

  cancel() {
    this.held = null;
    this.board.editor.drop();
  }

  /** Takes a suggestion as a point. @param {number} index */
  accept(index) {
    const { editor } = this.board;
    const { normal, ...at } = editor.suggestions[index];
    if (this.add(at, normal)) editor.set({ suggestions: editor.suggestions.filter((_, i) => i !== index) });
  }

  /**
   * Pins a point.
   * @param {{x: number, y: number}} at @param {import("./document.js").Normal} normal
   * @returns {boolean} whether there was room for it
   */
  add(at, normal) {
    const { editor } = this.board;
    const { width, height, hints } = editor.doc;
    if (at.x < 0 || at.y < 0 || at.x >= width || at.y >= height) return false;
    if (hints.length >= MOST_HINTS) {
      this.announce(text.tooMany);
      return false;
    }
    editor.commit(withHint(editor.doc, { ...this.#inside(at), normal }));
    editor.set({ chosen: hints.length });
    return true;
  }

  /** Middles of pixels: there the server puts a hint anyway. @param {{x: number, y: number}} at */
  #inside({ x, y }) {
    const { width, height } = this.board.editor.doc;
    /** @param {number} value @param {number} side */
    const clamp = (value, side) => Math.max(0, Math.min(side - 1, Math.floor(value))) + 0.5;
    return { x: clamp(x, width), y: clamp(y, height) };
  }
}

/** Region and brush: what is circled is turned as a whole, what is brushed gets a direction; the ball tells which. */
export class AreaTool {
  /**
   * @param {import("./board.js").Board} board
   * @param {() => import("./painter.js").Painted | null} map what was painted last
   * @param {(words: string) => void} announce
   */
  constructor(board, map, announce) {
    this.board = board;
    this.map = map;
    this.announce = announce;
    /** @type {number[] | null} */
    this.points = null;
    /** @type {number | undefined} */
    this.size = undefined;
    this.step = 0;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this.board;
    const index = nearest(editor.doc.areas.map(anchorOf), touch, touch.reach);
    if (index >= 0) {
      editor.set({ area: index });
      return;
    }
    if (editor.doc.areas.length >= MOST_AREAS) {
      this.announce(text.tooManyAreas);
      return;
    }
    this.points = [];
    this.size = editor.tool === "brush" ? editor.widths.brush : undefined;
    this.step = touch.reach / 5;
    this.move(touch);
  }

  /** @param {Touch} touch */
  move({ x, y }) {
    if (!this.points) return;
    const { points } = this;
    const [lastX, lastY] = points.slice(-2);
    const far = points.length < 2 || Math.hypot(x - lastX, y - lastY) > this.step;
    if (!far || points.length >= 4000) return;
    points.push(round(x), round(y));
    this.board.editor.outline = { points, normal: [0, 0, 1], ...(this.size && { size: this.size }) };
    this.board.redraw();
  }

  up() {
    const { points, size } = this;
    this.cancel();
    if (!points || (!size && points.length < 6)) return;
    const { editor } = this.board;
    const { doc } = editor;
    const normal = size
      ? editor.direction ?? normalAt(this.map(), points[0] / doc.width, points[1] / doc.height)
      : meanNormal(this.map(), points, doc);
    editor.commit(withArea(doc, { points, normal, ...(size && { size }) }));
    editor.set({ area: doc.areas.length });
  }

  cancel() {
    this.points = null;
    this.board.editor.outline = null;
    this.board.redraw();
  }
}
