/** Keyboard pen: a cursor on the board, moved with the arrow keys, that draws, erases and sets points. */

import { isNothing } from "../drawing/selection.js";
import { say, text } from "../text/text.js";

/** @type {Record<string, [number, number]>} */
export const ARROWS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** Handles keys on a focused board. */
export class KeyboardPen {
  /** @type {import("./tools.js").Tool | null} the tool of the current stroke */
  #active = null;

  /**
   * @param {import("./board.js").Board} board
   * @param {() => import("./tools.js").Tool | null} tool
   * @param {import("../elements/status.js").Status} status
   */
  constructor(board, tool, status) {
    this.board = board;
    this.tool = tool;
    this.status = status;
    board.canvas.addEventListener("keydown", (event) => this.#key(event));
    board.canvas.addEventListener("pointerdown", () => this.#lift(), { capture: true });
    board.canvas.addEventListener("blur", () => {
      this.#lift();
      board.cursor = null;
      board.redraw();
    });
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { editor } = this.board;
    const arrow = ARROWS[event.key];
    if (arrow && editor.tool === "select" && !this.#active && !isNothing(editor.selection)) return; // it is nudged
    if (arrow) this.#move(arrow, Math.max(1, (event.shiftKey ? 0.08 : 0.02) * Math.max(editor.doc.width, editor.doc.height)));
    else if (event.key === "Enter") this.#press();
    else if (event.key === "Escape" && this.#active) this.#lift();
    else return;
    event.preventDefault();
  }

  /** Returns the cursor, which starts at the centre. @returns {import("./board.js").Point} */
  #place() {
    const { board } = this;
    const { width, height } = board.editor.doc;
    board.cursor ??= { x: width / 2, y: height / 2 };
    board.redraw();
    return board.cursor;
  }

  /** @param {[number, number]} way @param {number} step */
  #move([dx, dy], step) {
    const cursor = this.#place();
    const { width, height } = this.board.editor.doc;
    cursor.x = Math.max(0, Math.min(width - 0.01, cursor.x + dx * step));
    cursor.y = Math.max(0, Math.min(height - 0.01, cursor.y + dy * step));
    this.#active?.move(this.#touch());
    this.status.say(say("at", { x: Math.round(cursor.x), y: Math.round(cursor.y) }));
  }

  /** Puts the pen down, or lifts it up. */
  #press() {
    this.#place(); // seen even where the tool leaves no mark
    const { board: { editor }, status } = this;
    const chosen = this.tool();
    if (this.#active) {
      this.#active.up();
      this.#active = null;
      status.say(text.penUp);
    } else if (chosen) {
      chosen.down(this.#touch());
      // One press sets a point or fills an area, but a stroke lasts until the next press.
      if (["hint", "fill"].includes(editor.tool) || (editor.tool === "mask" && editor.fills)) chosen.up();
      else {
        this.#active = chosen;
        status.say(text.penDown);
      }
    }
  }

  /** Cancels the current stroke. */
  #lift() {
    this.#active?.cancel();
    this.#active = null;
  }

  #touch() {
    const { scale } = this.board.camera;
    return { ...this.#place(), pressure: 0.5, reach: 14 / scale, scale };
  }
}
