/** Selecting: chooses, moves, scales, turns and removes strokes, pictures and parts of pictures. */

import { activeLayer, withActive } from "./document.js";
import { NOTHING } from "./editor.js";
import { chosenBy, insideOf, takeParts } from "./lasso.js";
import { aboutPoint, alongWith, extentOf, isHit, movedParts, movedPicture, unitedBox } from "./moving.js";
import { makeRoom } from "./simplify.js";
import { say, text } from "./text.js";

/** @typedef {import("./editor.js").Selection} Selection @typedef {import("./tools.js").Touch} Touch */

const ACCENT = "#5b62e0";
/** Pixels that the handle at a corner is wide. */
const HANDLE = 9;
/** Pixels of the drawing from which the hand scales at least: nearer to the fixed corner each would do too much. */
const LEAST = 4;
/** How far one drag scales. */
const SCALES = { least: 0.02, most: 50 };
/** Pixels from the box to the knob that turns it, and radians of its steps. */
const [KNOB, STEP] = [26, Math.PI / 12];

/** @param {Selection} selection */
export const isNothing = (selection) => !hasInk(selection) && !selection.pictures.length;

/** Whether anything of the layer is chosen. @param {Selection} selection */
export const hasInk = ({ strokes, cuts }) => strokes.length > 0 || Boolean(cuts?.length);

/** Returns what tells which points, regions and mask go along with what is chosen; null: what lies among it. @param {Selection} selection */
export const insideOfSelection = ({ lasso }) => (lasso ? insideOf(lasso) : null);

/** Returns what is chosen, as values. @param {import("./document.js").Doc} doc @param {Selection} selection */
const itemsOf = (doc, { strokes, pictures }) =>
  [...strokes.map((i) => activeLayer(doc).strokes[i]), ...pictures.map((i) => doc.pictures[i])];

/** Returns the box around all that is chosen. @param {import("./document.js").Doc} doc @param {Selection} selection */
export const boxOfSelection = (doc, selection) =>
  unitedBox([...itemsOf(doc, selection).map(extentOf), ...(selection.cuts ?? []).map(({ box }) => box)]);

/** Whether all is there that is to be cut: a worker does it, beside the page. @param {Selection} selection */
export const isCut = ({ cuts }) => !cuts?.some(({ parts }) => !parts);

/**
 * Does what needs the parts of cut pictures: at once, or once they are there, unless something else is chosen by then.
 * @param {import("./editor.js").Editor} editor @param {import("./status.js").Announce} announce @param {() => void} act
 */
export function onceCut(editor, announce, act) {
  const { selection } = editor;
  if (isCut(selection)) {
    act();
    return;
  }
  announce(text.cutting);
  Promise.all((selection.cuts ?? []).map(({ ready }) => ready)).then(() => {
    if (editor.selection !== selection) return;
    announce("");
    act();
  }).catch((error) => announce(say("broken", { reason: error instanceof Error ? error.message : String(error) }), "warning"));
}

/**
 * Cuts the pictures of which only a part is chosen, and chooses that part.
 * @param {import("./document.js").Doc} doc @param {Selection} selection
 * @returns {{doc: import("./document.js").Doc, selection: Selection}} the same if there is none
 */
export function withCuts(doc, selection) {
  const { strokes: whole, pictures, cuts, lasso } = selection;
  if (!cuts?.length) return { doc, selection };
  /** @type {import("./document.js").Stroke[]} */
  const strokes = [];
  /** @type {number[]} */
  const chosen = [];
  for (const [i, stroke] of activeLayer(doc).strokes.entries()) {
    const cut = cuts.find(({ index }) => index === i);
    const parts = cut && takeParts(cut);
    strokes.push(...(parts ? [parts.rest, parts.piece] : [stroke]));
    if (parts || whole.includes(i)) chosen.push(strokes.length - 1);
  }
  return { doc: withActive(doc, { strokes }), selection: { strokes: chosen, pictures, lasso } };
}

/** @param {import("./moving.js").Box} box */
const cornersOf = ({ left, top, right, bottom }) => [[left, top], [right, top], [right, bottom], [left, bottom]].map(([x, y]) => ({ x, y }));

/** Where a selection is held to be turned: above its middle. @param {import("./moving.js").Box} box @param {number} scale pixels of the pane for one of the drawing */
const knobOf = ({ left, top, right }, scale) => ({ x: (left + right) / 2, y: top - KNOB / scale });
/** @param {{x: number, y: number}} at @returns {[number, number]} */
const pairOf = ({ x, y }) => [x, y];

/**
 * @typedef {object} Held a drag that goes on
 * @property {"move" | "scale" | "turn" | "around"} kind
 * @property {Touch} from where it began
 * @property {{x: number, y: number}} [fixed] what stays where it is while it scales or turns
 * @property {Selection} before
 * @property {Touch} [late] where the hand is before the parts of cut pictures are there
 */

/** Returns how a drag moves, scales or turns what is chosen. @param {Held} held @param {Touch} touch @returns {import("./moving.js").Move} */
function moveOf({ kind, from, fixed }, touch) {
  if (!fixed) return { scale: 1, x: touch.x - from.x, y: touch.y - from.y };
  if (kind === "turn") {
    const direction = (/** @type {Touch} */ at) => Math.atan2(at.y - fixed.y, at.x - fixed.x);
    const angle = direction(touch) - direction(from);
    // With Shift in steps.
    return aboutPoint(fixed, { scale: 1, angle: touch.straight ? Math.round(angle / STEP) * STEP : angle });
  }
  const length = (/** @type {Touch} */ at) => Math.hypot(at.x - fixed.x, at.y - fixed.y);
  const scale = Math.max(SCALES.least, Math.min(SCALES.most, length(touch) / Math.max(length(from), LEAST)));
  return aboutPoint(fixed, { scale });
}

export class SelectTool {
  /** @param {import("./editor.js").Editor} editor @param {import("./status.js").Announce} announce */
  constructor(editor, announce) {
    this.editor = editor;
    this.announce = announce;
    /** @type {Held | null} */
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
    if (!touch.straight && insideOfSelection(selection)?.(touch)) {
      this.held = { kind: "move", from: touch, before: selection };
      return;
    }
    if (!hit || (editor.lassoes && !isIn(selection, hit))) {
      this.held = { kind: "around", from: touch, before: touch.straight ? selection : NOTHING };
      if (!touch.straight) editor.set({ selection: NOTHING });
      return;
    }
    const has = isIn(selection, hit);
    if (touch.straight) editor.set({ selection: has ? without(selection, hit) : together(selection, hit) });
    else if (!has) editor.set({ selection: hit });
    this.held = { kind: "move", from: touch, before: editor.selection };
  }

  /** @param {Touch} touch */
  move(touch) {
    const { held, editor } = this;
    if (!held) return;
    if (held.kind === "around") {
      this.#drawAround(held.from, touch);
      return;
    }
    if (!isCut(held.before)) {
      if (!held.late) onceCut(editor, this.announce, () => this.held === held && held.late && this.move(held.late));
      held.late = touch;
      return;
    }
    const move = moveOf(held, touch);
    // A press that stirs a little only chooses.
    if (!held.fixed && !editor.draft && Math.hypot(move.x, move.y) < touch.reach / 4) return;
    const { doc, selection } = withMoved(editor.history.state, held.before, move);
    editor.selection = selection;
    editor.preview(doc);
  }

  /** Draws a line or a box around what is to be chosen. @param {Touch} from where it began @param {Touch} touch */
  #drawAround(from, touch) {
    const { editor } = this;
    if (editor.lassoes) {
      editor.lasso ??= [from.x, from.y];
      const [x, y] = editor.lasso.slice(-2);
      if (Math.hypot(touch.x - x, touch.y - y) > touch.reach / 5) {
        makeRoom(editor.lasso);
        editor.lasso.push(touch.x, touch.y);
      }
    } else {
      editor.marquee = unitedBox([from, touch].map(({ x, y }) => ({ left: x, top: y, right: x, bottom: y })));
    }
    editor.mark();
  }

  up() {
    const { held, editor } = this;
    const { marquee, lasso } = editor;
    this.held = null;
    if (held?.late && !isCut(held.before)) {
      const { late } = held;
      onceCut(editor, this.announce, () => {
        this.held = held;
        this.move(late);
        this.up();
      });
      return;
    }
    editor.marquee = editor.lasso = null;
    if (held?.kind === "around" && editor.lassoes) this.#drawnAround(held, lasso ?? []);
    else if (held?.kind === "around" && marquee) {
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
    this.editor.marquee = this.editor.lasso = null;
    this.editor.drop();
  }

  /** Chooses what lies within a lasso; one that is only a click chooses what is there. @param {{from: Touch, before: Selection}} held @param {number[]} drawn */
  #drawnAround({ from, before }, drawn) {
    const { editor } = this;
    const { layer, doc } = editor;
    if (drawn.length < 6) {
      const hit = this.#hit(from);
      if (hit) editor.set({ selection: isIn(before, hit) ? without(before, hit) : together(before, hit) });
      else editor.mark();
      return;
    }
    const lasso = [...(before.lasso ?? []), drawn];
    const inside = insideOf(lasso);
    const { strokes, cuts } = chosenBy(layer, lasso);
    const pictures = doc.pictures.flatMap((picture, i) => (cornersOf(extentOf(picture)).every(inside) ? [i] : []));
    const found = together({ strokes: before.strokes, pictures: before.pictures }, { strokes, pictures });
    // A picture that was chosen whole is cut no more.
    const selection = { ...found, cuts: cuts.filter(({ index }) => !found.strokes.includes(index)), lasso };
    this.#choose(selection);
    if (isCut(selection)) return;
    Promise.all(cuts.map(({ ready }) => ready)).then(() => {
      if (editor.selection !== selection) return;
      // What is darker there is the paper's own shade.
      const inked = selection.cuts.filter(({ parts }) => parts?.piece.width);
      if (inked.length < selection.cuts.length) this.#choose({ ...selection, cuts: inked });
      else editor.mark();
    }).catch((error) => this.announce(say("broken", { reason: error instanceof Error ? error.message : String(error) }), "warning"));
  }

  /** @param {Selection} selection of a lasso */
  #choose(selection) {
    const none = isNothing(selection);
    this.editor.set({ selection: none ? NOTHING : selection });
    if (none) this.announce(text.lassoEmpty, "warning");
  }

  /** Removes what is chosen, and says so. */
  remove() {
    const { editor } = this;
    if (isNothing(editor.selection)) return;
    onceCut(editor, this.announce, () => {
      this.#remove();
      this.announce(text.selectRemoved);
    });
  }

  #remove() {
    const { editor } = this;
    const { doc, selection: { strokes, pictures } } = withCuts(editor.doc, editor.selection);
    const layer = activeLayer(doc);
    editor.set({ selection: NOTHING });
    // Without any line, points and regions would be of nothing.
    const all = layer.strokes.every(({ kind }, i) => kind === "eraser" || strokes.includes(i));
    const kept = { strokes: layer.strokes.filter((_, i) => !strokes.includes(i)) };
    const left = strokes.length ? withActive(doc, all ? { strokes: [], hints: [], areas: [], mask: [] } : kept) : doc;
    editor.commit(pictures.length ? { ...left, pictures: doc.pictures.filter((_, i) => !pictures.includes(i)) } : left);
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

/** Whether something that was hit is chosen. @param {Selection} selection @param {Selection} hit */
const isIn = ({ strokes, pictures }, hit) => strokes.includes(hit.strokes[0]) || pictures.includes(hit.pictures[0]);

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
 * @param {import("./document.js").Doc} before @param {Selection} given @param {import("./moving.js").Move} move
 * @returns {{doc: import("./document.js").Doc, selection: Selection}} selection: of the same in the new document
 */
export function withMoved(before, given, move) {
  const { doc, selection } = withCuts(before, given);
  const { strokes, pictures } = selection;
  const layer = activeLayer(doc);
  const { layer: moved, chosen } = strokes.length ? movedParts(layer, alongWith(layer, strokes, insideOfSelection(selection)), move, doc) : { layer, chosen: [] };
  const drawn = strokes.length ? withActive(doc, moved) : doc;
  const placed = doc.pictures.map((each, i) => (pictures.includes(i) ? movedPicture(each, move) : each));
  return { doc: pictures.length ? { ...drawn, pictures: placed } : drawn, selection: { strokes: chosen, pictures } };
}

/**
 * Draws the box around what is chosen, with a handle at each corner, and what is being drawn around more.
 * @param {CanvasRenderingContext2D} context
 * @param {import("./camera.js").Camera} camera
 * @param {import("./editor.js").Editor} editor
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

/** Draws a line that is seen on light and on dark. @param {CanvasRenderingContext2D} context @param {boolean} dashed */
function outline(context, dashed) {
  context.setLineDash(dashed ? [5, 4] : []);
  for (const [colour, width] of /** @type {[string, number][]} */ ([["rgb(255 255 255 / 90%)", 3], [ACCENT, 1.5]])) {
    [context.strokeStyle, context.lineWidth] = [colour, width];
    context.stroke();
  }
  context.setLineDash([]);
}
