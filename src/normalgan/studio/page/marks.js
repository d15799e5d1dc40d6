/** Marks: how points and suggestions look on the board, and which one is meant by a click. */

import { anchorOf } from "./document.js";
import { colourOf } from "./normal.js";

/** @typedef {import("./camera.js").Camera} Camera @typedef {import("./editor.js").Editor} Editor */

const RADIUS = 9;
const NEEDLE = 22;
const ACCENT = "#5b62e0";
const PALE = "rgb(255 255 255 / 90%)";
const DARK = "#33343c";

/**
 * Draws a disc in the colour of its normal, with a needle that leans as the normal does.
 * @param {CanvasRenderingContext2D} context @param {{x: number, y: number}} at in the pane
 * @param {import("./document.js").Normal} normal @param {boolean} chosen
 */
function drawMark(context, { x, y }, normal, chosen) {
  const tip = { x: x + normal[0] * NEEDLE, y: y - normal[1] * NEEDLE };
  for (const { colour, width } of [{ colour: PALE, width: 5 }, { colour: chosen ? ACCENT : DARK, width: 2 }]) {
    [context.strokeStyle, context.lineWidth, context.lineCap] = [colour, width, "round"];
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(tip.x, tip.y);
    context.stroke();
    context.beginPath();
    context.arc(x, y, RADIUS, 0, 2 * Math.PI);
    context.stroke();
  }
  context.fillStyle = colourOf(normal);
  context.fill();
  context.fillStyle = chosen ? ACCENT : "#33343c";
  context.beginPath();
  context.arc(tip.x, tip.y, 2.5, 0, 2 * Math.PI);
  context.fill();
  if (!chosen) return;
  [context.strokeStyle, context.lineWidth] = [ACCENT, 2];
  context.beginPath();
  context.arc(x, y, RADIUS + 4, 0, 2 * Math.PI);
  context.stroke();
}

/** @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor */
export function drawHints(context, camera, editor) {
  editor.doc.hints.forEach((hint, i) => {
    drawMark(context, camera.toPane(hint.x, hint.y), hint.normal, i === editor.chosen);
  });
}

/**
 * Draws areas where a tool works on them.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor
 */
export function drawAreas(context, camera, editor) {
  if (!["hint", "region", "brush"].includes(editor.tool)) return;
  const { outline, doc } = editor;
  for (const [i, area] of [...doc.areas, ...(outline ? [outline] : [])].entries()) {
    const chosen = i === editor.area;
    context.beginPath();
    for (let k = 0; k < area.points.length; k += 2) {
      const { x, y } = camera.toPane(area.points[k], area.points[k + 1]);
      context.lineTo(x, y);
      if (area.points.length === 2) context.lineTo(x + 0.01, y); // a dab
    }
    [context.lineJoin, context.lineCap] = ["round", "round"];
    if (area.size) {
      context.lineWidth = area.size * camera.scale;
      context.globalAlpha = chosen ? 0.3 : 0.15;
      context.strokeStyle = ACCENT;
      context.stroke();
      context.globalAlpha = 1;
    } else {
      context.closePath();
      context.setLineDash([6, 4]);
      for (const { colour, width } of [{ colour: PALE, width: 4 }, { colour: chosen ? ACCENT : DARK, width: 1.5 }]) {
        [context.strokeStyle, context.lineWidth] = [colour, width];
        context.stroke();
      }
      context.setLineDash([]);
    }
    if (area === outline) continue;
    const at = anchorOf(area);
    drawMark(context, camera.toPane(at.x, at.y), area.normal, chosen);
  }
}

/** @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor */
export function drawSuggestions(context, camera, editor) {
  for (const point of editor.suggestions) {
    const { x, y } = camera.toPane(point.x, point.y);
    context.fillStyle = "rgb(255 255 255 / 85%)";
    [context.strokeStyle, context.lineWidth] = [ACCENT, 2];
    context.beginPath();
    context.arc(x, y, RADIUS + 1, 0, 2 * Math.PI);
    context.fill();
    context.setLineDash([3, 3]);
    context.stroke();
    context.setLineDash([]);
    context.beginPath();
    for (const [dx, dy] of [[1, 0], [0, 1]]) {
      context.moveTo(x - 4 * dx, y - 4 * dy);
      context.lineTo(x + 4 * dx, y + 4 * dy);
    }
    context.stroke();
  }
}

/**
 * Returns the index of the point nearest to where was clicked, or -1 if none is near.
 * @param {{x: number, y: number}[]} points in the drawing
 * @param {{x: number, y: number}} at in the drawing
 * @param {number} reach in pixels of the drawing
 */
export function nearest(points, at, reach) {
  let [best, least] = [-1, reach];
  points.forEach((point, i) => {
    const distance = Math.hypot(point.x - at.x, point.y - at.y);
    if (distance <= least) [best, least] = [i, distance];
  });
  return best;
}
