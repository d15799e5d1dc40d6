/** Ball: a small sphere in normal-map colours; a press on it sets the normal. */

import { context2d } from "../drawing/canvas.js";
import { onBall, turned } from "../drawing/normal.js";

const STEP = 5;
/** @type {Record<string, [number, number]>} */
const TURNS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Ball {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {(normal: import("../drawing/document.js").Normal, ended: boolean) => void} onTurn
   */
  constructor(canvas, onTurn) {
    this.canvas = canvas;
    this.context = context2d(canvas);
    this.onTurn = onTurn;
    /** @type {import("../drawing/document.js").Normal} */
    this.normal = [0, 0, 1];
    /** @type {ImageData | null} */
    this.sphere = null;
    this.held = false;
    this.turning = false;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.held = true;
      this.#point(event, false);
    });
    canvas.addEventListener("pointermove", (event) => this.held && this.#point(event, false));
    canvas.addEventListener("pointerup", (event) => this.#release(() => this.#point(event, true)));
    canvas.addEventListener("pointercancel", () => this.#release(() => onTurn(this.normal, true)));
    canvas.addEventListener("keydown", (event) => this.#key(event));
    canvas.addEventListener("keyup", (event) => event.key in TURNS && this.#settle());
    canvas.addEventListener("blur", () => this.#settle());
  }

  /** @param {import("../drawing/document.js").Normal} normal */
  show(normal) {
    this.normal = normal;
    const { context, canvas } = this;
    const side = Math.round(canvas.clientWidth * devicePixelRatio) || 240;
    if (canvas.width !== side || !this.sphere) {
      canvas.width = canvas.height = side;
      this.sphere = paintedSphere(side);
    }
    context.putImageData(this.sphere, 0, 0);
    const radius = side / 2 - 2;
    const [x, y] = [side / 2 + normal[0] * radius, side / 2 - normal[1] * radius];
    for (const { colour, width } of [{ colour: "#fff", width: 0.045 }, { colour: "#22232a", width: 0.018 }]) {
      [context.strokeStyle, context.lineWidth, context.lineCap] = [colour, width * side, "round"];
      context.beginPath();
      context.moveTo(side / 2, side / 2);
      context.lineTo(x, y);
      context.stroke();
      context.beginPath();
      // The whole handle stays visible near the rim.
      const limit = Math.min(1, (radius - 0.06 * side) / Math.max(1, Math.hypot(x - side / 2, y - side / 2)));
      context.arc(side / 2 + (x - side / 2) * limit, side / 2 + (y - side / 2) * limit, 0.05 * side, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  /** @param {PointerEvent} event @param {boolean} ended */
  #point(event, ended) {
    const box = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    this.onTurn(onBall(x * 1.03, y * 1.03), ended);
  }

  /** @param {() => void} end */
  #release(end) {
    if (!this.held) return;
    this.held = false;
    end();
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const turn = TURNS[event.key];
    if (!turn || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.turning = true;
    const step = event.shiftKey ? 1 : STEP;
    this.onTurn(turned(this.normal, turn[0] * step, turn[1] * step), false);
  }

  /** Repeats of a held key are one step in history. */
  #settle() {
    if (!this.turning) return;
    this.turning = false;
    this.onTurn(this.normal, true);
  }
}

/** Returns a sphere in the colours of a normal map. @param {number} side @returns {ImageData} */
function paintedSphere(side) {
  const image = new ImageData(side, side);
  const radius = side / 2 - 1;
  for (let row = 0; row < side; row++) {
    for (let column = 0; column < side; column++) {
      const [x, y] = [(column + 0.5 - side / 2) / radius, (side / 2 - row - 0.5) / radius];
      const alpha = Math.max(0, Math.min(1, (1 - Math.hypot(x, y)) * radius + 0.5));
      const normal = onBall(x, y);
      image.data.set([...normal.map((n) => Math.round((n + 1) * 127.5)), Math.round(alpha * 255)], 4 * (row * side + column));
    }
  }
  return image;
}
