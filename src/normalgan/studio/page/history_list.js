/** History list: the steps that were done, to go back to any of them. */

import { $, make } from "./dom.js";
import { say, text } from "./text.js";

/** Steps that are listed; older ones are undone one by one. */
const SHOWN = 200;

/** Whether a line was made a shape: moved lines keep their number of points. @param {import("./document.js").Stroke | undefined} from @param {import("./document.js").Stroke | undefined} to */
const isShaped = (from, to) => from?.kind === "pen" && to?.kind === "pen" && from.points.length !== to.points.length;

/** Whether a part of a picture was taken away. @param {any} from @param {any} to */
const isCut = (from, to) => from.kind === "picture" && to.kind === "picture" && from.picture !== to.picture;

/**
 * Returns what a step did.
 * @param {import("./document.js").Doc} before
 * @param {import("./document.js").Doc} after
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
  if (before.width !== after.width || before.height !== after.height) return text.stepPaper;
  // One step changes one layer.
  const at = Math.max(0, before.layers.findIndex((layer, i) => layer !== after.layers[i]));
  const [old, now] = [before.layers[at], after.layers[at]];
  if (old.name !== now.name) return text.stepLayerNamed;
  if (old.form !== now.form) return text.stepForm;
  if (old.source !== now.source) return text.stepSource;
  if (old.visible !== now.visible) return now.visible ? text.stepLayerShown : text.stepLayerHidden;
  /** @type {["strokes" | "hints" | "areas" | "mask", string, string, string][]} */
  const lists = [
    ["strokes", text.stepLine, text.stepRemoved, text.stepMoved], ["hints", text.stepPoint, text.stepPointGone, text.stepTurned],
    ["areas", text.stepArea, text.stepAreaGone, text.stepTurned], ["mask", text.stepMask, text.stepMaskGone, text.stepMask],
  ];
  for (const [list, added, removed, changed] of lists) {
    const [from, to] = [old[list], now[list]];
    if (from === to) continue;
    if (list === "strokes" && from.length === to.length && old.strokes.slice(0, -1).every((each, i) => each === now.strokes[i]) && isShaped(old.strokes.at(-1), now.strokes.at(-1))) return text.stepShape;
    // A picture that is cut, or a mirrored line that is turned, becomes two.
    if (list === "strokes" && to.length > from.length && !from.every((each, i) => each === to[i])) return changed;
    if (to.length > from.length) {
      const last = list === "strokes" ? now.strokes[now.strokes.length - 1].kind : "";
      if (list === "areas" && now.areas.at(-1)?.structure) return text.stepStructure;
      if (list === "areas" && now.areas.at(-1)?.size) return text.stepBrush;
      return last === "eraser" ? text.stepErased : last === "picture" ? text.stepImported : added;
    }
    if (list === "areas" && now.areas.some((area, i) => area.size && (area.soft !== old.areas[i]?.soft || area.strength !== old.areas[i]?.strength || area.structure !== old.areas[i]?.structure))) return to.length < from.length ? removed : text.stepBrushChanged;
    if (list === "areas" && now.areas.some((area, i) => area.form !== old.areas[i]?.form || area.soft !== old.areas[i]?.soft)) return text.stepForm;
    return to.length < from.length || (list === "strokes" && from.some((each, i) => isCut(each, now.strokes[i]))) ? removed : changed;
  }
  const more = after.pictures.length - before.pictures.length;
  if (before.pictures !== after.pictures) return more > 0 ? text.stepPicture : more < 0 ? text.stepPictureGone : text.stepPictureChanged;
  return text.stepSettings;
}

/** @param {import("./editor.js").Editor} editor @param {(words: string) => void} announce */
export function followHistory(editor, announce) {
  const panel = /** @type {HTMLDetailsElement} */ ($("history"));
  const show = () => {
    if (!panel.open) return;
    const { states, at } = editor.history;
    const first = Math.max(0, states.length - SHOWN);
    const rows = states.slice(first).map((state, i) => {
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
