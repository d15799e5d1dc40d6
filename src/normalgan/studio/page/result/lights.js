/** Lights: the settings of the lights, and the button that rotates the light. */

import { $, field, label } from "../elements/dom.js";
import { recalled, remember } from "../elements/settings.js";
import { text } from "../text/text.js";
import { DEFAULT_LIGHT, lightOver } from "./viewer_input.js";

const KEY = "normalgan-lights";
/** Seconds per rotation of the light. */
const TURN = 6;
/** Radius of the rotation. */
const OUT = 0.75;
/** Initial direction of the second light: low on the opposite side. */
const SECOND = lightOver(0.8, -0.35);
/** Whether the user prefers reduced motion. */
const CALM = matchMedia("(prefers-reduced-motion: reduce)");

/** Returns linear red, green and blue. @param {string} colour "#rrggbb" @returns {number[]} */
function linear(colour) {
  return [1, 3, 5].map((at) => {
    const level = parseInt(colour.slice(at, at + 2), 16) / 255;
    return level <= 0.04045 ? level / 12.92 : ((level + 0.055) / 1.055) ** 2.4;
  });
}

/** Returns a direction at a height above the paper, in degrees. @param {number[]} direction @param {number} degrees */
function raised([x, y], degrees) {
  const angle = (degrees * Math.PI) / 180;
  const along = Math.hypot(x, y) > 1e-3 ? Math.atan2(y, x) : (3 * Math.PI) / 4;
  return [Math.cos(angle) * Math.cos(along), Math.cos(angle) * Math.sin(along), Math.sin(angle)];
}

/** @param {unknown} value @param {number} most */
const isShare = (value, most) => typeof value === "number" && value >= 0 && value <= most;
const isColour = (/** @type {unknown} */ value) => typeof value === "string" && /^#[0-9a-f]{6}$/.test(value);

/** One or two lights and their controls. */
export class Lights {
  /** @param {import("./viewer.js").Viewer} viewer @param {() => string} view which is on show @param {(view: import("./viewer.js").View) => void} show */
  constructor(viewer, view, show) {
    this.viewer = viewer;
    this.view = view;
    this.show = show;
    this.colours = ["#ffffff", "#5080ff"];
    /** Intensity; 1 is the default. */
    this.intensities = [1, 1];
    /** Falloff, 0 to 1. */
    this.falloff = 0;
    /** Whether there is a second light. */
    this.both = false;
    /** The light that is moved. */
    this.moved = 0;
    this.directions = [DEFAULT_LIGHT, SECOND];
    this.frame = 0;
    this.#recall();
    this.#listen();
    this.#changed();
  }

  #listen() {
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
    field("light-height").addEventListener("input", () => {
      this.stop();
      this.directions[this.moved] = raised(this.directions[this.moved], field("light-height").valueAsNumber);
      this.#shine();
    });
    field("light-intensity").addEventListener("input", () => {
      this.intensities[this.moved] = field("light-intensity").valueAsNumber / 100;
      this.#changed();
    });
    field("light-falloff").addEventListener("input", () => {
      this.falloff = field("light-falloff").valueAsNumber / 100;
      this.#changed();
    });
    for (const i of [0, 1]) {
      $(`light-moves-${i + 1}`).addEventListener("click", () => {
        this.moved = i;
        this.#changed();
      });
    }
  }

  /** Moves a light over a point of the result. @param {number} x @param {number} y */
  move(x, y) {
    this.stop();
    this.directions[this.moved] = this.viewer.lightAt(x, y);
    this.#shine();
  }

  /** Sets the direction of the first light, changed by keys. @param {number[]} direction */
  took(direction) {
    this.stop();
    this.directions[0] = direction;
    this.#height();
  }

  /** Starts or stops the rotation of the light. */
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
    const lamp = (/** @type {number} */ i) => ({
      direction: this.directions[i], colour: linear(this.colours[i]).map((value) => value * this.intensities[i]),
    });
    this.viewer.setLights(lamp(0), this.both ? lamp(1) : null, this.falloff);
    this.#height();
  }

  /** Shows the height of the light that is moved. */
  #height() {
    const [x, y, z] = this.directions[this.moved];
    field("light-height").value = String(Math.round((Math.atan2(z, Math.hypot(x, y)) * 180) / Math.PI));
  }

  #changed() {
    for (const i of [0, 1]) field(`light-${i + 1}`).value = this.colours[i];
    field("light-both").checked = this.both;
    $("light-2").hidden = $("light-moved").hidden = !this.both;
    $("light-help").hidden = this.both;
    field("light-intensity").value = String(Math.round(100 * this.intensities[this.moved]));
    field("light-falloff").value = String(Math.round(100 * this.falloff));
    for (const i of [0, 1]) $(`light-moves-${i + 1}`).setAttribute("aria-pressed", String(this.moved === i));
    remember(KEY, { colours: this.colours, both: this.both, intensities: this.intensities, falloff: this.falloff });
    this.#shine();
  }

  #recall() {
    const before = recalled(KEY) ?? {};
    if (Array.isArray(before.colours) && before.colours.length === 2 && before.colours.every(isColour)) this.colours = before.colours;
    if (Array.isArray(before.intensities) && before.intensities.length === 2 && before.intensities.every((/** @type {unknown} */ each) => isShare(each, 2))) this.intensities = before.intensities;
    if (isShare(before.falloff, 1)) this.falloff = before.falloff;
    if (typeof before.both === "boolean") this.both = before.both;
  }
}
