/** Handles pointer, wheel and keyboard over the viewer, which move the light or turn the relief. */

import { normalised } from "./viewer_shading.js";

export const DEFAULT_LIGHT = normalised([-0.5, 0.6, 0.62]); // from the upper left, in front of the surface
export const FRONT = { yaw: 0, pitch: 0, zoom: 1 };
const LOWEST = 0.97; // largest distance of the light from the middle: at 1 it would graze the picture's plane
const STEP = 0.08; // step of the light for a key
const TURN = Math.PI / 36;
/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
/** @type {Record<string, number>} */
const ZOOMS = { "+": 1, "=": 1, "-": -1, _: -1 };

/**
 * Returns the unit vector to the light over a point of a disc; at the centre, the light comes from the viewer.
 * @param {number} x to the right, radius 1
 * @param {number} y upwards
 * @returns {number[]}
 */
export function lightOver(x, y) {
  const shrink = Math.min(1, LOWEST / Math.max(Math.hypot(x, y), 1e-9));
  const [a, b] = [x * shrink, y * shrink];
  return [a, b, Math.sqrt(1 - a * a - b * b)];
}

/** @param {number} value @param {number} low @param {number} high */
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** @typedef {{view: string, light: number[], turn: {yaw: number, pitch: number, zoom: number}, frame: import("./viewer.js").Frame | null}} Scene the part that the user can move */

/** Moves a scene's light or turns its relief, following the user. */
export class ViewerInput {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Scene} scene
   * @param {(what: "light" | "turn") => void} changed
   * @param {AbortSignal} signal ends it
   */
  constructor(canvas, scene, changed, signal) {
    this.canvas = canvas;
    this.scene = scene;
    this.changed = changed;
    /** @type {PointerEvent | null} the pointer while it drags */
    this.last = null;
    /** @template {keyof HTMLElementEventMap} K @param {K} name @param {(event: HTMLElementEventMap[K]) => void} act */
    const on = (name, act) => canvas.addEventListener(name, act, { signal, passive: false });
    on("pointerdown", (event) => this.#down(event));
    on("pointermove", (event) => {
      if (this.last && event.pointerId === this.last.pointerId) this.#drag(event, this.last);
    });
    for (const end of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) {
      on(end, (event) => {
        if (event.pointerId === this.last?.pointerId) this.last = null;
      });
    }
    on("wheel", (event) => {
      if (this.#still || event.ctrlKey) return; // Ctrl with the wheel zooms the page
      event.preventDefault();
      this.#approach(clamp(-event.deltaY / 800, -0.2, 0.2));
    });
    on("keydown", (event) => {
      if (!this.#still && !event.ctrlKey && !event.metaKey && !event.altKey) this.#press(event);
    });
  }

  /**
   * Returns the unit vector to a light over a point of the canvas. It turns with the drawing, as if fixed to the paper.
   * @param {number} x in pixels of the page
   * @param {number} y
   */
  lightAt(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const radius = Math.min(box.width, box.height) / 2;
    const [right, up] = [(x - box.width / 2) / radius, (box.height / 2 - y) / radius];
    const angle = this.scene.frame?.angle ?? 0;
    return lightOver(right * Math.cos(angle) - up * Math.sin(angle), right * Math.sin(angle) + up * Math.cos(angle));
  }

  /** Whether the pointer turns the relief. */
  get #turning() {
    return this.scene.view === "relief";
  }

  /** Whether there is nothing to move. */
  get #still() {
    return this.scene.view === "map";
  }

  /** @param {PointerEvent} event */
  #down(event) {
    if (!event.isPrimary || event.button !== 0 || this.#still) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.last = event;
    if (!this.#turning) this.#drag(event, event);
  }

  /** @param {PointerEvent} event @param {PointerEvent} before */
  #drag(event, before) {
    const box = this.canvas.getBoundingClientRect();
    if (this.#turning) {
      const radius = Math.min(box.width, box.height) / 2;
      const [right, down] = [event.clientX - before.clientX, event.clientY - before.clientY];
      this.#turn(((right / radius) * Math.PI) / 2, ((down / radius) * Math.PI) / 2);
    } else {
      this.#shine(this.lightAt(event.clientX - box.x, event.clientY - box.y));
    }
    this.last = event;
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    const [x, y] = this.scene.light;
    const factor = event.shiftKey ? 3 : 1;
    const arrow = ARROWS[event.key]?.map((value) => value * factor);
    if (arrow && this.#turning) this.#turn(arrow[0] * TURN, -arrow[1] * TURN);
    else if (arrow) this.#shine(lightOver(x + arrow[0] * STEP, y + arrow[1] * STEP));
    else if (event.key in ZOOMS) this.#approach(0.12 * ZOOMS[event.key]);
    else if (event.key === "Home" && this.#turning) {
      Object.assign(this.scene.turn, FRONT);
      this.changed("turn");
    } else if (event.key === "Home") this.#shine(lightOver(DEFAULT_LIGHT[0], DEFAULT_LIGHT[1]));
    else return;
    event.preventDefault();
  }

  /** Zooms: enlarges the relief, or raises the light above the surface. @param {number} amount */
  #approach(amount) {
    const { turn, light: [x, y] } = this.scene;
    if (this.#turning) {
      turn.zoom = clamp(turn.zoom * Math.exp(amount), 0.3, 5);
      this.changed("turn");
    } else {
      this.#shine(lightOver(x * Math.exp(-amount), y * Math.exp(-amount)));
    }
  }

  /** @param {number[]} light */
  #shine(light) {
    this.scene.light = light;
    this.changed("light");
  }

  /** @param {number} yaw @param {number} pitch */
  #turn(yaw, pitch) {
    const { turn } = this.scene;
    turn.yaw = (turn.yaw + yaw) % (2 * Math.PI);
    turn.pitch = clamp(turn.pitch + pitch, -Math.PI / 2, Math.PI / 2);
    this.changed("turn");
  }
}
