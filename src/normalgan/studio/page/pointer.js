/** Pointer: mouse, pen and fingers on a board, as strokes, pinches and moves of the view. */

/** @typedef {import("./tools.js").Tool} Tool */

/** @type {Record<string, number>} */
const REACH = { mouse: 14, pen: 16, touch: 24 };
/** Radians that two fingers turn before the paper turns with them. */
const LEAST_TURN = 0.3;

/** Milliseconds that a tap of several fingers takes at most, and pixels that they stir. */
const [TAP, STIRRED] = [300, 12];

/** Milliseconds that a hand may keep a pen away and still rest on the screen: its touches are no fingers. */
const RESTS = 500;

/** Whether it is the other end of a pen. @param {PointerEvent} event */
const isEraser = (event) => event.pointerType === "pen" && (event.button === 5 || (event.buttons & 32) !== 0);

/**
 * Lets pointers work on a board.
 * @param {import("./board.js").Board} board
 * @param {(event: PointerEvent) => Tool | null} tool null moves the view
 * @param {() => void} touched is called first
 * @param {(fingers: number) => void} tapped is called when so many fingers, two or more, have tapped together
 */
export function followPointers(board, tool, touched, tapped) {
  const { canvas, camera } = board;
  /** @type {Map<number, {x: number, y: number, pen: boolean}>} fingers and others that are down, in the pane */
  const down = new Map();
  /** @type {ReturnType<typeof tool>} what the gesture began with */
  let active = null;
  let panning = false;
  /** When a pen was near the pane last. */
  let penAt = -Infinity;
  let spaceHeld = false;
  let turned = 0;
  /** Fingers of the tap that may be going on; none if it is none. */
  let tap = { fingers: 0, since: 0, stirred: 0 };

  /** Whether it is a touch of the hand that holds a pen. @param {PointerEvent} event */
  const rests = (event) =>
    event.pointerType === "touch" && (event.timeStamp - penAt < RESTS || [...down.values()].some(({ pen }) => pen));
  /** @param {MouseEvent} event */
  const inPane = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  /** @param {PointerEvent} event */
  const touch = (event) => {
    const { x, y } = inPane(event);
    // A mouse has no pressure, and some pens report none: they draw with the middle one.
    const pressure = event.pointerType === "pen" && event.pressure > 0 ? event.pressure : 0.5;
    const reach = (REACH[event.pointerType] ?? REACH.mouse) / camera.scale;
    return { ...camera.toDrawing(x, y), pressure, reach, scale: camera.scale, pane: { x, y }, straight: event.shiftKey, eraser: isEraser(event) };
  };
  /** @param {number} id @param {{x: number, y: number}} from @param {{x: number, y: number}} to */
  const pinch = (id, from, to) => {
    const [other] = [...down].filter(([key]) => key !== id).map(([, at]) => at);
    const growth = Math.hypot(to.x - other.x, to.y - other.y) / Math.max(1, Math.hypot(from.x - other.x, from.y - other.y));
    /** @param {{x: number, y: number}} a @param {{x: number, y: number}} b */
    const angle = (a, b) => Math.atan2(b.y - a.y, b.x - a.x);
    const turn = angle(other, to) - angle(other, from);
    turned += Math.atan2(Math.sin(turn), Math.cos(turn));
    // A pinch that is meant to zoom always turns a little.
    if (camera.view.angle !== 0 || Math.abs(turned) > LEAST_TURN) {
      camera.zoom(other.x, other.y, growth);
      camera.turn(other.x, other.y, turn);
      return;
    }
    // Around the middle, which then follows by half: what is under either finger stays there.
    camera.zoom((from.x + other.x) / 2, (from.y + other.y) / 2, growth);
    camera.pan((to.x - from.x) / 2, (to.y - from.y) / 2);
  };

  canvas.addEventListener("pointerdown", (event) => {
    const pen = event.pointerType === "pen";
    if (rests(event)) {
      event.preventDefault();
      return;
    }
    if (event.button > 1 && !isEraser(event)) return;
    if (pen) {
      // The hand came down before its pen: what it has begun was not meant.
      active?.cancel();
      active = null;
      down.clear();
      penAt = event.timeStamp;
    }
    if (active && event.pointerType !== "touch") return;
    touched();
    canvas.setPointerCapture(event.pointerId);
    // Its ring is for keys.
    board.focus.focus(/** @type {FocusOptions} */ (/** @type {object} */ ({ preventScroll: true, focusVisible: false })));
    event.preventDefault();
    board.cursor = null;
    down.set(event.pointerId, { ...inPane(event), pen });
    if (down.size === 1) tap = { fingers: 0, since: event.timeStamp, stirred: 0 };
    if (event.pointerType === "touch") tap.fingers += 1;
    if (down.size === 2) {
      active?.cancel();
      active = null;
      turned = 0;
      return;
    }
    if (down.size > 2) return;
    const chosen = tool(event);
    // Where there is a pen, a finger or the palm only moves the paper.
    panning = !chosen || spaceHeld || event.button === 1 || (penAt > -Infinity && event.pointerType === "touch");
    canvas.classList.toggle("grabbing", panning);
    if (panning) return;
    active = chosen;
    active?.down(touch(event));
    board.redraw();
  });

  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    const pen = event.pointerType === "pen";
    if (pen) penAt = event.timeStamp;
    if (!before && event.pointerType === "touch") return;
    const at = inPane(event);
    board.pointer = camera.toDrawing(at.x, at.y);
    if (before) {
      tap.stirred += Math.hypot(at.x - before.x, at.y - before.y);
      // Fingers that lie still stir a little.
      if (down.size > 1 && tap.stirred < STIRRED) return;
      if (down.size > 1) pinch(event.pointerId, before, at);
      else if (panning) camera.pan(at.x - before.x, at.y - before.y);
      if (down.size === 1 && !panning && active) {
        const all = event.getCoalescedEvents?.() ?? [];
        for (const each of all.length ? all : [event]) active.move(touch(each));
      }
      down.set(event.pointerId, { ...at, pen });
    }
    board.redraw();
  });

  /** @param {PointerEvent} event @param {"up" | "cancel"} way */
  const ended = (event, way) => {
    if (!down.delete(event.pointerId)) return;
    if (down.size) return;
    if (way === "up" && tap.fingers > 1 && event.timeStamp - tap.since < TAP && tap.stirred < STIRRED) tapped(tap.fingers);
    panning = false;
    canvas.classList.remove("grabbing");
    const ending = active;
    active = null;
    ending?.[way]();
  };
  canvas.addEventListener("pointerup", (event) => ended(event, "up"));
  canvas.addEventListener("pointercancel", (event) => ended(event, "cancel"));
  canvas.addEventListener("pointerleave", () => {
    board.pointer = null;
    board.redraw();
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const { x, y } = inPane(event);
    const by = event.deltaY * (event.deltaMode ? 0.05 : 0.002);
    if (event.altKey) camera.turn(x, y, by);
    else if (event.shiftKey) camera.pan(-event.deltaY - event.deltaX, 0);
    else camera.zoom(x, y, Math.exp(-by));
  }, { passive: false });

  addEventListener("keydown", (event) => {
    if (event.code !== "Space" || document.activeElement !== board.focus) return;
    event.preventDefault();
    spaceHeld = true;
    canvas.classList.add("grab");
  });
  addEventListener("keyup", (event) => {
    if (event.code !== "Space") return;
    spaceHeld = false;
    canvas.classList.remove("grab");
  });
  return {
    /** Drops the gesture that goes on. */
    cancel() {
      active?.cancel();
      active = null;
    },
  };
}
