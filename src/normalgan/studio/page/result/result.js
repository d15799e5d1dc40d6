/** Result: the viewer with its tabs, which shows the predictor's maps. */

import { $ } from "../elements/dom.js";
import { recalled, remember } from "../elements/settings.js";
import { reasonOf } from "../elements/status.js";
import { Lacking } from "../server/api.js";
import { say, sentence, text } from "../text/text.js";
import { followFindings } from "./findings.js";
import { Viewer } from "./viewer.js";

/** @typedef {"map" | "lit" | "matcap" | "flat" | "relief"} View */
/** @type {View[]} */
export const VIEWS = ["map", "lit", "matcap", "flat", "relief"];
/** @param {HTMLElement} tab */
const viewOf = (tab) => /** @type {View} */ (tab.dataset.view);
const KEY = "normalgan-view";

/** Events: `view` when the view changes. */
export class Result extends EventTarget {
  /**
   * @param {import("./predictor.js").Predictor} predictor
   * @param {import("../elements/status.js").Status} status
   */
  constructor(predictor, status) {
    super();
    /** The current view. @type {View} */
    this.view = "map";
    this.predictor = predictor;
    /** Called to give each of separate figures its own layer. @type {(outlines: import("../drawing/lasso.js").Lasso[]) => void} */
    this.onFigures = () => {};
    this.tell = followFindings($("warning"), predictor.editor, (outlines) => this.onFigures(outlines));
    this.status = status;
    /** Whether the pane says why there is no relief. */
    this.unraised = false;
    /** Options of the flat views. */
    this.look = { tiled: false, pixelated: false };
    /** Called when keys have moved the light. @type {(light: number[]) => void} */
    this.onLight = () => {};
    /** Called when repetition or pixel display is switched on or off. @type {(way: "tiled" | "pixelated") => void} */
    this.onLook = () => {};
    this.viewer = new Viewer($("viewer"), {
      text: text.viewerTexts, onError: (words) => this.#say(words), onMove: ({ light }) => this.onLight(light),
    });
    predictor.addEventListener("painting", () => $("result").setAttribute("aria-busy", "true"));
    predictor.addEventListener("painted", (event) => this.#painted(/** @type {CustomEvent} */ (event).detail));
    predictor.addEventListener("raising", () => status.note(text.raising));
    predictor.addEventListener("height", () => this.#raised());
    predictor.addEventListener("unraised", (event) => {
      this.status.note("");
      this.unraised = true;
      this.#say(reasonOf(/** @type {CustomEvent} */ (event).detail));
    });
    predictor.addEventListener("empty", () => this.#emptied());
    predictor.addEventListener("failed", (event) => this.#failed(/** @type {CustomEvent} */ (event).detail));
    for (const tab of this.#tabs()) {
      tab.addEventListener("click", () => this.show(viewOf(tab)));
      tab.addEventListener("keydown", (event) => this.#walk(event, tab));
    }
    for (const way of /** @type {const} */ (["tiled", "pixelated"])) $(way).addEventListener("click", () => this.turnOver(way));
    const before = recalled(KEY);
    this.show(VIEWS.includes(before) ? before : "map");
  }

  /** Disables the relief, which cannot be raised here. */
  withoutRelief() {
    const tab = this.#tabs().find((each) => viewOf(each) === "relief");
    if (!tab) return;
    tab.toggleAttribute("disabled", true);
    tab.title = sentence(text.webPython);
    if (this.view === "relief") this.show("map");
  }

  /** @param {View} view */
  show(view) {
    if (this.#tabs().some((tab) => viewOf(tab) === view && tab.hasAttribute("disabled"))) return;
    for (const tab of this.#tabs()) {
      const chosen = tab.dataset.view === view;
      tab.setAttribute("aria-selected", String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
      if (chosen) $("result").setAttribute("aria-labelledby", tab.id);
    }
    remember(KEY, view);
    this.view = view;
    $("result").dataset.view = view;
    this.#forget();
    this.viewer.setView(view);
    this.dispatchEvent(new Event("view"));
    this.predictor.wantHeight(view === "relief" && this.viewer.available);
  }

  /** Toggles repetition or pixel display. @param {"tiled" | "pixelated"} way */
  turnOver(way) {
    this.look = { ...this.look, [way]: !this.look[way] };
    $(way).setAttribute("aria-pressed", String(this.look[way]));
    this.viewer.setLook(this.look);
    this.onLook(way);
  }

  /** @returns {HTMLElement[]} */
  #tabs() {
    return /** @type {HTMLElement[]} */ ([...$("views").children]);
  }

  /** @param {KeyboardEvent} event @param {HTMLElement} tab */
  #walk(event, tab) {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (!step) return;
    event.preventDefault();
    const tabs = this.#tabs().filter((each) => !each.hasAttribute("disabled"));
    const next = tabs[(tabs.indexOf(tab) + step + tabs.length) % tabs.length];
    next.focus();
    this.show(viewOf(next));
  }

  /** @param {{ms: number, whole: boolean}} detail */
  #painted({ ms, whole }) {
    if (!this.predictor.painted) return;
    const { rgba, width, height, findings } = this.predictor.painted;
    this.viewer.setMap(rgba, width, height);
    $("empty-result").hidden = true;
    this.status.predicted();
    $("result").setAttribute("aria-busy", String(!whole));
    // A counter of shown drawings, for tests and benchmarks.
    $("result").dataset.painted = String(Number($("result").dataset.painted ?? 0) + 1);
    // Unfinished strokes have no findings yet.
    if (!whole) return;
    this.tell(findings);
    this.status.note(say("painted", { ms }));
  }

  /**
   * Shows what the drawing lacks in place of the map until there is one; other errors go to the status.
   * @param {{error: unknown, painting: boolean}} detail painting: whether the map failed, not its heights or uncertainty
   */
  #failed({ error, painting }) {
    $("result").setAttribute("aria-busy", "false");
    this.status.note(""); // the requested heights will not arrive
    if (error instanceof Lacking) this.tell(error.findings);
    else this.status.fail(error, painting ? "unpredicted" : "error");
  }

  #raised() {
    if (!this.predictor.heights) return;
    this.#forget();
    const { heights, width, height } = this.predictor.heights;
    this.viewer.setHeight(heights, width, height);
    this.status.note("");
  }

  #emptied() {
    this.viewer.setMap(null);
    this.viewer.setHeight(null);
    $("empty-result").hidden = false;
    this.status.predicted();
    $("result").setAttribute("aria-busy", "false");
    this.tell([]);
    this.status.note("");
  }

  /** Removes the message that there is no relief. */
  #forget() {
    if (this.unraised) this.#say(null);
    this.unraised = false;
  }

  /** @param {string | null} words what failed */
  #say(words) {
    $("viewer-words").textContent = words ?? "";
    $("viewer-words").hidden = !words;
  }
}
