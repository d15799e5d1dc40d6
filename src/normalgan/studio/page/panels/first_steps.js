/** First steps: show one hint at a time until each action has been done once. */

import { $ } from "../elements/dom.js";
import { recalled, remember } from "../elements/settings.js";
import { text } from "../text/text.js";

const KEY = "normalgan-first-steps";
/** Duration of the last hint in milliseconds. */
const LAST = 6000;

/**
 * @param {import("../drawing/editor.js").Editor} editor
 * @param {import("../result/predictor.js").Predictor} predictor
 * @param {import("../result/result.js").Result} result
 */
export function teach(editor, predictor, result) {
  let at = Number(recalled(KEY) ?? 0);
  /** @type {{words: string, done: () => boolean}[]} */
  const steps = [
    { words: text.firstDraw, done: () => predictor.whole && predictor.painted !== null },
    { words: text.firstLight, done: () => result.view !== "map" },
    { words: text.firstPoint, done: () => editor.layer.hints.length > 0 && editor.chosen < 0 },
    { words: text.firstExport, done: () => /** @type {HTMLDialogElement} */ ($("export-dialog")).open },
  ];
  const done = steps.map(() => false);
  const strip = $("first-steps");
  const end = () => {
    at = steps.length;
    remember(KEY, at);
    strip.hidden = true;
  };
  // Steps already done are skipped.
  const look = () => {
    if (at >= steps.length) return;
    const before = at;
    steps.forEach((step, i) => { done[i] ||= step.done(); });
    while (at < steps.length && done[at]) at += 1;
    if (at !== before) show();
  };
  const show = () => {
    remember(KEY, at);
    strip.hidden = false;
    $("first-words").textContent = steps[at]?.words ?? text.firstDone;
    $("first-count").textContent = at < steps.length ? `${at + 1} / ${steps.length}` : "";
    if (at < steps.length) return;
    $("first-skip").textContent = text.close;
    setTimeout(end, LAST);
  };
  $("first-skip").addEventListener("click", end);
  for (const name of ["change", "state"]) editor.addEventListener(name, look);
  predictor.addEventListener("painted", look);
  result.addEventListener("view", look);
  $("export-dialog").addEventListener("focusin", look); // it gets the focus when opened
  if (at < steps.length) show();
  else strip.hidden = true;
}
