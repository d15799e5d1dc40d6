/** Marks: draw points and suggestions on the board, and find the one at a click. */

import { anchorOf, knobOf, reachOf } from "../drawing/document.js";
import { colourOf } from "../drawing/normal.js";
import { sidesOf } from "../drawing/strokes.js";
import { text } from "../text/text.js";

/** @typedef {import("./camera.js").Camera} Camera @typedef {import("../drawing/editor.js").Editor} Editor */

const RADIUS = 9;
const NEEDLE = 22;
const RING = 18;
const ACCENT = "#5b62e0";
const ADDED = "#189a5a";
const PALE = "rgb(255 255 255 / 90%)";
const DARK = "#33343c";
const CUT = "#d0342c";

/**
 * Draws a disc in the colour of its normal, with a needle that leans like the normal.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {{x: number, y: number}} at in the drawing
 * @param {import("../drawing/document.js").Normal} normal @param {boolean} chosen
 */
function drawMark(context, camera, at, normal, chosen) {
  const { x, y } = camera.toPane(at.x, at.y);
  const [cos, sin] = [Math.cos(camera.view.angle), Math.sin(camera.view.angle)];
  const tip = { x: x + (normal[0] * cos + normal[1] * sin) * NEEDLE, y: y + (normal[0] * sin - normal[1] * cos) * NEEDLE };
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

/**
 * Draws the reach of a point as a ring with a knob to drag.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {import("../drawing/document.js").Hint} hint
 */
function drawReach(context, camera, hint) {
  const { doc, scale } = camera;
  const at = camera.toPane(hint.x, hint.y);
  const knob = knobOf(hint, doc, scale);
  const { x, y } = camera.toPane(knob.x, knob.y);
  for (const { colour, width } of [{ colour: PALE, width: 3.5 }, { colour: ACCENT, width: 1.5 }]) {
    [context.strokeStyle, context.lineWidth] = [colour, width];
    context.setLineDash([5, 4]);
    context.beginPath();
    context.arc(at.x, at.y, reachOf(hint, doc) * scale, 0, 2 * Math.PI);
    context.stroke();
    context.setLineDash([]);
    context.beginPath();
    context.arc(x, y, 6, 0, 2 * Math.PI);
    context.stroke();
  }
  context.fillStyle = "#fff";
  context.fill();
}

/** @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor */
export function drawHints(context, camera, editor) {
  const chosen = editor.layer.hints[editor.chosen];
  if (chosen && editor.tool === "hint") drawReach(context, camera, chosen);
  editor.layer.hints.forEach((hint, i) => {
    drawMark(context, camera, hint, hint.normal, i === editor.chosen);
  });
}

/**
 * Draws areas while a tool that edits them is active.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor
 */
export function drawAreas(context, camera, editor) {
  if (!["hint", "region", "brush"].includes(editor.tool)) return;
  const { outline, layer } = editor;
  for (const [i, area] of [...layer.areas, ...(outline ? [outline] : [])].entries()) {
    const chosen = i === editor.area;
    context.beginPath();
    for (let k = 0; k < area.points.length; k += 2) {
      const { x, y } = camera.toPane(area.points[k], area.points[k + 1]);
      context.lineTo(x, y);
      if (area.points.length === 2) context.lineTo(x + 0.01, y); // a dab
    }
    [context.lineJoin, context.lineCap] = ["round", "round"];
    if (area.size) {
      // A tint would hide the effect while the ball is rotated; a structure is visible by itself.
      if (chosen && editor.draft) continue;
      if (area.structure) {
        drawMark(context, camera, anchorOf(area), area.normal, chosen);
        continue;
      }
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
    drawMark(context, camera, at, area.normal, chosen);
  }
}

/**
 * Draws a line or shape that is not yet in the ink, and the axis of symmetry.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor
 */
export function drawGuides(context, camera, editor) {
  const { doc, guide, symmetry } = editor;
  if (symmetry && ["pen", "eraser"].includes(editor.tool)) {
    const [from, to] = [camera.toPane(doc.width / 2, 0), camera.toPane(doc.width / 2, doc.height)];
    [context.strokeStyle, context.lineWidth] = [ACCENT, 1];
    context.setLineDash([8, 6]);
    context.beginPath();
    context.moveTo(from.x, from.y);
    context.lineTo(to.x, to.y);
    context.stroke();
    context.setLineDash([]);
  }
  if (!guide) return;
  context.lineCap = "round";
  context.lineWidth = guide.size * camera.scale;
  context.strokeStyle = guide.kind === "eraser" ? "rgb(200 200 210 / 80%)" : guide.colour ?? "#000";
  for (const { points } of sidesOf(guide)) {
    context.beginPath();
    for (let i = 0; i < points.length; i += 3) {
      const { x, y } = camera.toPane(points[i], points[i + 1]);
      context.lineTo(x, y);
    }
    context.stroke();
  }
}

/**
 * Draws the current stroke of the mask brush; finished strokes show in the object itself.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor
 */
export function drawMaskStroke(context, camera, editor) {
  const { maskStroke } = editor;
  if (!maskStroke) return;
  const { points, size, adds } = maskStroke;
  context.beginPath();
  for (let k = 0; k < points.length; k += 2) {
    const { x, y } = camera.toPane(points[k], points[k + 1]);
    context.lineTo(x, y);
    if (points.length === 2) context.lineTo(x + 0.01, y); // a dab
  }
  [context.lineJoin, context.lineCap, context.lineWidth] = ["round", "round", size * camera.scale];
  context.globalAlpha = 0.5;
  context.strokeStyle = adds ? ADDED : CUT;
  context.stroke();
  context.globalAlpha = 1;
}

/**
 * Tints an enclosed area. An area that is open to the paper's edge has no tint.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {import("../drawing/areas.js").Area | null} area
 * @param {"object" | "hole"} tint
 */
export function drawTint(context, camera, area, tint = "object") {
  if (!area || area.open) return;
  context.save();
  context.transform(...camera.transform());
  context.drawImage(area.pictures[tint], 0, 0, camera.doc.width, camera.doc.height);
  context.restore();
}

/**
 * Tints the enclosed area that a click would flip, and labels it.
 * @param {CanvasRenderingContext2D} context @param {Camera} camera @param {import("../drawing/areas.js").Vote | null} vote
 * @param {{x: number, y: number}} at where the pointer is, in the drawing
 */
export function drawVote(context, camera, vote, at) {
  if (!vote || vote.area.open) return;
  drawTint(context, camera, vote.area, vote.object ? "object" : "hole");
  const words = vote.object ? text.isObject : text.isHole;
  const { x, y } = camera.toPane(at.x, at.y);
  context.font = "13px system-ui, sans-serif";
  const width = context.measureText(words).width + 16;
  const left = Math.max(4, Math.min(camera.pane.width - width - 4, x - width / 2));
  const top = y > 60 ? y - 46 : y + 24;
  context.fillStyle = vote.object ? ACCENT : CUT;
  context.beginPath();
  context.roundRect(left, top, width, 26, 8);
  context.fill();
  [context.fillStyle, context.textBaseline] = ["#fff", "middle"];
  context.fillText(words, left + 8, top + 13);
}

/** Draws rings at the places of findings. @param {CanvasRenderingContext2D} context @param {Camera} camera @param {Editor} editor */
export function drawRings(context, camera, editor) {
  for (const [left, top] of editor.ringed) {
    const { x, y } = camera.toPane(left, top);
    for (const { colour, width } of [{ colour: PALE, width: 7 }, { colour: CUT, width: 3 }]) {
      [context.strokeStyle, context.lineWidth] = [colour, width];
      context.beginPath();
      context.arc(x, y, RING, 0, 2 * Math.PI);
      context.stroke();
    }
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
 * Returns the index of the point nearest to a click, or -1 if none is near.
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
