/** Forms: make the selected region, or else the active layer, round, flat or hollow. */

import { clear, context2d } from "../drawing/canvas.js";
import { changedArea, drawnLayers, withActive } from "../drawing/document.js";
import { LIMITS } from "../drawing/limits.js";
import { $, field, label, make } from "../elements/dom.js";
import { icon } from "../elements/icons.js";
import { followPicker } from "../elements/sheets.js";
import { predict } from "../server/api.js";
import { say, text, wordsOf } from "../text/text.js";

/** @typedef {import("../drawing/document.js").Form} Form */

/** @type {("none" | Form["kind"])[]} */
const KINDS = ["none", "round", "flat", "hollow"];
const NAMES = { none: "formNone", round: "formRound", flat: "formFlat", hollow: "formHollow" };
/** Side of a form's preview in pixels, and maximum side of the map requested for it. */
const [SIDE, MOST] = [96, 512];
/** Margin around the part in its preview, as a fraction of its size. */
const AROUND = 0.15;
/** Default softness of the edge of a region without a form, and of one with a form. */
const SOFT = { none: 0.5, formed: 0 };

/** @typedef {"none" | Form["kind"]} Kind */

/** The form's button, its card and its sliders. */
export class Forms {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../result/predictor.js").Predictor} predictor
   * @param {(map: import("../result/viewer.js").Picture) => Uint8ClampedArray<ArrayBuffer>} shaded returns a map lit as in the result
   */
  constructor(editor, predictor, shaded) {
    this.editor = editor;
    this.predictor = predictor;
    this.shaded = shaded;
    this.bevel = field("form-bevel");
    this.strength = field("form-strength");
    this.soft = field("form-soft");
    /** Number of requested previews, so that only the latest is shown. */
    this.looks = 0;
    // Errors are shown with the map itself; without previews, the forms have icons.
    followPicker("form-choose", () => { this.#preview().catch(() => {}); });
    for (const kind of KINDS) $(`form-${kind}`).addEventListener("click", () => this.#take(kind));
    for (const [event, ended] of /** @type {const} */ ([["input", false], ["change", true]])) {
      for (const part of /** @type {const} */ (["bevel", "strength"])) {
        this[part].addEventListener(event, () => {
          const form = this.#formNow();
          if (form) this.#change({ form: { ...form, [part]: this[part].valueAsNumber / 100 } }, ended, part);
        });
      }
      this.soft.addEventListener(event, () => this.#change({ soft: this.soft.valueAsNumber / 100 }, ended, "soft"));
    }
    for (const event of ["change", "state"]) editor.addEventListener(event, () => this.#show());
    this.#show();
  }

  /** Selects the next form. */
  next() {
    this.editor.set({ tool: "region" });
    this.#take(KINDS[(KINDS.indexOf(this.#formNow()?.kind ?? "none") + 1) % KINDS.length]);
  }

  /** Returns the selected region; undefined stands for the whole layer. */
  #region() {
    const area = this.editor.layer.areas[this.editor.area];
    return area?.size ? undefined : area;
  }

  #formNow() {
    return (this.#region() ?? this.editor.layer).form ?? null;
  }

  /** @param {Kind} kind @returns {Form | null} */
  #formOf(kind) {
    return kind === "none" ? null : { strength: 1, ...this.#formNow(), kind, bevel: LIMITS.forms[kind] };
  }

  /** @param {Kind} kind */
  #take(kind) {
    this.#change({ form: this.#formOf(kind) }, true);
  }

  /**
   * @param {Partial<import("../drawing/document.js").Area>} change @param {boolean} ended
   * @param {string} [slider] whose consecutive changes are one step in history
   */
  #change(change, ended, slider) {
    const { editor } = this;
    const { state } = editor.history;
    const doc = this.#region() ? changedArea(state, editor.area, change) : withActive(state, { form: change.form ?? null });
    if (ended) editor.commit(doc, slider && `${slider} ${editor.area}`);
    else editor.preview(doc);
  }

  /** Shows a preview of each form of the part; until it arrives, or if nothing is drawn, icons are shown. */
  async #preview() {
    const { editor } = this;
    const look = ++this.looks;
    const { doc, layer } = editor;
    for (const kind of KINDS) $(`form-${kind}`).querySelector("canvas")?.remove();
    if (!drawnLayers(doc).includes(layer)) return;
    const alone = { ...doc, layers: [layer] };
    const area = this.#region();
    const box = area && boxOf(area.points);
    const longest = Math.max(doc.width, doc.height);
    const size = box ? Math.min(MOST, longest, Math.round((SIDE * longest) / Math.max(1, box.width, box.height))) : 2 * SIDE;
    for (const kind of KINDS) {
      const now = this.#formNow();
      const form = (now?.kind ?? "none") === kind ? now : this.#formOf(kind);
      const formed = area ? changedArea(alone, editor.area, { form }) : withActive(alone, { form });
      const map = await this.predictor.askAt(Math.max(2 * SIDE, size), (request) => predict(request), {}, formed, "form");
      // Another part has been selected, or the card has been reopened.
      if (look !== this.looks || editor.layer !== layer || !map) return;
      const canvas = make("canvas", { width: SIDE, height: SIDE, "aria-hidden": "true" });
      drawPart(canvas, map, this.shaded(map), box && scaledBox(box, map.width / doc.width));
      $(`form-${kind}`).prepend(canvas);
    }
  }

  #show() {
    const [area, form] = [this.#region(), this.#formNow()];
    $("form-of").textContent = area ? say("formRegion", { number: this.editor.area + 1 }) : text.formLayer;
    const now = form?.kind ?? "none";
    for (const kind of KINDS) $(`form-${kind}`).setAttribute("aria-pressed", String(kind === now));
    $("form-choose").replaceChildren(icon(now), make("span", { text: wordsOf(NAMES[now]) }));
    label($("form-choose"), `${text.form}: ${wordsOf(NAMES[now])}`);
    $("form-bevel-label").hidden = $("form-strength-label").hidden = !form;
    $("form-soft-label").hidden = !area;
    $("region-help").hidden = form !== null || area !== undefined;
    this.bevel.value = String(100 * (form?.bevel ?? 1));
    this.strength.value = String(100 * (form?.strength ?? 1));
    this.soft.value = String(100 * (area?.soft ?? SOFT[form ? "formed" : "none"]));
  }
}

/** @typedef {{x: number, y: number, width: number, height: number}} Box */
/** @param {number[]} points x, y, x, y, … @returns {Box} */
function boxOf(points) {
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i += 2) {
    [left, right] = [Math.min(left, points[i]), Math.max(right, points[i])];
    [top, bottom] = [Math.min(top, points[i + 1]), Math.max(bottom, points[i + 1])];
  }
  return { x: left, y: top, width: right - left, height: bottom - top };
}

/** @param {Box} box @param {number} scale @returns {Box} */
const scaledBox = ({ x, y, width, height }, scale) => ({ x: x * scale, y: y * scale, width: width * scale, height: height * scale });

/** Returns the bounding box of the object. @param {import("../result/viewer.js").Picture} map @returns {Box} */
function objectOf({ rgba, width, height }) {
  /** @type {number[]} */
  const points = [];
  for (let i = 0; i < width * height; i++) if (rgba[4 * i + 3] > 127) points.push(i % width, Math.floor(i / width));
  return points.length ? boxOf(points) : { x: 0, y: 0, width, height };
}

/**
 * Draws a part of a shaded map with a margin.
 * @param {HTMLCanvasElement} canvas @param {import("../result/viewer.js").Picture} map @param {Uint8ClampedArray<ArrayBuffer>} pixels @param {Box} [part] undefined draws the object
 */
function drawPart(canvas, map, pixels, part = objectOf(map)) {
  const whole = document.createElement("canvas");
  [whole.width, whole.height] = [map.width, map.height];
  context2d(whole).putImageData(new ImageData(pixels, map.width), 0, 0);
  const side = (1 + 2 * AROUND) * Math.max(part.width, part.height, 1);
  const context = context2d(canvas);
  clear(context);
  context.imageSmoothingQuality = "high";
  context.drawImage(whole, part.x + (part.width - side) / 2, part.y + (part.height - side) / 2, side, side, 0, 0, canvas.width, canvas.height);
}
