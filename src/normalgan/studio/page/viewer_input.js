/** Pointer, wheel and keyboard over the viewer: they move the light, or turn the relief. */

import { normalised } from "./viewer_shading.js";

export const DEFAULT_LIGHT = normalised([-0.5, 0.6, 0.62]); // the upper left, before the surface
export const FRONT = { yaw: 0, pitch: 0, zoom: 1 };
const LOWEST = 0.97; // how far out the light goes: at 1 it would graze the picture's plane
const STEP = 0.08; // of the light, for a key
const TURN = Math.PI / 36;
/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
/** @type {Record<string, number>} */
const ZOOMS = { "+": 1, "=": 1, "-": -1, _: -1 };

/**
 * Returns the unit vector to the light over a point of a disc; over its middle, it shines from the viewer.
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

/**
 * Moves scene.light or scene.turn as the user does.
 * @param {HTMLCanvasElement} canvas
 * @param {{view: string, light: number[], turn: {yaw: number, pitch: number, zoom: number},
 *   frame: import("./viewer.js").Frame | null}} scene
 * @param {(what: "light" | "turn") => void} changed
 * @param {AbortSignal} signal ends it
 * @returns {(x: number, y: number) => number[]} gives a light over a point of the canvas
 */
export function listen(canvas, scene, changed, signal) {
  const isTurning = () => scene.view === "relief";
  const isStill = () => scene.view === "map";
  /** @type {PointerEvent | null} the pointer while it drags */
  let last = null;

  /** @param {number} x @param {number} y */
  function setLight(x, y) {
    scene.light = lightOver(x, y);
    changed("light");
  }

  /** @param {number} yaw @param {number} pitch */
  function turn(yaw, pitch) {
    scene.turn.yaw = (scene.turn.yaw + yaw) % (2 * Math.PI);
    scene.turn.pitch = clamp(scene.turn.pitch + pitch, -Math.PI / 2, Math.PI / 2);
    changed("turn");
  }

  /** @param {PointerEvent} event @param {PointerEvent} before */
  function drag(event, before) {
    const box = canvas.getBoundingClientRect();
    const radius = Math.min(box.width, box.height) / 2;
    if (isTurning()) {
      const [right, down] = [event.clientX - before.clientX, event.clientY - before.clientY];
      turn(((right / radius) * Math.PI) / 2, ((down / radius) * Math.PI) / 2);
    } else {
      scene.light = lightAt(event.clientX - box.x, event.clientY - box.y);
      changed("light");
    }
    last = event;
  }

  // The light turns with the drawing, as if it were fixed to the paper.
  /** @param {number} x @param {number} y */
  function lightAt(x, y) {
    const box = canvas.getBoundingClientRect();
    const radius = Math.min(box.width, box.height) / 2;
    const [right, up] = [(x - box.width / 2) / radius, (box.height / 2 - y) / radius];
    const angle = scene.frame?.angle ?? 0;
    return lightOver(right * Math.cos(angle) - up * Math.sin(angle), right * Math.sin(angle) + up * Math.cos(angle));
  }

  // Nearer: a larger relief, or a light that is higher above the surface.
  /** @param {number} amount */
  function approach(amount) {
    if (isTurning()) {
      scene.turn.zoom = clamp(scene.turn.zoom * Math.exp(amount), 0.3, 5);
      changed("turn");
    } else {
      const [x, y] = scene.light;
      setLight(x * Math.exp(-amount), y * Math.exp(-amount));
    }
  }

  /** @param {KeyboardEvent} event */
  function press(event) {
    const factor = event.shiftKey ? 3 : 1;
    const arrow = ARROWS[event.key]?.map((value) => value * factor);
    if (arrow && isTurning()) turn(arrow[0] * TURN, -arrow[1] * TURN);
    else if (arrow) setLight(scene.light[0] + arrow[0] * STEP, scene.light[1] + arrow[1] * STEP);
    else if (event.key in ZOOMS) approach(0.12 * ZOOMS[event.key]);
    else if (event.key === "Home" && isTurning()) {
      Object.assign(scene.turn, FRONT);
      changed("turn");
    } else if (event.key === "Home") setLight(DEFAULT_LIGHT[0], DEFAULT_LIGHT[1]);
    else return;
    event.preventDefault();
  }

  /** @template {keyof HTMLElementEventMap} K @param {K} name @param {(event: HTMLElementEventMap[K]) => void} act */
  const on = (name, act) => canvas.addEventListener(name, act, { signal, passive: false });
  on("pointerdown", (event) => {
    if (!event.isPrimary || event.button !== 0 || isStill()) return;
    canvas.setPointerCapture(event.pointerId);
    last = event;
    if (!isTurning()) drag(event, event);
  });
  on("pointermove", (event) => {
    if (last && event.pointerId === last.pointerId) drag(event, last);
  });
  for (const end of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) {
    on(end, (event) => {
      if (event.pointerId === last?.pointerId) last = null;
    });
  }
  on("wheel", (event) => {
    if (isStill() || event.ctrlKey) return; // Ctrl and the wheel zoom the page
    event.preventDefault();
    approach(clamp(-event.deltaY / 800, -0.2, 0.2));
  });
  on("keydown", (event) => {
    if (!isStill() && !event.ctrlKey && !event.metaKey && !event.altKey) press(event);
  });
  return lightAt;
}
