/** Forms: makes the chosen region, or else the layer that is worked on, round, flat or hollow. */

import { changedArea, withActive } from "./document.js";
import { $, field } from "./dom.js";
import { say, text } from "./text.js";

/** @typedef {import("./document.js").Form} Form */

/** @type {("none" | Form["kind"])[]} */
const KINDS = ["none", "round", "flat", "hollow"];
/** How wide a form's bevel is at first. @type {Record<Form["kind"], number>} */
const BEVELS = { round: 1, flat: 0.2, hollow: 1 };
/** How soft the edge is that says nothing else, of a region as predicted and of one with a form. */
const SOFT = { none: 0.5, formed: 0 };

/**
 * Wires the form's buttons and sliders.
 * @param {import("./editor.js").Editor} editor
 * @returns {() => void} takes the next form
 */
export function followForms(editor) {
  const [bevel, strength, soft] = ["form-bevel", "form-strength", "form-soft"].map(field);
  /** The chosen region; undefined is the whole layer. */
  const region = () => {
    const area = editor.layer.areas[editor.area];
    return area?.size ? undefined : area;
  };
  const formNow = () => (region() ?? editor.layer).form ?? null;

  /**
   * @param {Partial<import("./document.js").Area>} change @param {boolean} ended
   * @param {string} [slider] whose presses that follow one another are one step in history
   */
  const change = (change, ended, slider) => {
    const { state } = editor.history;
    const doc = region() ? changedArea(state, editor.area, change) : withActive(state, { form: change.form ?? null });
    if (ended) editor.commit(doc, slider && `${slider} ${editor.area}`);
    else editor.preview(doc);
  };
  /** @param {"none" | Form["kind"]} kind */
  const take = (kind) =>
    change({ form: kind === "none" ? null : { strength: 1, ...formNow(), kind, bevel: BEVELS[kind] } }, true);

  for (const kind of KINDS) $(`form-${kind}`).addEventListener("click", () => take(kind));
  for (const [event, ended] of /** @type {const} */ ([["input", false], ["change", true]])) {
    for (const [slider, part] of /** @type {const} */ ([[bevel, "bevel"], [strength, "strength"]])) {
      slider.addEventListener(event, () => {
        const form = formNow();
        if (form) change({ form: { ...form, [part]: slider.valueAsNumber / 100 } }, ended, part);
      });
    }
    soft.addEventListener(event, () => change({ soft: soft.valueAsNumber / 100 }, ended, "soft"));
  }

  const show = () => {
    const [area, form] = [region(), formNow()];
    $("form-of").textContent = area ? say("formRegion", { number: editor.area + 1 }) : text.formLayer;
    for (const kind of KINDS) $(`form-${kind}`).setAttribute("aria-pressed", String(kind === (form?.kind ?? "none")));
    $("form-bevel-label").hidden = $("form-strength-label").hidden = !form;
    $("form-soft-label").hidden = !area;
    $("region-help").hidden = form !== null || area !== undefined;
    bevel.value = String(100 * (form?.bevel ?? 1));
    strength.value = String(100 * (form?.strength ?? 1));
    soft.value = String(100 * (area?.soft ?? SOFT[form ? "formed" : "none"]));
  };
  editor.addEventListener("change", show);
  editor.addEventListener("state", show);
  show();
  return () => {
    editor.set({ tool: "region" });
    take(KINDS[(KINDS.indexOf(formNow()?.kind ?? "none") + 1) % KINDS.length]);
  };
}
