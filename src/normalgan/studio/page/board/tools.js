/** Tools: the interface of a tool for pointer and keyboard gestures, and the light tool. */

/**
 * @typedef {{x: number, y: number, pressure: number, reach: number, scale: number,
 *   pane?: {x: number, y: number}, straight?: boolean, eraser?: boolean}} Touch in the drawing; reach: distance that counts as a hit; scale:
 *   pixels of the pane per pixel of the drawing; pane: its place in the pane; straight: whether the user wants a straight
 *   line, or to extend the selection; eraser: whether it is the eraser end of the pen
 */

/**
 * @typedef {object} Tool a tool that handles gestures on the board, from press to release
 * @property {(touch: Touch) => void} down
 * @property {(touch: Touch) => void} move
 * @property {() => void} up
 * @property {() => void} cancel
 */

/** Light: dragging over the result moves the light. */
export class LightTool {
  /** @param {(x: number, y: number) => void} move over a point of the pane */
  constructor(move) {
    this.shine = move;
  }

  /** @param {Touch} touch */
  down({ pane }) {
    if (pane) this.shine(pane.x, pane.y);
  }

  /** @param {Touch} touch */
  move(touch) {
    this.down(touch);
  }

  up() {}

  cancel() {}
}
