/** Pointer: turn mouse, pen and touch input on a board into strokes, pinches and panning. */

import { apart } from "../drawing/simplify.js";

/** @typedef {import("./tools.js").Tool} Tool @typedef {{x: number, y: number}} Place */

/** @type {Record<string, number>} */
const REACH = { mouse: 14, pen: 16, touch: 24 };
/** Rotation of two fingers, in radians, at which the paper starts to rotate. */
const LEAST_TURN = 0.3;

/** Maximum duration of a multi-finger tap in milliseconds, and maximum movement in pixels. */
const [TAP, STIRRED] = [300, 12];

/** Time in milliseconds after the last pen event during which touches count as the resting hand. */
const RESTS = 500;

/** Whether the event comes from the eraser end of a pen. @param {PointerEvent} event */
const isEraser = (event) => event.pointerType === "pen" && (event.button === 5 || (event.buttons & 32) !== 0);

/** @param {Place} from @param {Place} to */
const angle = (from, to) => Math.atan2(to.y - from.y, to.x - from.x);

/** Handles the pointers on one board, which draw with the tool or move the view. */
export class Pointers {
  /**
   * @param {import("./board.js").Board} board
   * @param {(event: PointerEvent) => Tool | null} tool null moves the view
   * @param {() => void} touched is called first
   * @param {(fingers: number) => void} tapped is called after a tap with two or more fingers
   */
  constructor(board, tool, touched, tapped) {
    this.board = board;
    this.tool = tool;
    this.touched = touched;
    this.tapped = tapped;
    /** @type {Map<number, Place & {pen: boolean}>} all pressed pointers, in the pane */
    this.pressed = new Map();
    /** @type {Tool | null} the tool of the current gesture */
    this.active = null;
    this.panning = false;
    /** Time of the last pen event near the pane. */
    this.penAt = -Infinity;
    /** Whether the pen reports pressure. */
    this.feelsPressure = false;
    this.spaceHeld = false;
    /** Rotation of two fingers so far, in radians. */
    this.turned = 0;
    /** The multi-finger tap that may be in progress. */
    this.tap = { fingers: 0, since: 0, stirred: 0 };
    this.#listen();
  }

  /** Cancels the current gesture. */
  cancel() {
    this.active?.cancel();
    this.active = null;
  }

  #listen() {
    const { canvas } = this.board;
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", (event) => this.#end(event, "up"));
    canvas.addEventListener("pointercancel", (event) => this.#end(event, "cancel"));
    canvas.addEventListener("pointerleave", () => {
      this.board.pointer = null;
      this.board.redraw();
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    addEventListener("keydown", (event) => {
      if (event.code !== "Space" || document.activeElement !== this.board.focus) return;
      event.preventDefault();
      this.spaceHeld = true;
      canvas.classList.add("grab");
    });
    addEventListener("keyup", (event) => {
      if (event.code !== "Space") return;
      this.spaceHeld = false;
      canvas.classList.remove("grab");
    });
  }

  /** @param {PointerEvent} event */
  #down(event) {
    if (this.#rests(event)) {
      event.preventDefault();
      return;
    }
    if (event.button > 1 && !isEraser(event)) return;
    const { board, pressed } = this;
    const pen = event.pointerType === "pen";
    if (pen) {
      // Another pen, or one whose lifting was never reported, has drawn what it has drawn.
      if ([...pressed.values()].some((each) => each.pen)) this.#finish("up");
      // The hand touched the screen before the pen, so its gesture was not intended.
      this.cancel();
      pressed.clear();
      this.penAt = event.timeStamp;
    }
    if (this.active && event.pointerType !== "touch") return;
    this.touched();
    board.canvas.setPointerCapture(event.pointerId);
    // The focus ring is for keyboard users.
    board.focus.focus(/** @type {FocusOptions} */ (/** @type {object} */ ({ preventScroll: true, focusVisible: false })));
    event.preventDefault();
    board.cursor = null;
    pressed.set(event.pointerId, { ...this.#inPane(event), pen });
    if (pressed.size === 1) this.tap = { fingers: 0, since: event.timeStamp, stirred: 0 };
    if (event.pointerType === "touch") this.tap.fingers += 1;
    if (pressed.size === 1) this.#begin(event);
    if (pressed.size === 2) {
      this.cancel();
      this.turned = 0;
    }
  }

  /** Begins a gesture with the tool, or a move of the view. @param {PointerEvent} event */
  #begin(event) {
    const { board } = this;
    const chosen = this.tool(event);
    // Once a pen has been used, touch only moves the paper.
    this.panning = !chosen || this.spaceHeld || event.button === 1 || (this.penAt > -Infinity && event.pointerType === "touch");
    board.canvas.classList.toggle("grabbing", this.panning);
    if (this.panning) return;
    this.active = chosen;
    this.active?.down(this.#touch(event));
    board.redraw();
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const { board, pressed, tap } = this;
    const before = pressed.get(event.pointerId);
    const pen = event.pointerType === "pen";
    if (pen) this.penAt = event.timeStamp;
    if (!before && event.pointerType === "touch") return;
    const at = this.#inPane(event);
    board.pointer = board.camera.toDrawing(at.x, at.y);
    if (before) {
      tap.stirred += apart(before, at);
      // Resting fingers always move a little.
      if (pressed.size > 1 && tap.stirred < STIRRED) return;
      if (pressed.size > 1) this.#pinch(event.pointerId, before, at);
      else if (this.panning) board.camera.pan(at.x - before.x, at.y - before.y);
      else if (this.active) {
        const all = event.getCoalescedEvents?.() ?? [];
        for (const each of all.length ? all : [event]) this.active.move(this.#touch(each));
      }
      pressed.set(event.pointerId, { ...at, pen });
    }
    board.redraw();
  }

  /** @param {PointerEvent} event @param {"up" | "cancel"} way */
  #end(event, way) {
    const { pressed, tap } = this;
    if (!pressed.delete(event.pointerId) || pressed.size) return;
    if (way === "up" && tap.fingers > 1 && event.timeStamp - tap.since < TAP && tap.stirred < STIRRED) this.tapped(tap.fingers);
    this.#finish(way);
  }

  /** @param {"up" | "cancel"} way */
  #finish(way) {
    this.panning = false;
    this.board.canvas.classList.remove("grabbing");
    const ending = this.active;
    this.active = null;
    ending?.[way]();
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    event.preventDefault();
    const { camera } = this.board;
    const { x, y } = this.#inPane(event);
    const by = event.deltaY * (event.deltaMode ? 0.05 : 0.002);
    if (event.altKey) camera.turn(x, y, by);
    else if (event.shiftKey) camera.pan(-event.deltaY - event.deltaX, 0);
    else camera.zoom(x, y, Math.exp(-by));
  }

  /** Zooms and rotates the view with two fingers. @param {number} id of the one that moves @param {Place} from @param {Place} to */
  #pinch(id, from, to) {
    const { camera } = this.board;
    const [other] = [...this.pressed].filter(([key]) => key !== id).map(([, at]) => at);
    const growth = apart(other, to) / Math.max(1, apart(other, from));
    const turn = angle(other, to) - angle(other, from);
    this.turned += Math.atan2(Math.sin(turn), Math.cos(turn));
    // A pinch meant to zoom always rotates a little.
    if (camera.view.angle !== 0 || Math.abs(this.turned) > LEAST_TURN) {
      camera.zoom(other.x, other.y, growth);
      camera.turn(other.x, other.y, turn);
      return;
    }
    // Zoom around the midpoint, which then moves by half, so that the drawing stays under both fingers.
    camera.zoom((from.x + other.x) / 2, (from.y + other.y) / 2, growth);
    camera.pan((to.x - from.x) / 2, (to.y - from.y) / 2);
  }

  /** Whether a touch comes from the hand that holds the pen. @param {PointerEvent} event */
  #rests(event) {
    return event.pointerType === "touch" && (event.timeStamp - this.penAt < RESTS || [...this.pressed.values()].some(({ pen }) => pen));
  }

  /** @param {MouseEvent} event @returns {Place} */
  #inPane(event) {
    const box = this.board.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** Returns the touch that is passed to a tool for an event. @param {PointerEvent} event @returns {import("./tools.js").Touch} */
  #touch(event) {
    const { camera } = this.board;
    const { x, y } = this.#inPane(event);
    const pen = event.pointerType === "pen";
    this.feelsPressure ||= pen && event.pressure > 0;
    // A mouse has no pressure, and some pens report none: they draw with medium pressure. Other pens report 0 when they are lifted.
    const pressure = pen && this.feelsPressure ? event.pressure : 0.5;
    const reach = (REACH[event.pointerType] ?? REACH.mouse) / camera.scale;
    return { ...camera.toDrawing(x, y), pressure, reach, scale: camera.scale, pane: { x, y }, straight: event.shiftKey, eraser: isEraser(event) };
  }
}
