/** Selecting: strokes and pictures are chosen, moved, made larger or smaller, and removed. */

import { activeLayer, withActive } from "./document.js";
import { aboutPoint, alongWith, extentOf, isHit, movedParts, movedPicture, unitedBox } from "./moving.js";

/** @typedef {import("./editor.js").Selection} Selection @typedef {import("./tools.js").Touch} Touch */

const ACCENT = "#5b62e0";
const HANDLE = 9;
const LEAST = 4;
/** Pixels from the box to the knob that turns it, and radians of its steps. */
const [KNOB, STEP] = [26, Math.PI / 12];
/** @type {Selection} */
export const NOTHING = { strokes: [], pictures: [] };

/** @param {Selection} selection */
export const isNothing = ({ strokes, pictures }) => !strokes.length && !pictures.length;

/** Returns what is chosen, as values. @param {import("./document.js").Doc} doc @param {Selection} selection */
const itemsOf = (doc, { strokes, pictures }) =>
  [...strokes.map((i) => activeLayer(doc).strokes[i]), ...pictures.map((i) => doc.pictures[i])];

/** Returns the box around all that is chosen. @param {import("./document.js").Doc} doc @param {Selection} selection */
export const boxOfSelection = (doc, selection) => unitedBox(itemsOf(doc, selection).map(extentOf));

/** @param {import("./moving.js").Box} box */
const cornersOf = ({ left, top, right, bottom }) => [[left, top], [right, top], [right, bottom], [left, bottom]].map(([x, y]) => ({ x, y }));

/** Where a selection is held to be turned: above its middle. @param {import("./moving.js").Box} box @param {number} scale pixels of the pane for one of the drawing */
const knobOf = ({ left, top, right }, scale) => ({ x: (left + right) / 2, y: top - KNOB / scale });
/** @param {{x: number, y: number}} at @returns {[number, number]} */
const pairOf = ({ x, y }) => [x, y];

export class SelectTool {
  /** @param {import("./editor.js").Editor} editor */
  constructor(editor) {
    this.editor = editor;
    /** @type {{kind: "move" | "scale" | "turn" | "around", from: Touch, fixed?: {x: number, y: number}, before: Selection} | null} */
    this.held = null;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    const { doc, selection } = editor;
    const box = boxOfSelection(doc, selection);
    if (box) {
      const knob = knobOf(box, touch.scale);
      if (Math.hypot(knob.x - touch.x, knob.y - touch.y) <= touch.reach) {
        this.held = { kind: "turn", from: touch, fixed: { x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 }, before: selection };
        return;
      }
      const corners = cornersOf(box);
      const corner = corners.findIndex(({ x, y }) => Math.hypot(x - touch.x, y - touch.y) <= touch.reach);
      if (corner >= 0) {
        this.held = { kind: "scale", from: touch, fixed: corners[(corner + 2) % 4], before: selection };
        return;
      }
    }
    const hit = this.#hit(touch);
    if (!hit) {
      this.held = { kind: "around", from: touch, before: touch.straight ? selection : NOTHING };
      if (!touch.straight) editor.set({ selection: NOTHING });
      return;
    }
    const has = selection.strokes.includes(hit.strokes[0]) || selection.pictures.includes(hit.pictures[0]);
    if (touch.straight) editor.set({ selection: has ? without(selection, hit) : together(selection, hit) });
    else if (!has) editor.set({ selection: hit });
    this.held = { kind: "move", from: touch, before: editor.selection };
  }

  /** @param {Touch} touch */
  move(touch) {
    const { held, editor } = this;
    if (!held) return;
    if (held.kind === "around") {
      editor.marquee = unitedBox([held.from, touch].map(({ x, y }) => ({ left: x, top: y, right: x, bottom: y })));
      editor.mark();
      return;
    }
    /** @type {import("./moving.js").Move} */
    let move = { scale: 1, x: touch.x - held.from.x, y: touch.y - held.from.y };
    if (held.fixed && held.kind === "turn") {
      const { x, y } = held.fixed;
      const direction = (/** @type {{x: number, y: number}} */ at) => Math.atan2(at.y - y, at.x - x);
      const angle = direction(touch) - direction(held.from);
      // With Shift in steps.
      move = aboutPoint(held.fixed, { scale: 1, angle: touch.straight ? Math.round(angle / STEP) * STEP : angle });
    } else if (held.fixed) {
      const { x, y } = held.fixed;
      const length = (/** @type {{x: number, y: number}} */ at) => Math.hypot(at.x - x, at.y - y);
      const scale = Math.max(0.02, Math.min(50, length(touch) / Math.max(length(held.from), LEAST)));
      move = { scale, x: x * (1 - scale), y: y * (1 - scale) };
    } else if (!editor.draft && Math.hypot(move.x, move.y) < touch.reach / 4) return;
    const { doc, selection } = withMoved(editor.history.state, held.before, move);
    editor.selection = selection;
    editor.preview(doc);
  }

  up() {
    const { held, editor } = this;
    const { marquee } = editor;
    this.held = null;
    editor.marquee = null;
    if (held?.kind === "around" && marquee) {
      const inside = (/** @type {import("./document.js").Stroke | import("./document.js").Picture} */ item) => {
        const { left, top, right, bottom } = extentOf(item);
        return left >= marquee.left && right <= marquee.right && top >= marquee.top && bottom <= marquee.bottom;
      };
      const strokes = editor.layer.strokes.flatMap((stroke, i) => (stroke.kind !== "eraser" && inside(stroke) ? [i] : []));
      const pictures = editor.doc.pictures.flatMap((picture, i) => (inside(picture) ? [i] : []));
      editor.set({ selection: together(held.before, { strokes, pictures }) });
    } else if (editor.draft) editor.commit(editor.draft);
    else editor.mark();
  }

  cancel() {
    if (this.held && this.held.kind !== "around") this.editor.selection = this.held.before;
    this.held = null;
    this.editor.marquee = null;
    this.editor.drop();
  }

  /** Removes what is chosen. @returns {boolean} whether there was something */
  remove() {
    const { editor } = this;
    const { strokes, pictures } = editor.selection;
    if (isNothing(editor.selection)) return false;
    const { doc, layer } = editor;
    editor.set({ selection: NOTHING });
    // Without any line, points and regions would be of nothing.
    const all = layer.strokes.every(({ kind }, i) => kind === "eraser" || strokes.includes(i));
    const kept = { strokes: layer.strokes.filter((_, i) => !strokes.includes(i)) };
    const left = strokes.length ? withActive(doc, all ? { strokes: [], hints: [], areas: [], mask: [] } : kept) : doc;
    editor.commit(pictures.length ? { ...left, pictures: doc.pictures.filter((_, i) => !pictures.includes(i)) } : left);
    return true;
  }

  /** Chooses all strokes. */
  all() {
    const strokes = this.editor.layer.strokes.flatMap((stroke, i) => (stroke.kind === "eraser" ? [] : [i]));
    this.editor.set({ tool: "select", selection: { strokes, pictures: [] } });
  }

  /** @param {Touch} touch @returns {Selection | null} what lies uppermost */
  #hit(touch) {
    const { layer: { strokes }, doc: { pictures } } = this.editor;
    for (let i = strokes.length - 1; i >= 0; i--) {
      if (strokes[i].kind !== "eraser" && isHit(strokes[i], touch, touch.reach / 3)) return { strokes: [i], pictures: [] };
    }
    for (let i = pictures.length - 1; i >= 0; i--) {
      if (pictures[i].visible && isHit(pictures[i], touch, 0)) return { strokes: [], pictures: [i] };
    }
    return null;
  }
}

/** @param {Selection} a @param {Selection} b @returns {Selection} */
function together(a, b) {
  const both = (/** @type {number[]} */ x, /** @type {number[]} */ y) => [...new Set([...x, ...y])].sort((p, q) => p - q);
  return { strokes: both(a.strokes, b.strokes), pictures: both(a.pictures, b.pictures) };
}

/** @param {Selection} a @param {Selection} b @returns {Selection} */
function without(a, b) {
  return { strokes: a.strokes.filter((i) => !b.strokes.includes(i)), pictures: a.pictures.filter((i) => !b.pictures.includes(i)) };
}

/**
 * @param {import("./document.js").Doc} doc @param {Selection} selection @param {import("./moving.js").Move} move
 * @returns {{doc: import("./document.js").Doc, selection: Selection}} selection: of the same in the new document
 */
export function withMoved(doc, { strokes, pictures }, move) {
  const layer = activeLayer(doc);
  const { layer: moved, chosen } = strokes.length ? movedParts(layer, alongWith(layer, strokes), move, doc) : { layer, chosen: [] };
  const drawn = strokes.length ? withActive(doc, moved) : doc;
  const placed = doc.pictures.map((each, i) => (pictures.includes(i) ? movedPicture(each, move) : each));
  return { doc: pictures.length ? { ...drawn, pictures: placed } : drawn, selection: { strokes: chosen, pictures } };
}

/**
 * Draws the box around what is chosen, with a handle at each corner, and the box that is being drawn around more.
 * @param {CanvasRenderingContext2D} context
 * @param {import("./camera.js").Camera} camera
 * @param {import("./editor.js").Editor} editor
 */
export function drawSelection(context, camera, editor) {
  if (editor.tool !== "select") return;
  const box = boxOfSelection(editor.doc, editor.selection);
  for (const each of [box, editor.marquee]) {
    if (!each) continue;
    context.beginPath();
    const corners = cornersOf(each).map(({ x, y }) => camera.toPane(x, y));
    for (const { x, y } of corners) context.lineTo(x, y);
    context.closePath();
    context.setLineDash(each === box ? [] : [5, 4]);
    for (const [colour, width] of /** @type {[string, number][]} */ ([["rgb(255 255 255 / 90%)", 3], [ACCENT, 1.5]])) {
      [context.strokeStyle, context.lineWidth] = [colour, width];
      context.stroke();
    }
    context.setLineDash([]);
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
