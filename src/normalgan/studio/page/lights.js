/** Lights: their colours, which of the two is moved, and a button that lets the light go around. */

import { $, field, label } from "./dom.js";
import { recalled, remember } from "./settings.js";
import { text } from "./text.js";
import { DEFAULT_LIGHT, lightOver } from "./viewer_input.js";

const KEY = "normalgan-lights";
/** Seconds that a turn of the light takes. */
const TURN = 6;
/** How far out it goes around. */
const OUT = 0.75;
/** Where the second light is until it is moved: low on the other side. */
const SECOND = lightOver(0.8, -0.35);
/** Nothing that moves by itself where that was asked for. */
const CALM = matchMedia("(prefers-reduced-motion: reduce)");

/** Returns linear red, green and blue. @param {string} colour "#rrggbb" @returns {number[]} */
function linear(colour) {
  return [1, 3, 5].map((at) => {
    const level = parseInt(colour.slice(at, at + 2), 16) / 255;
    return level <= 0.04045 ? level / 12.92 : ((level + 0.055) / 1.055) ** 2.4;
  });
}

const isColour = (/** @type {unknown} */ value) => typeof value === "string" && /^#[0-9a-f]{6}$/.test(value);

export class Lights {
  /** @param {import("./viewer.js").Viewer} viewer @param {() => string} view which is on show @param {(view: import("./viewer.js").View) => void} show */
  constructor(viewer, view, show) {
    this.viewer = viewer;
    this.view = view;
    this.show = show;
    this.colours = ["#ffffff", "#5080ff"];
    /** Whether there is a second light. */
    this.both = false;
    /** Which of them is moved. */
    this.moved = 0;
    this.directions = [DEFAULT_LIGHT, SECOND];
    this.frame = 0;
    this.#recall();
    $("light-play").addEventListener("click", () => this.play());
    for (const i of [0, 1]) {
      $(`light-${i + 1}`).addEventListener("input", (event) => {
        this.colours[i] = /** @type {HTMLInputElement} */ (event.target).value;
        if (i) this.both = true;
        this.moved = i;
        this.#changed();
      });
    }
    $("light-both").addEventListener("change", (event) => {
      this.both = /** @type {HTMLInputElement} */ (event.target).checked;
      this.moved = this.both ? 1 : 0;
      this.#changed();
    });
    $("light-moved").addEventListener("click", () => {
      this.moved = 1 - this.moved;
      this.#changed();
    });
    this.#changed();
  }

  /** Moves a light over a point of the result. @param {number} x @param {number} y */
  move(x, y) {
    this.stop();
    this.directions[this.moved] = this.viewer.lightAt(x, y);
    this.#shine();
  }

  /** Takes the direction that keys have given to the first light. @param {number[]} direction */
  took(direction) {
    this.stop();
    this.directions[0] = direction;
  }

  /** Lets the light go around, or stops it. */
  play() {
    if (this.frame) {
      this.stop();
      return;
    }
    if (this.view() === "map") this.show("lit"); // a map has no light
    const start = performance.now();
    const [x, y] = this.viewer.light;
    const from = Math.atan2(y, x);
    const turn = (/** @type {number} */ now) => {
      const angle = from + ((now - start) / 1000 / TURN) * 2 * Math.PI;
      this.directions[0] = lightOver(OUT * Math.cos(angle), OUT * Math.sin(angle));
      this.#shine();
      this.frame = requestAnimationFrame(turn);
    };
    this.frame = requestAnimationFrame(turn);
    if (CALM.matches) setTimeout(() => this.stop(), 1000 * TURN);
    this.#label();
  }

  stop() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.#label();
  }

  #label() {
    $("light-play").setAttribute("aria-pressed", String(this.frame !== 0));
    label($("light-play"), this.frame ? text.lightStop : text.lightPlay);
  }

  #shine() {
    this.viewer.setLights(
      { direction: this.directions[0], colour: linear(this.colours[0]) },
      this.both ? { direction: this.directions[1], colour: linear(this.colours[1]) } : null,
    );
  }

  #changed() {
    for (const i of [0, 1]) field(`light-${i + 1}`).value = this.colours[i];
    field("light-both").checked = this.both;
    $("light-2").hidden = !this.both;
    $("light-moved").hidden = !this.both;
    $("light-help").hidden = this.both; // there is no room for it
    $("light-moved").textContent = this.moved ? text.lightMovesSecond : text.lightMovesFirst;
    remember(KEY, { colours: this.colours, both: this.both });
    this.#shine();
  }

  #recall() {
    const before = recalled(KEY) ?? {};
    if (Array.isArray(before.colours) && before.colours.length === 2 && before.colours.every(isColour)) this.colours = before.colours;
    if (typeof before.both === "boolean") this.both = before.both;
  }
}
