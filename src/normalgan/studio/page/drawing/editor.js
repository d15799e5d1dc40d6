/** The one place that holds the document: edits come in, and all that shows it is told. */

import { activeLayer, hasRoom, newDocument } from "./document.js";
import { History } from "./history.js";
import { LIMITS } from "./limits.js";

/** @typedef {import("./document.js").Doc} Doc */

/** Milliseconds within which steps of one kind are one, unless they say otherwise. */
const TOGETHER = 1000;

/** @typedef {{strokes: number[], pictures: number[], cuts?: import("./lasso.js").Cut[], lasso?: import("./lasso.js").Lasso}} Selection
 *   places in the strokes of the layer that is worked on, and in the document's pictures; cuts: pictures among the strokes of
 *   which only what lies in the lasso is chosen */

/** @type {Selection} nothing is chosen */
export const NOTHING = { strokes: [], pictures: [] };

/**
 * Events: `change` when the document differs, with `detail.live` while a gesture goes on; `drawing` when the ink has
 * got more than the document has yet, with `detail.box`; `replaced` when the present step of history is another value of
 * the same, with `detail.before` and `detail.after`; `marks` when what lies above the sheet differs;
 * `open` when another document came; `full` when a step was refused, as a layer would hold more than can be saved; `state` when tool, choice or settings of the page changed.
 */
export class Editor extends EventTarget {
  constructor() {
    super();
    this.history = new History(newDocument(512, 512));
    /** @type {{kind: string, at: number, state: Doc | null}} the step that was made last */
    this.last = { kind: "", at: 0, state: null };
    /** @type {Doc | null} what a gesture shows before it ends */
    this.draft = null;
    this.tool = "pen";
    /** @type {Record<string, number>} */
    this.widths = { pen: 6, eraser: 24, brush: 48, mask: 48 };
    /** Whether the mask brush adds to the object, or cuts from it. */
    this.adds = true;
    /** Whether a click of the mask tool turns an area over; else it brushes. */
    this.fills = true;
    /** @type {import("./document.js").MaskStroke | null} what the mask brush is drawing */
    this.maskStroke = null;
    /** @type {import("./document.js").Normal | null} what the brush paints; null takes what is under it */
    this.direction = null;
    /** How far the brush fades out and how much it works, as shares; and what it does: turns, smooths or gives a structure. */
    this.brush = { soft: 0.6, strength: 1, works: /** @type {"direction" | "smooth" | "structure"} */ ("direction") };
    /** What the brush gives if that is a structure. @type {import("./document.js").Structure} */
    this.structure = { kind: LIMITS.kinds[0], period: 96 };
    /** @type {import("./document.js").OwnStructure | null} the picture that was chosen last as a structure: no stroke may have it yet */
    this.ownStructure = null;
    /** Whether the pen's lines are cut into the object (-1), stand out of it (1) or only are drawn; and how far, as a share. */
    this.carves = /** @type {-1 | 0 | 1} */ (0);
    this.carveHeight = 0.5;
    this.smoothing = 0.4;
    /** Of the pen's lines. */
    this.colour = "#000000";
    /** Whether pen and eraser draw straight lines. */
    this.straight = false;
    /** Whether what is drawn is mirrored at the middle of the paper. */
    this.symmetry = false;
    /** @type {Selection} what is chosen to be moved */
    this.selection = NOTHING;
    /** Whether a line is drawn around what is chosen, and not a box. */
    this.lassoes = false;
    /** @type {import("./moving.js").Box | null} what is drawn around to be chosen */
    this.marquee = null;
    /** @type {number[] | null} the line that is drawn around it: x, y, x, y, … */
    this.lasso = null;
    /** @type {import("./document.js").Line | null} the straight line that is being drawn */
    this.guide = null;
    /** Index of the chosen hint, -1 is none. */
    this.chosen = -1;
    /** Index of the chosen area, -1 is none; no hint is chosen then. */
    this.area = -1;
    /** @type {[number, number][]} places that are shown, of what is said about the map */
    this.ringed = [];
    /** @type {import("./document.js").Area | null} what is being drawn */
    this.outline = null;
    /** @type {{x: number, y: number, normal: import("./document.js").Normal, gain: number}[]} */
    this.suggestions = [];
    /** Id of the layer that was worked on before the last change. */
    this.worked = this.layer.id;
  }

  /** @returns {Doc} */
  get doc() {
    return this.draft ?? this.history.state;
  }

  /** The layer that is worked on. @returns {import("./document.js").Layer} */
  get layer() {
    return activeLayer(this.doc);
  }

  /** Chooses the layer that is worked on, which is no step in history. @param {number} id */
  work(id) {
    const before = this.history.state;
    if (before.active === id) return;
    this.draft = null;
    this.history.replace({ ...before, active: id });
    this.dispatchEvent(new CustomEvent("replaced", { detail: { before, after: this.history.state } }));
    this.#changed(false);
  }

  /** Shows a document while a gesture goes on. @param {Doc} doc */
  preview(doc) {
    this.draft = doc;
    this.#changed(true);
  }

  /**
   * Tells that the ink has changed, and the document not yet.
   * @param {import("./ink.js").Box} box
   * @param {boolean} [ended] whether the document follows at once
   */
  draw(box, ended = false) {
    this.dispatchEvent(new CustomEvent("drawing", { detail: { box, ended } }));
  }

  /** Tells that what is drawn above the sheet has changed, and nothing else. */
  mark() {
    this.dispatchEvent(new Event("marks"));
  }

  /** Drops what a gesture showed. */
  drop() {
    this.draft = null;
    this.#changed(false);
  }

  /**
   * Makes a document the next step in history.
   * @param {Doc} doc
   * @param {string} [kind] steps of one kind that follow one another at once are one step
   * @param {number} [within] milliseconds that are at once
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
   * @param {{states: Doc[], at: number} | null} [past] the steps that led to it, and may lead on; it is the one at `at`
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

  /** @param {"undo" | "redo"} way @returns {boolean} whether there was something to do */
  step(way) {
    if (way === "undo" ? !this.history.canUndo : !this.history.canRedo) return false;
    this.#goBy(() => this.history[way]());
    return true;
  }

  /** Goes to a step in history. @param {number} at @returns {boolean} whether it is another one */
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
    // Places in lists of another length are of other strokes.
    if (this.layer.strokes.length !== layer.strokes.length) this.selection = NOTHING;
    this.#changed(false);
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
    const { layer } = this;
    // Indices are of that layer's lists.
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
