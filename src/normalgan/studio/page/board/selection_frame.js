/** Selection frame: the box around the selection, with handles to scale and rotate it. */

import { boxOfSelection } from "../drawing/selection.js";

const ACCENT = "#5b62e0";
/** Width of a corner handle in pixels, and distance of the rotation knob from the box. */
const [HANDLE, KNOB] = [9, 26];

/** @param {import("../drawing/moving.js").Box} box */
export const cornersOf = ({ left, top, right, bottom }) => [[left, top], [right, top], [right, bottom], [left, bottom]].map(([x, y]) => ({ x, y }));

/** Returns the position of the rotation knob, above the centre of the selection. @param {import("../drawing/moving.js").Box} box @param {number} scale pixels of the pane for one of the drawing */
export const knobOf = ({ left, top, right }, scale) => ({ x: (left + right) / 2, y: top - KNOB / scale });
/** @param {{x: number, y: number}} at @returns {[number, number]} */
const pairOf = ({ x, y }) => [x, y];

/**
 * Draws the box around the selection with a handle at each corner, and the current marquee or lasso.
 * @param {CanvasRenderingContext2D} context
 * @param {import("./camera.js").Camera} camera
 * @param {import("../drawing/editor.js").Editor} editor
 */
export function drawSelection(context, camera, editor) {
  if (editor.tool !== "select") return;
  for (const points of [...(editor.selection.lasso ?? []), ...(editor.lasso ? [editor.lasso] : [])]) {
    context.beginPath();
    for (let i = 0; i < points.length; i += 2) context.lineTo(...pairOf(camera.toPane(points[i], points[i + 1])));
    if (points !== editor.lasso) context.closePath();
    outline(context, true);
  }
  const box = boxOfSelection(editor.doc, editor.selection);
  for (const each of [box, editor.marquee]) {
    if (!each) continue;
    context.beginPath();
    const corners = cornersOf(each).map(({ x, y }) => camera.toPane(x, y));
    for (const { x, y } of corners) context.lineTo(x, y);
    context.closePath();
    outline(context, each !== box);
    if (each !== box) continue;
    const knob = camera.toPane(...pairOf(knobOf(each, camera.scale)));
    context.beginPath();
    context.arc(knob.x, knob.y, HANDLE / 2 + 1, 0, 2 * Math.PI);
    context.fillStyle = ACCENT;
    context.fill();
    for (const { x, y } of corners) {
      context.fillStyle = "#fff";
      context.fillRect(x - HANDLE / 2, y - HANDLE / 2, HANDLE, HANDLE);
      context.strokeRect(x - HANDLE / 2, y - HANDLE / 2, HANDLE, HANDLE);
    }
  }
}

/** Draws a line that is visible on light and dark backgrounds. @param {CanvasRenderingContext2D} context @param {boolean} dashed */
function outline(context, dashed) {
  context.setLineDash(dashed ? [5, 4] : []);
  for (const [colour, width] of /** @type {[string, number][]} */ ([["rgb(255 255 255 / 90%)", 3], [ACCENT, 1.5]])) {
    [context.strokeStyle, context.lineWidth] = [colour, width];
    context.stroke();
  }
  context.setLineDash([]);
}
