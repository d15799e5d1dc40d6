/** Brushes: settings of the direction brush, for the selected stroke or else for the next one. */

import { changedArea, withStructures } from "../drawing/document.js";
import { LIMITS } from "../drawing/limits.js";
import { $, field } from "../elements/dom.js";
import { say } from "../text/text.js";
import { StructureChoice } from "./structure_choice.js";

/** Step of softness or strength per key press. */
const STEP = 0.1;
/** @typedef {"soft" | "strength"} Part @type {Part[]} */
const PARTS = ["soft", "strength"];
/** Effects of the brush other than a direction. */
const WORKS = /** @type {const} */ (["smooth", "structure"]);

/** Returns the selected brush stroke, if there is one. */
export class ChosenStroke {
  /** @param {import("../drawing/editor.js").Editor} editor @param {import("../elements/status.js").Announce} announce */
  constructor(editor, announce) {
    this.editor = editor;
    this.announce = announce;
  }

  /** @returns {import("../drawing/document.js").Area | undefined} */
  get area() {
    const area = this.editor.layer.areas[this.editor.area];
    return area?.size ? area : undefined;
  }

  /**
   * Changes the selected stroke, if there is one.
   * @param {Partial<import("../drawing/document.js").Area>} change @param {boolean} ended @param {string} part the setting whose consecutive changes are one step
   * @param {import("../drawing/document.js").OwnStructure[]} [own] pictures that the change needs
   */
  change(change, ended, part, own = []) {
    const { editor } = this;
    if (!this.area) return;
    const whole = withStructures(editor.history.state, own);
    if (!whole) {
      this.announce(say("tooManyStructures", { most: LIMITS.structures }), "warning");
      return;
    }
    const doc = changedArea(whole, editor.area, change);
    if (ended) editor.commit(doc, `${part} ${editor.area}`);
    else editor.preview(doc);
  }
}

/** The brush's buttons and sliders. */
export class Brushes {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {(file: File) => Promise<string | null>} read returns a picture as a data URL, or null after announcing an error
   * @param {import("../elements/status.js").Announce} announce
   */
  constructor(editor, read, announce) {
    this.editor = editor;
    this.stroke = new ChosenStroke(editor, announce);
    this.structures = new StructureChoice(editor, this.stroke, read, announce);
    for (const part of PARTS) {
      const slider = field(`brush-${part}`);
      slider.addEventListener("input", () => this.#take(part, slider.valueAsNumber / 100, false));
      slider.addEventListener("change", () => this.#take(part, slider.valueAsNumber / 100, true));
    }
    for (const works of WORKS) $(`brush-${works}`).addEventListener("click", () => this.turnTo(works));
    for (const event of ["change", "state"]) editor.addEventListener(event, () => this.#show());
    this.#show();
  }

  /** Switches the brush to smoothing or a structure, or back to directions. @param {typeof WORKS[number]} works */
  turnTo(works) {
    const { editor } = this;
    const goes = editor.tool === "brush" && editor.brush.works === works;
    editor.set({ tool: "brush", brush: { ...editor.brush, works: goes ? "direction" : works }, area: -1 });
  }

  /** Changes softness or strength. @param {Part} part @param {number} steps */
  change(part, steps) {
    if (this.editor.tool !== "brush") return;
    this.#take(part, Math.round(100 * Math.max(0, Math.min(1, this.#now(part) + steps * STEP))) / 100, true);
  }

  /** Selects the next structure. */
  next() {
    if (this.editor.tool === "brush" && this.editor.brush.works === "structure") this.structures.next();
  }

  /** @param {Part} part */
  #now(part) {
    return this.stroke.area?.[part] ?? this.editor.brush[part];
  }

  /** @param {Part} part @param {number} value @param {boolean} ended */
  #take(part, value, ended) {
    const { editor } = this;
    editor.set({ brush: { ...editor.brush, [part]: value } });
    this.stroke.change({ [part]: value }, ended, part);
  }

  #show() {
    const { editor } = this;
    const now = this.stroke.area?.structure ? "structure" : editor.brush.works;
    $("brush-options").hidden = editor.tool !== "brush";
    for (const works of WORKS) $(`brush-${works}`).setAttribute("aria-pressed", String(works === now));
    for (const part of PARTS) field(`brush-${part}`).value = String(Math.round(100 * this.#now(part)));
    this.structures.show(now === "structure");
  }
}
