/** Result: the viewer with its tabs, fed by the painter. */

import { $ } from "./dom.js";
import { say, text } from "./text.js";
import { createViewer } from "./viewer.js";

export const VIEWS = ["map", "lit", "matcap", "flat", "relief"];
const KEY = "normalgan-view";

export class Result {
  /**
   * @param {import("./painter.js").Painter} painter
   * @param {import("./status.js").Status} status
   */
  constructor(painter, status) {
    this.painter = painter;
    this.status = status;
    this.viewer = createViewer($("viewer"), { text: text.viewerTexts, onError: (words) => this.#say(words) });
    painter.addEventListener("painting", () => $("result").setAttribute("aria-busy", "true"));
    painter.addEventListener("painted", (event) => this.#painted(event.detail.ms));
    painter.addEventListener("raising", () => status.note(text.raising));
    painter.addEventListener("height", () => this.#raised());
    painter.addEventListener("empty", () => this.#emptied());
    painter.addEventListener("failed", (event) => {
      $("result").setAttribute("aria-busy", "false");
      status.fail(event.detail);
    });
    for (const tab of this.#tabs()) {
      tab.addEventListener("click", () => this.show(tab.dataset.view));
      tab.addEventListener("keydown", (event) => this.#walk(event, tab));
    }
    const before = localStorage.getItem(KEY);
    this.show(VIEWS.includes(before) ? before : "map");
  }

  /** @param {string} view */
  show(view) {
    for (const tab of this.#tabs()) {
      const chosen = tab.dataset.view === view;
      tab.setAttribute("aria-selected", String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
      if (chosen) $("result").setAttribute("aria-labelledby", tab.id);
    }
    localStorage.setItem(KEY, view);
    this.viewer.setView(view);
    this.painter.wantHeight(view === "relief" && this.viewer.available);
  }

  /** @returns {HTMLElement[]} */
  #tabs() {
    return [...$("views").children];
  }

  #walk(event, tab) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const tabs = this.#tabs();
    const next = tabs[(tabs.indexOf(tab) + step + tabs.length) % tabs.length];
    next.focus();
    this.show(next.dataset.view);
  }

  #painted(ms) {
    const { rgba, width, height, warning } = this.painter.painted;
    this.viewer.setMap(rgba, width, height);
    $("empty-result").hidden = true;
    $("result").setAttribute("aria-busy", "false");
    // For tests and benchmarks: which drawing is on show, counted.
    $("result").dataset.painted = String(Number($("result").dataset.painted ?? 0) + 1);
    this.#warn(warning);
    this.status.note(say("painted", { ms }));
  }

  #raised() {
    const { heights, width, height } = this.painter.heights;
    this.viewer.setHeight(heights, width, height);
    this.status.note("");
  }

  #emptied() {
    this.viewer.setMap(null);
    this.viewer.setHeight(null);
    $("empty-result").hidden = false;
    $("result").setAttribute("aria-busy", "false");
    this.#warn("");
    this.status.note("");
  }

  #warn(words) {
    $("warning").textContent = words && `${words[0].toUpperCase()}${words.slice(1)}.`.replace("..", ".");
    $("warning").hidden = !words;
  }

  /** @param {string | null} words what the viewer cannot do */
  #say(words) {
    $("viewer-words").textContent = words ?? "";
    $("viewer-words").hidden = !words;
  }
}
