/** History list: lists the steps, and goes back to any of them. */

import { linesOf } from "../drawing/document.js";
import { $, make } from "../elements/dom.js";
import { say, text } from "../text/text.js";

/** Maximum number of steps listed around the current one. */
const SHOWN = 200;

/** Whether a line was turned into a shape; moved lines keep their number of points. @param {import("../drawing/document.js").Stroke | undefined} from @param {import("../drawing/document.js").Stroke | undefined} to */
const isShaped = (from, to) => from?.kind === "pen" && to?.kind === "pen" && from.points.length !== to.points.length;

/** Whether a part of a picture was removed. @param {any} from @param {any} to */
const isCut = (from, to) => from.kind === "picture" && to.kind === "picture" && from.picture !== to.picture;

/** @typedef {import("../drawing/document.js").Stroke} Stroke @typedef {import("../drawing/document.js").Area} Area */

/** Returns the name of a step that changed a layer's strokes. @param {Stroke[]} from @param {Stroke[]} to */
function strokesStep(from, to) {
  /** @param {number} count */
  const begins = (count) => from.slice(0, count).every((each, i) => each === to[i]);
  if (from.length === to.length && begins(from.length - 1) && isShaped(from.at(-1), to.at(-1))) return text.stepShape;
  if (to.length > from.length) {
    // A cut picture or a rotated mirrored line becomes two.
    if (!begins(from.length)) return text.stepMoved;
    return { eraser: text.stepErased, picture: text.stepImported, pen: text.stepLine, fill: text.stepFill }[to[to.length - 1].kind];
  }
  const last = to.at(-1);
  if (last?.kind === "fill" && from.some((each) => each.kind === "fill" && each !== last && each.points === last.points)) return text.stepFill;
  const lines = linesOf(to);
  if (to.length < from.length && lines.length === linesOf(from).length) return text.stepFillGone;
  const gone = to.length < from.length || from.some((each, i) => isCut(each, to[i]));
  return gone ? text.stepRemoved : text.stepMoved;
}

/** Returns the name of a step that changed a layer's regions and brush strokes. @param {Area[]} from @param {Area[]} to */
function areasStep(from, to) {
  if (to.length < from.length) return text.stepAreaGone;
  if (to.length > from.length) {
    const last = to[to.length - 1];
    return last.structure ? text.stepStructure : last.size ? text.stepBrush : text.stepArea;
  }
  /** @param {(keyof Area)[]} parts @param {Area} area @param {number} i */
  const differs = (parts, area, i) => parts.some((part) => area[part] !== from[i][part]);
  if (to.some((area, i) => area.size && differs(["soft", "strength", "structure"], area, i))) return text.stepBrushChanged;
  return to.some((area, i) => differs(["form", "soft"], area, i)) ? text.stepForm : text.stepTurned;
}

/** Returns the name of a step that changed a layer. @param {import("../drawing/document.js").Layer} old @param {import("../drawing/document.js").Layer} now @returns {string | null} null: nothing */
function layerStep(old, now) {
  if (old.name !== now.name) return text.stepLayerNamed;
  if (old.form !== now.form) return text.stepForm;
  if (old.source !== now.source) return text.stepSource;
  if (old.visible !== now.visible) return now.visible ? text.stepLayerShown : text.stepLayerHidden;
  if (old.strokes !== now.strokes) return strokesStep(old.strokes, now.strokes);
  const points = now.hints.length - old.hints.length;
  if (old.hints !== now.hints) return points > 0 ? text.stepPoint : points < 0 ? text.stepPointGone : text.stepTurned;
  if (old.areas !== now.areas) return areasStep(old.areas, now.areas);
  if (old.mask !== now.mask) return now.mask.length < old.mask.length ? text.stepMaskGone : text.stepMask;
  return null;
}

/**
 * Returns what a step did.
 * @param {import("../drawing/document.js").Doc} before
 * @param {import("../drawing/document.js").Doc} after
 * @returns {string}
 */
export function nameOf(before, after) {
  const ids = new Set(before.layers.map(({ id }) => id));
  const fresh = after.layers.filter(({ id }) => !ids.has(id));
  if (fresh.some(({ strokes }) => strokes.length > 0)) {
    const taken = after.layers.some(({ id, strokes }) => before.layers.some((old) => old.id === id && old.strokes !== strokes));
    return taken ? text.stepSplit : text.stepLayersImported;
  }
  if (before.layers.length !== after.layers.length) return before.layers.length < after.layers.length ? text.stepLayer : text.stepLayerGone;
  if (before.layers.some(({ id }, i) => id !== after.layers[i].id)) return text.stepLayerMoved;
  // An import into an empty drawing also fits the paper to the picture.
  const imports = (/** @type {import("../drawing/document.js").Doc} */ { layers, pictures }) => pictures.length + layers.reduce((sum, { strokes }) => sum + strokes.length, 0);
  if ((before.width !== after.width || before.height !== after.height) && imports(after) <= imports(before)) return text.stepPaper;
  // A step changes one layer only.
  const at = Math.max(0, before.layers.findIndex((layer, i) => layer !== after.layers[i]));
  const name = layerStep(before.layers[at], after.layers[at]);
  if (name) return name;
  const more = after.pictures.length - before.pictures.length;
  if (before.pictures !== after.pictures) return more > 0 ? text.stepPicture : more < 0 ? text.stepPictureGone : text.stepPictureChanged;
  return text.stepSettings;
}

/** @param {import("../drawing/editor.js").Editor} editor @param {(words: string) => void} announce */
export function followHistory(editor, announce) {
  const panel = /** @type {HTMLDetailsElement} */ ($("history"));
  const show = () => {
    if (!panel.open) return;
    const { states, at } = editor.history;
    const first = Math.max(0, Math.min(at - SHOWN / 2, states.length - SHOWN));
    const rows = states.slice(first, first + SHOWN).map((state, i) => {
      const number = first + i;
      const name = number ? nameOf(states[number - 1], state) : text.stepFirst;
      const button = make("button", { type: "button", text: name });
      if (number === at) button.setAttribute("aria-current", "step");
      button.classList.toggle("undone", number > at);
      button.addEventListener("click", () => {
        if (editor.goTo(number)) announce(say("wentTo", { name }));
      });
      return make("li", {}, button);
    });
    const list = $("history-list");
    const inside = list.contains(document.activeElement);
    list.replaceChildren(...rows);
    const now = /** @type {HTMLElement | null} */ (list.querySelector("[aria-current]"));
    now?.scrollIntoView({ block: "nearest" });
    if (inside) now?.focus();
  };
  panel.addEventListener("toggle", show);
  editor.addEventListener("change", (event) => /** @type {CustomEvent} */ (event).detail.live || show());
  addEventListener("pointerdown", (event) => {
    if (!panel.contains(/** @type {Node} */ (event.target))) panel.open = false;
  });
}
