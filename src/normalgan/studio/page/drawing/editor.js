/** Editor: holds the document, applies edits and notifies all views. */

import { activeLayer, hasRoom, newDocument } from "./document.js";
import { History } from "./history.js";
import { LIMITS } from "./limits.js";

/** @typedef {import("./document.js").Doc} Doc */

/** Default time in milliseconds within which steps of the same kind are merged. */
const TOGETHER = 1000;

/** @typedef {{strokes: number[], pictures: number[], cuts?: import("./lasso.js").Cut[], lasso?: import("./lasso.js").Lasso}} Selection
 *   indices in the active layer's strokes, and in the document's pictures; cuts: pictures among the strokes of which only
 *   the part inside the lasso is selected */

/** @type {Selection} the empty selection */
export const NOTHING = { strokes: [], pictures: [] };

/**
 * Events: `change` when the document has changed, with `detail.live` during a gesture; `drawing` when the ink is ahead
 * of the document, with `detail.box`; `replaced` when the current step of history has a new value, with
 * `detail.before` and `detail.after`; `marks` when something above the sheet has changed; `open` after switching to another
 * document; `full` when a step was refused because a layer would exceed what can be saved; `state` when the tool, the
 * selection or the page's settings have changed.
 */
export class Editor extends EventTarget {
  constructor() {
    super();
    this.history = new History(newDocument(512, 512));
    /** @type {{kind: string, at: number, state: Doc | null}} the latest step */
    this.last = { kind: "", at: 0, state: null };
    /** @type {Doc | null} the document shown during a gesture */
    this.draft = null;
    this.tool = "pen";
    /** @type {Record<string, number>} */
    this.widths = { pen: 6, eraser: 24, brush: 48, mask: 48 };
    /** Whether the mask brush adds to the object instead of cutting from it. */
    this.adds = true;
    /** Whether the mask tool flips areas by clicks instead of brushing. */
    this.fills = true;
    /** @type {import("./document.js").MaskStroke | null} the current stroke of the mask brush */
    this.maskStroke = null;
    /** @type {import("./document.js").Normal | null} direction of the brush; null uses the direction under it */
    this.direction = null;
    /** Softness and strength of the brush, as fractions, and its effect: direction, smoothing or structure. */
    this.brush = { soft: 0.6, strength: 1, works: /** @type {"direction" | "smooth" | "structure"} */ ("direction") };
    /** The brush's structure. @type {import("./document.js").Structure} */
    this.structure = { kind: LIMITS.kinds[0], period: 96 };
    /** @type {import("./document.js").OwnStructure | null} the picture last chosen as a structure, which may not be used by any stroke yet */
    this.ownStructure = null;
    /** Whether the pen's lines are engraved (-1), embossed (1) or only drawn (0), and how deep, as a fraction. */
    this.carves = /** @type {-1 | 0 | 1} */ (0);
    this.carveHeight = 0.5;
    this.smoothing = 0.4;
    /** Colour of the pen's lines. */
    this.colour = "#000000";
    /** Colour of filled areas. */
    this.fillColour = "#f0b880";
    /** Whether pen and eraser draw straight lines. */
    this.straight = false;
    /** Whether strokes are mirrored at the centre of the paper. */
    this.symmetry = false;
    /** @type {Selection} the selection */
    this.selection = NOTHING;
    /** Whether the select tool uses a lasso instead of a box. */
    this.lassoes = false;
    /** @type {import("./moving.js").Box | null} the current selection box */
    this.marquee = null;
    /** @type {number[] | null} the current lasso: x, y, x, y, … */
    this.lasso = null;
    /** @type {import("./document.js").Line | null} the straight line or shape being drawn */
    this.guide = null;
    /** Index of the selected hint; -1 for none. */
    this.chosen = -1;
    /** Index of the selected area; -1 for none. A hint and an area are never both selected. */
    this.area = -1;
    /** @type {[number, number][]} places of findings that are shown */
    this.ringed = [];
    /** @type {import("./document.js").Area | null} the area being drawn */
    this.outline = null;
    /** @type {{x: number, y: number, normal: import("./document.js").Normal, gain: number}[]} */
    this.suggestions = [];
    /** Id of the active layer before the last change. */
    this.worked = this.layer.id;
  }

  /** @returns {Doc} */
  get doc() {
    return this.draft ?? this.history.state;
  }

  /** The active layer. @returns {import("./document.js").Layer} */
  get layer() {
    return activeLayer(this.doc);
  }

  /** Changes the active layer, which is not a step in history. @param {number} id */
  work(id) {
    const before = this.history.state;
    if (before.active === id) return;
    this.draft = null;
    this.history.replace({ ...before, active: id });
    this.dispatchEvent(new CustomEvent("replaced", { detail: { before, after: this.history.state } }));
    this.#changed(false);
  }

  /** Shows a document during a gesture. @param {Doc} doc */
  preview(doc) {
    this.draft = doc;
    this.#changed(true);
  }

  /**
   * Notifies that the ink has changed before the document.
   * @param {import("./ink.js").Box} box
   * @param {boolean} [ended] whether the document follows at once
   */
  draw(box, ended = false) {
    this.dispatchEvent(new CustomEvent("drawing", { detail: { box, ended } }));
  }

  /** Notifies that only the marks above the sheet have changed. */
  mark() {
    this.dispatchEvent(new Event("marks"));
  }

  /** Discards the document shown during a gesture. */
  drop() {
    this.draft = null;
    this.#changed(false);
  }

  /**
   * Makes a document the next step in history.
   * @param {Doc} doc
   * @param {string} [kind] consecutive steps of the same kind are merged
   * @param {number} [within] maximum time between merged steps in milliseconds
   */
  commit(doc, kind = "", within = TOGETHER) {
    this.draft = null;
    if (!doc.layers.every(hasRoom)) {
      this.#changed(false);
      this.dispatchEvent(new Event("full"));
      return;
    }
    const { history, last } = this;
    const now = performance.now();
    const goesOn = kind !== "" && last.kind === kind && last.state === history.state && now - last.at < within && !history.canRedo;
    if (goesOn) history.replace(doc);
    else history.push(doc);
    this.last = { kind, at: now, state: doc };
    this.#changed(false);
  }

  /**
   * Starts over with another document.
   * @param {Doc} doc
   * @param {{states: Doc[], at: number} | null} [past] its history; `at` is the index of the document
   */
  open(doc, past = null) {
    this.draft = null;
    this.history = new History(doc);
    if (past) {
      this.history.states = past.states.map((state, i) => (i === past.at ? doc : state));
      this.history.at = past.at;
    }
    this.set({ chosen: -1, area: -1, suggestions: [], selection: NOTHING });
    this.dispatchEvent(new CustomEvent("open"));
    this.#changed(false);
  }

  /** @param {"undo" | "redo"} way @returns {boolean} whether there was a step */
  step(way) {
    if (way === "undo" ? !this.history.canUndo : !this.history.canRedo) return false;
    this.#goBy(() => this.history[way]());
    return true;
  }

  /** Goes to a step in history. @param {number} at @returns {boolean} whether it differs from the current one */
  goTo(at) {
    if (at === this.history.at || at < 0 || at >= this.history.states.length) return false;
    this.#goBy(() => { this.history.at = at; });
    return true;
  }

  /** Goes to another step. @param {() => void} go */
  #goBy(go) {
    this.draft = null;
    const { layer } = this;
    go();
    // If the number of strokes has changed, the selected indices are invalid.
    if (this.layer.strokes.length !== layer.strokes.length) this.selection = NOTHING;
    this.#changed(false);
  }

  /** Changes the tool, the selection or settings of the page. @param {Partial<Editor>} values */
  set(values) {
    Object.assign(this, values);
    if ((values.chosen ?? -1) >= 0) this.area = -1;
    if ((values.area ?? -1) >= 0) this.chosen = -1;
    this.dispatchEvent(new CustomEvent("state"));
  }

  /** @param {boolean} live */
  #changed(live) {
    const { layer } = this;
    // The selected indices belong to the previous layer.
    if (layer.id !== this.worked) this.set({ chosen: -1, area: -1, suggestions: [], selection: NOTHING });
    this.worked = layer.id;
    if (this.chosen >= layer.hints.length) this.set({ chosen: -1 });
    if (this.area >= layer.areas.length) this.set({ area: -1 });
    const { strokes, pictures, cuts = [] } = this.selection;
    const gone = cuts.some(({ index, stroke }) => layer.strokes[index] !== stroke) || strokes.some((i) => i >= layer.strokes.length) || pictures.some((i) => i >= this.doc.pictures.length);
    if (gone) this.set({ selection: NOTHING });
    this.dispatchEvent(new CustomEvent("change", { detail: { live } }));
  }
}
