/** Hint tool: set points that fix the direction of the surface. */

import { layerAt } from "../drawing/areas.js";
import { MOST_HINTS, activeLayer, changedHint, knobOf, middleOfPixel, mostReach, withHint } from "../drawing/document.js";
import { normalAt } from "../drawing/normal.js";
import { say, text } from "../text/text.js";
import { nearest } from "./marks.js";

/** @typedef {import("./tools.js").Touch} Touch */

/** Points: a click sets or selects a point, and dragging moves it. A click only counts on release, because it may be the first of two fingers. */
export class HintTool {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {() => import("../result/predictor.js").Painted | null} map returns the latest map
   * @param {import("../elements/status.js").Announce} announce
   */
  constructor(editor, map, announce) {
    this.editor = editor;
    this.map = map;
    this.announce = announce;
    /** @type {{index: number, dx: number, dy: number, from: Touch, moved: boolean, ring: boolean} | null} ring: whether the reach is dragged */
    this.held = null;
    /** @type {Touch | null} a press where there is no point */
    this.pressed = null;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    const { doc, layer } = editor;
    const chosen = layer.hints[editor.chosen];
    const ring = chosen !== undefined && nearest([knobOf(chosen, doc, touch.scale)], touch, touch.reach) === 0;
    const index = ring ? editor.chosen : nearest(layer.hints, touch, touch.reach);
    this.pressed = index < 0 ? touch : null;
    if (index < 0) return;
    const { x, y } = layer.hints[index];
    this.held = { index, dx: x - touch.x, dy: y - touch.y, from: touch, moved: false, ring };
  }

  /** Accepts the suggestion at a touch, or sets a point there. @param {Touch} touch */
  #press(touch) {
    const { editor } = this;
    const { doc, layer } = editor;
    const suggestion = nearest(editor.suggestions, touch, touch.reach);
    if (suggestion >= 0) {
      this.accept(suggestion);
      return;
    }
    // A point belongs to the visible layer at that place, even if another layer is active.
    const front = layerAt(doc, touch);
    const other = front !== null && front.id !== layer.id;
    if (other) editor.work(front.id);
    const index = nearest(editor.layer.hints, touch, touch.reach);
    if (index >= 0) editor.set({ chosen: index });
    else this.add(touch, normalAt(this.map(), touch.x / doc.width, touch.y / doc.height));
    if (other) this.announce(say("layerWorked", { name: front.name }));
  }

  /** @param {Touch} touch */
  move(touch) {
    const { held, editor } = this;
    if (!held) return;
    held.moved ||= Math.hypot(touch.x - held.from.x, touch.y - held.from.y) > touch.reach / 4;
    if (!held.moved) return;
    if (editor.chosen !== held.index) editor.set({ chosen: held.index });
    const { state } = editor.history;
    const { x, y } = activeLayer(state).hints[held.index];
    const change = held.ring
      ? { reach: Math.round(Math.min(mostReach(state), Math.hypot(touch.x - x, touch.y - y))) }
      : middleOfPixel({ x: touch.x + held.dx, y: touch.y + held.dy }, editor.doc);
    editor.preview(changedHint(state, held.index, change));
  }

  up() {
    const { held, pressed, editor } = this;
    this.held = this.pressed = null;
    if (held) editor.set({ chosen: held.index });
    if (held?.moved) editor.commit(editor.doc);
    if (pressed) this.#press(pressed);
  }

  cancel() {
    this.held = this.pressed = null;
    this.editor.drop();
  }

  /** Accepts a suggestion as a point. @param {number} index */
  accept(index) {
    const { editor } = this;
    const { normal, ...at } = editor.suggestions[index];
    if (this.add(at, normal)) editor.set({ suggestions: editor.suggestions.filter((_, i) => i !== index) });
  }

  /**
   * Sets a point.
   * @param {{x: number, y: number}} at @param {import("../drawing/document.js").Normal} normal
   * @returns {boolean} whether there was room for it
   */
  add(at, normal) {
    const { editor } = this;
    const { doc: { width, height }, layer: { hints } } = editor;
    if (at.x < 0 || at.y < 0 || at.x >= width || at.y >= height) return false;
    if (hints.length >= MOST_HINTS) {
      this.announce(text.tooMany, "warning");
      return false;
    }
    editor.commit(withHint(editor.doc, { ...middleOfPixel(at, editor.doc), normal }));
    editor.set({ chosen: hints.length });
    return true;
  }
}
