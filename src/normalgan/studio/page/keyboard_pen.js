/** Keyboard pen: a cursor on the board that arrow keys move and that draws, erases and pins. */

import { say, text } from "./text.js";

/** Pixels that Shift nudges. */
const FAR = 10;
/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/**
 * Lets keys work on a board that has the focus.
 * @param {import("./board.js").Board} board
 * @param {() => import("./tools.js").Tool | null} tool
 * @param {import("./status.js").Status} status
 * @param {(x: number, y: number) => boolean} nudge moves what is selected; whether there is something
 */
export function followKeyboard(board, tool, status, nudge) {
  const { canvas, editor } = board;
  /** @type {ReturnType<typeof tool>} the stroke that goes on */
  let active = null;
  const touch = () => {
    const { scale } = board.camera;
    return { x: 0, y: 0, ...board.cursor, pressure: 0.5, reach: 14 / scale, scale };
  };

  /** @param {[number, number]} way @param {number} step */
  const move = ([dx, dy], step) => {
    const { width, height } = editor.doc;
    board.cursor ??= { x: width / 2, y: height / 2 };
    board.cursor.x = Math.max(0, Math.min(width - 0.01, board.cursor.x + dx * step));
    board.cursor.y = Math.max(0, Math.min(height - 0.01, board.cursor.y + dy * step));
    active?.move(touch());
    board.redraw();
    status.say(say("at", { x: Math.round(board.cursor.x), y: Math.round(board.cursor.y) }));
  };

  const press = () => {
    if (!board.cursor) return move([0, 0], 0);
    const chosen = tool();
    if (active) {
      active.up();
      active = null;
      status.say(text.penUp);
    } else if (chosen) {
      chosen.down(touch());
      // A point is pinned, and an area filled, by one press; a stroke goes on until the next.
      if (editor.tool === "hint" || (editor.tool === "mask" && editor.fills)) chosen.up();
      else {
        active = chosen;
        status.say(text.penDown);
      }
    }
    return undefined;
  };

  const lift = () => {
    active?.cancel();
    active = null;
  };

  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = ARROWS[event.key];
    const far = event.shiftKey ? FAR : 1;
    if (arrow && editor.tool === "select" && !active && nudge(arrow[0] * far, arrow[1] * far)) event.preventDefault();
    else if (arrow) move(arrow, Math.max(1, (event.shiftKey ? 0.08 : 0.02) * Math.max(editor.doc.width, editor.doc.height)));
    else if (event.key === "Enter") press();
    else if (event.key === "Escape" && active) lift();
    else return;
    event.preventDefault();
  });
  canvas.addEventListener("pointerdown", lift, { capture: true });
  canvas.addEventListener("blur", () => {
    lift();
    board.cursor = null;
    board.redraw();
  });
}
