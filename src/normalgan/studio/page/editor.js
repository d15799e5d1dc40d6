/** The one place that holds the document: edits come in, and all that shows it is told. */

import { newDocument } from "./document.js";
import { History } from "./history.js";

/** @typedef {import("./document.js").Doc} Doc */

/**
 * Events: `change` when the document differs, with `detail.live` while a gesture goes on; `drawing` when the ink has
 * got more than the document has yet;
 * `open` when another document came; `state` when tool, choice or settings of the page changed.
 */
export class Editor extends EventTarget {
  constructor() {
    super();
    this.history = new History(newDocument(512, 512));
    /** @type {Doc | null} what a gesture shows before it ends */
    this.draft = null;
    this.tool = "pen";
    this.widths = { pen: 6, eraser: 24, brush: 48 };
    /** @type {import("./document.js").Normal | null} what the brush paints; null takes what is under it */
    this.direction = null;
    this.smoothing = 0.4;
    /** Index of the chosen hint, -1 is none. */
    this.chosen = -1;
    /** Index of the chosen area, -1 is none; no hint is chosen then. */
    this.area = -1;
    /** @type {import("./document.js").Area | null} what is being drawn */
    this.outline = null;
    /** @type {{x: number, y: number, normal: import("./document.js").Normal, gain: number}[]} */
    this.suggestions = [];
  }

  /** @returns {Doc} */
  get doc() {
    return this.draft ?? this.history.state;
  }

  /** Shows a document while a gesture goes on. @param {Doc} doc */
  preview(doc) {
    this.draft = doc;
    this.#changed(true);
  }

  /** Tells that a stroke goes on: it is in the ink, and not yet in the document. */
  draw() {
    this.dispatchEvent(new Event("drawing"));
  }

  /** Drops what a gesture showed. */
  drop() {
    this.draft = null;
    this.#changed(false);
  }

  /** Makes a document the next step in history. @param {Doc} doc */
  commit(doc) {
    this.draft = null;
    this.history.push(doc);
    this.#changed(false);
  }

  /** Starts over with another document. @param {Doc} doc */
  open(doc) {
    this.draft = null;
    this.history = new History(doc);
    this.set({ chosen: -1, area: -1, suggestions: [] });
    this.dispatchEvent(new CustomEvent("open"));
    this.#changed(false);
  }

  /** @param {"undo" | "redo"} way @returns {boolean} whether there was something to do */
  step(way) {
    if (way === "undo" ? !this.history.canUndo : !this.history.canRedo) return false;
    this.draft = null;
    this.history[way]();
    this.#changed(false);
    return true;
  }

  /** Changes tool, choice or settings of the page. @param {Partial<Editor>} values */
  set(values) {
    Object.assign(this, values);
    if ((values.chosen ?? -1) >= 0) this.area = -1;
    if ((values.area ?? -1) >= 0) this.chosen = -1;
    this.dispatchEvent(new CustomEvent("state"));
  }

  /** @param {boolean} live */
  #changed(live) {
    if (this.chosen >= this.doc.hints.length) this.set({ chosen: -1 });
    if (this.area >= this.doc.areas.length) this.set({ area: -1 });
    this.dispatchEvent(new CustomEvent("change", { detail: { live } }));
  }
}
