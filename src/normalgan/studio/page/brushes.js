/** Brushes: how soft and strong the direction brush is, and whether it smooths; of the chosen stroke, or else of the next. */

import { changedArea } from "./document.js";
import { $, field } from "./dom.js";

/** How much a key changes softness or strength. */
const STEP = 0.1;

/** @typedef {"soft" | "strength"} Part */

/**
 * Wires the brush's button and sliders.
 * @param {import("./editor.js").Editor} editor
 * @returns {{turnOver: () => void, change: (part: Part, steps: number) => void}} smooths or no more; makes softer or stronger
 */
export function followBrushes(editor) {
  /** @type {Part[]} */
  const parts = ["soft", "strength"];
  /** The chosen stroke of the brush. */
  const chosen = () => {
    const area = editor.layer.areas[editor.area];
    return area?.size ? area : undefined;
  };
  /** @param {Part} part */
  const now = (part) => chosen()?.[part] ?? editor.brush[part];

  /** @param {Part} part @param {number} value @param {boolean} ended */
  const take = (part, value, ended) => {
    editor.set({ brush: { ...editor.brush, [part]: value } });
    if (!chosen()) return;
    const doc = changedArea(editor.history.state, editor.area, { [part]: value });
    // Presses that follow one another are one step in history.
    if (ended) editor.commit(doc, `${part} ${editor.area}`);
    else editor.preview(doc);
  };
  for (const part of parts) {
    const slider = field(`brush-${part}`);
    slider.addEventListener("input", () => take(part, slider.valueAsNumber / 100, false));
    slider.addEventListener("change", () => take(part, slider.valueAsNumber / 100, true));
  }
  const turnOver = () => editor.set({ brush: { ...editor.brush, smooths: !editor.brush.smooths }, area: -1 });
  $("brush-smooth").addEventListener("click", turnOver);

  const show = () => {
    $("brush-options").hidden = editor.tool !== "brush";
    $("brush-smooth").setAttribute("aria-pressed", String(editor.brush.smooths));
    for (const part of parts) field(`brush-${part}`).value = String(Math.round(100 * now(part)));
  };
  editor.addEventListener("change", show);
  editor.addEventListener("state", show);
  show();
  return {
    turnOver,
    change: (part, steps) => {
      if (editor.tool === "brush") take(part, Math.round(100 * Math.max(0, Math.min(1, now(part) + steps * STEP))) / 100, true);
    },
  };
}
