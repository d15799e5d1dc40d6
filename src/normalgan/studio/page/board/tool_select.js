/** Select tool: selects, moves, scales, rotates and deletes strokes, pictures and parts of pictures. */

import { activeLayer, goesAlong, hasAllLines, withActive } from "../drawing/document.js";
import { NOTHING } from "../drawing/editor.js";
import { chosenBy, insideOf } from "../drawing/lasso.js";
import { aboutPoint, extentOf, isHit, unitedBox } from "../drawing/moving.js";
import { boxOfSelection, cutFailed, insideOfSelection, isCut, isIn, isNothing, onceCut, together, withCuts, withMoved, without } from "../drawing/selection.js";
import { makeRoom } from "../drawing/simplify.js";
import { isInFill } from "../drawing/strokes.js";
import { say, text } from "../text/text.js";
import { cornersOf, knobOf } from "./selection_frame.js";

/** @typedef {import("../drawing/editor.js").Selection} Selection @typedef {import("./tools.js").Touch} Touch */
/** @typedef {Selection & {layer?: import("../drawing/document.js").Layer}} Hit layer: if it isn't the active one */

/** Minimum distance from the fixed corner, in drawing pixels, for scaling; closer, each pixel would scale too much. */
const LEAST = 4;
/** Limits of the scale of one drag. */
const SCALES = { least: 0.02, most: 50 };
/** Step of a rotation with Shift, in radians. */
const TURN = Math.PI / 12;

/**
 * @typedef {object} Held the current drag
 * @property {"move" | "scale" | "turn" | "around"} kind
 * @property {Touch} from where the drag started
 * @property {{x: number, y: number}} [fixed] the fixed point of a scaling or rotation
 * @property {Selection} before
 * @property {Touch} [late] the latest position while pictures are still being cut
 * @property {boolean} [frame] whether it started within the selection's frame, off its lines; a click there deselects
 * @property {boolean} [through] whether a click selects the fill there, because no line and no unselected picture is hit
 */

/** Returns the move that a drag makes. @param {Held} held @param {Touch} touch @returns {import("../drawing/moving.js").Move} */
function moveOf({ kind, from, fixed }, touch) {
  if (!fixed) return { scale: 1, x: touch.x - from.x, y: touch.y - from.y };
  if (kind === "turn") {
    const direction = (/** @type {Touch} */ at) => Math.atan2(at.y - fixed.y, at.x - fixed.x);
    const angle = direction(touch) - direction(from);
    // Shift rotates in steps.
    return aboutPoint(fixed, { scale: 1, angle: touch.straight ? Math.round(angle / TURN) * TURN : angle });
  }
  const length = (/** @type {Touch} */ at) => Math.hypot(at.x - fixed.x, at.y - fixed.y);
  const scale = Math.max(SCALES.least, Math.min(SCALES.most, length(touch) / Math.max(length(from), LEAST)));
  return aboutPoint(fixed, { scale });
}

/** Whether a marquee is that of a click by a hand that hardly moved. @param {import("../drawing/moving.js").Box | null} box @param {number} reach */
const isSmall = (box, reach) => !box || Math.hypot(box.right - box.left, box.bottom - box.top) < reach / 4;

/** Select: a click, marquee or lasso selects; a drag moves, scales or rotates the selection. */
export class SelectTool {
  /** @param {import("../drawing/editor.js").Editor} editor @param {import("../elements/status.js").Announce} announce */
  constructor(editor, announce) {
    this.editor = editor;
    this.announce = announce;
    /** @type {Held | null} */
    this.held = null;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    const { selection } = editor;
    this.held = this.#heldByHandle(touch);
    if (this.held) return;
    if (!touch.straight && insideOfSelection(selection)?.(touch)) {
      this.held = { kind: "move", from: touch, before: selection };
      return;
    }
    const hit = this.#hit(touch) ?? (editor.lassoes || touch.straight ? null : this.#hitElsewhere(touch));
    if (!touch.straight && !hit && this.#isFramed(touch)) {
      this.held = { kind: "move", from: touch, before: selection, frame: true, through: true };
      return;
    }
    this.#press(touch, hit);
  }

  /** Starts a drag on an item, or a marquee or lasso beside all items. @param {Touch} touch @param {Hit | null} hit */
  #press(touch, hit) {
    const { editor } = this;
    if (hit?.layer) this.#workOn(hit.layer);
    const { selection } = editor;
    if (!hit || (editor.lassoes && !isIn(selection, hit))) {
      this.held = { kind: "around", from: touch, before: touch.straight ? selection : NOTHING, through: !hit };
      if (!touch.straight) editor.set({ selection: NOTHING });
      return;
    }
    const has = isIn(selection, hit);
    if (touch.straight) editor.set({ selection: has ? without(selection, hit) : together(selection, hit) });
    else if (!has) editor.set({ selection: hit });
    const isLine = hit.strokes.some((i) => editor.layer.strokes[i].kind === "pen");
    this.held = { kind: "move", from: touch, before: editor.selection, through: has && !isLine && !touch.straight };
  }

  /** Whether a touch lies within the frame around the selection. @param {Touch} touch */
  #isFramed({ x, y }) {
    const { doc, selection } = this.editor;
    const box = boxOfSelection(doc, selection);
    return box !== null && x >= box.left && x <= box.right && y >= box.top && y <= box.bottom;
  }

  /** Makes another layer the active one, and announces it. @param {import("../drawing/document.js").Layer} layer */
  #workOn({ id, name }) {
    this.editor.work(id);
    this.announce(say("layerWorked", { name }));
  }

  /** Starts a drag of the knob or a corner handle. @param {Touch} touch @returns {Held | null} null if neither is hit */
  #heldByHandle(touch) {
    const { doc, selection } = this.editor;
    const box = boxOfSelection(doc, selection);
    if (!box) return null;
    const knob = knobOf(box, touch.scale);
    if (Math.hypot(knob.x - touch.x, knob.y - touch.y) <= touch.reach) {
      return { kind: "turn", from: touch, fixed: { x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 }, before: selection };
    }
    const corners = cornersOf(box);
    const corner = corners.findIndex(({ x, y }) => Math.hypot(x - touch.x, y - touch.y) <= touch.reach);
    return corner < 0 ? null : { kind: "scale", from: touch, fixed: corners[(corner + 2) % 4], before: selection };
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
    // A press that hardly moves only selects.
    if (!held.fixed && !editor.draft && Math.hypot(move.x, move.y) < touch.reach / 4) return;
    const { doc, selection } = withMoved(editor.history.state, held.before, move);
    editor.selection = selection;
    editor.preview(doc);
  }

  /** Extends the marquee or lasso. @param {Touch} from where it began @param {Touch} touch */
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
    const clicked = held && !editor.draft && isSmall(marquee, held.from.reach) && (lasso?.length ?? 0) < 6;
    if (clicked && held.through && this.#takeFill(held)) return;
    if (held?.frame && !editor.draft) editor.set({ selection: NOTHING });
    else if (held?.kind === "around" && editor.lassoes) this.#drawnAround(held, lasso ?? []);
    else if (held?.kind === "around" && marquee) this.#chooseIn(marquee, held.before);
    else if (editor.draft) editor.commit(editor.draft);
    else editor.mark();
  }

  cancel() {
    if (this.held && this.held.kind !== "around") this.editor.selection = this.held.before;
    this.held = null;
    this.editor.marquee = this.editor.lasso = null;
    this.editor.drop();
  }

  /**
   * Selects the fill that a click hits, in the active layer or the front one of the others. A drag that starts on it moves nothing
   * that is not selected, because colour and lines should stay together.
   * @param {Held} held of the click
   * @returns {boolean} whether there is one that was not selected
   */
  #takeFill({ from, before }) {
    const { editor } = this;
    for (const layer of [editor.layer, ...this.#others()]) {
      const at = layer.strokes.findLastIndex((stroke) => stroke.kind === "fill" && isInFill(stroke, from));
      if (at < 0) continue;
      const fill = { strokes: [at], pictures: [] };
      const there = layer === editor.layer && isIn(before, fill);
      if (there && !from.straight) return false;
      if (layer !== editor.layer) this.#workOn(layer);
      else if (from.straight) {
        editor.set({ selection: there ? without(before, fill) : together(before, fill) });
        return true;
      }
      editor.set({ selection: fill });
      return true;
    }
    return false;
  }

  /** Selects everything within a box, in addition to the previous selection. @param {import("../drawing/moving.js").Box} box @param {Selection} before */
  #chooseIn(box, before) {
    const { editor } = this;
    const inside = (/** @type {import("../drawing/document.js").Stroke | import("../drawing/document.js").Picture} */ item) => {
      const { left, top, right, bottom } = extentOf(item);
      return left >= box.left && right <= box.right && top >= box.top && bottom <= box.bottom;
    };
    const strokes = editor.layer.strokes.flatMap((stroke, i) => (stroke.kind !== "eraser" && inside(stroke) ? [i] : []));
    const pictures = editor.doc.pictures.flatMap((picture, i) => (inside(picture) ? [i] : []));
    editor.set({ selection: together(before, { strokes, pictures }) });
  }

  /** Selects everything within a lasso; a lasso that is only a click selects what it hits. @param {{from: Touch, before: Selection}} held @param {number[]} drawn */
  #drawnAround({ from, before }, drawn) {
    const { editor } = this;
    const { doc } = editor;
    if (drawn.length < 6) {
      const hit = this.#hit(from);
      if (hit) editor.set({ selection: isIn(before, hit) ? without(before, hit) : together(before, hit) });
      else editor.mark();
      return;
    }
    const lasso = [...(before.lasso ?? []), drawn];
    const inside = insideOf(lasso);
    const { strokes, cuts } = this.#chosenBy(lasso, isNothing(before));
    const pictures = doc.pictures.flatMap((picture, i) => (cornersOf(extentOf(picture)).every(inside) ? [i] : []));
    const found = together({ strokes: before.strokes, pictures: before.pictures }, { strokes, pictures });
    // A picture that is selected as a whole is not cut.
    const selection = { ...found, cuts: cuts.filter(({ index }) => !found.strokes.includes(index)), lasso };
    this.#choose(selection);
    if (isCut(selection)) return;
    Promise.all(cuts.map(({ ready }) => ready)).then(() => {
      if (editor.selection !== selection) return;
      // Cuts without ink only contain shaded paper.
      const inked = selection.cuts.filter(({ parts }) => parts?.piece.width);
      if (inked.length < selection.cuts.length) this.#choose({ ...selection, cuts: inked });
      else editor.mark();
    }).catch(cutFailed(this.announce));
  }

  /**
   * Returns what a lasso selects in the active layer, or else in the front layer where it selects something.
   * @param {number[][]} lasso @param {boolean} any whether another layer may become the active one
   */
  #chosenBy(lasso, any) {
    const { editor } = this;
    const isSome = (/** @type {ReturnType<typeof chosenBy>} */ { strokes, cuts }) => strokes.length + cuts.length > 0;
    const own = chosenBy(editor.layer, lasso);
    if (isSome(own) || !any) return own;
    for (const other of this.#others()) {
      const found = chosenBy(other, lasso);
      if (!isSome(found)) continue;
      this.#workOn(other);
      return found;
    }
    return own;
  }

  /** @param {Selection} selection of a lasso */
  #choose(selection) {
    const none = isNothing(selection);
    this.editor.set({ selection: none ? NOTHING : selection });
    if (none) this.announce(text.lassoEmpty, "warning");
  }

  /** Deletes the selection and announces it. */
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
    // Without lines, points and regions would have no object.
    const all = hasAllLines(layer.strokes, strokes);
    const kept = { strokes: layer.strokes.filter((_, i) => !strokes.includes(i)) };
    const left = strokes.length ? withActive(doc, all ? { strokes: [], hints: [], areas: [], mask: [] } : kept) : doc;
    editor.commit(pictures.length ? { ...left, pictures: doc.pictures.filter((_, i) => !pictures.includes(i)) } : left);
  }

  /** Selects all strokes. */
  all() {
    const strokes = this.editor.layer.strokes.flatMap((stroke, i) => (stroke.kind === "eraser" ? [] : [i]));
    this.editor.set({ tool: "select", selection: { strokes, pictures: [] } });
  }

  /** The other visible layers, from front to back. */
  #others() {
    const { doc: { layers }, layer } = this.editor;
    return layers.filter((each) => each !== layer && each.visible).reverse();
  }

  /** Returns the uppermost line of other layers at a touch; their pictures would be hit everywhere. @param {Touch} touch @returns {Hit | null} */
  #hitElsewhere(touch) {
    for (const layer of this.#others()) {
      const at = layer.strokes.findLastIndex((stroke) => stroke.kind === "pen" && isHit(stroke, touch, touch.reach / 3));
      if (at >= 0) return { strokes: [at], pictures: [], layer };
    }
    return null;
  }

  /** @param {Touch} touch @returns {Hit | null} what lies uppermost */
  #hit(touch) {
    const { layer: { strokes }, doc: { pictures } } = this.editor;
    for (let i = strokes.length - 1; i >= 0; i--) {
      if (!goesAlong(strokes[i]) && isHit(strokes[i], touch, touch.reach / 3)) return { strokes: [i], pictures: [] };
    }
    for (let i = pictures.length - 1; i >= 0; i--) {
      if (pictures[i].visible && isHit(pictures[i], touch, 0)) return { strokes: [], pictures: [i] };
    }
    return null;
  }
}
