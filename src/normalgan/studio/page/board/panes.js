/** Panes: which panes are visible, and how the drawing overlays the result. */

import { context2d } from "../drawing/canvas.js";
import { $ } from "../elements/dom.js";
import { text } from "../text/text.js";

const STEP = 0.05;
const AMBER = [255, 140, 0];
const OBJECT = [91, 98, 224];
/** @typedef {"drawing" | "result" | "both"} Layout */
/** @type {Layout[]} */
const LAYOUTS = ["drawing", "result", "both"];
/** Windows that are too small for two panes. */
const SMALL = "(max-width: 560px), (max-height: 430px)";

/**
 * Returns a picture of a single colour with varying opacity.
 * @param {number} width @param {number} height @param {number[]} colour @param {(pixel: number) => number} opacity 0 to 255
 * @returns {HTMLCanvasElement}
 */
function tinted(width, height, [red, green, blue], opacity) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const image = new ImageData(width, height);
  const { data } = image;
  for (let pixel = 0, at = 0; at < data.length; pixel++, at += 4) {
    data[at] = red;
    data[at + 1] = green;
    data[at + 2] = blue;
    data[at + 3] = opacity(pixel);
  }
  context2d(canvas).putImageData(image, 0, 0);
  return canvas;
}

/** Draws the model's uncertainty in amber. @param {{shares: Uint8Array, width: number, height: number}} doubt */
const veilOf = ({ shares, width, height }) => tinted(width, height, AMBER, (pixel) => Math.min(235, 2.2 * shares[pixel]));

/** Draws a tint over the object. @param {import("../result/predictor.js").Painted} painted */
const objectOf = ({ rgba, width, height }) => tinted(width, height, OBJECT, (pixel) => Math.round(0.3 * rgba[4 * pixel + 3]));

export class Panes {
  /**
   * @param {import("./board.js").Board} drawing
   * @param {import("./board.js").Board} result
   * @param {import("../result/predictor.js").Predictor} predictor
   * @param {import("../elements/status.js").Status} status
   */
  constructor(drawing, result, predictor, status) {
    this.drawing = drawing;
    this.result = result;
    this.predictor = predictor;
    this.status = status;
    const small = matchMedia(SMALL);
    /** @returns {Layout} */
    const usual = () => (small.matches ? "drawing" : "both");
    this.layout = usual();
    small.addEventListener("change", () => this.show(usual()));
    /** @type {number | null} fraction of the result's width covered by the drawing; null disables the comparison */
    this.divider = null;
    this.lines = false;
    /** @type {import("../result/predictor.js").Predictor["doubt"]} the uncertainty shown by the veil */
    this.doubted = null;
    for (const layout of LAYOUTS) $(`layout-${layout}`).addEventListener("click", () => this.show(layout));
    $("compare").addEventListener("click", () => this.compare());
    $("lines").addEventListener("click", () => this.overlay());
    $("doubt").addEventListener("click", () => predictor.wantDoubt(!predictor.wantsDoubt));
    predictor.addEventListener("doubt", () => this.#show());
    for (const name of ["painted", "empty"]) predictor.addEventListener(name, () => this.#showObject());
    this.tool = "";
    drawing.editor.addEventListener("state", () => {
      if (this.tool === drawing.editor.tool) return;
      this.tool = drawing.editor.tool;
      this.#showObject();
    });
    this.#followDivider($("divider"));
    this.#show();
  }

  /** @param {Layout} layout */
  show(layout) {
    this.layout = layout;
    this.#show();
  }

  /** Maximises one pane, or restores both. @param {"drawing" | "result"} pane */
  enlarge(pane) {
    this.show(this.layout === pane ? "both" : pane);
  }

  /** Toggles the comparison of drawing and result with a divider. */
  compare() {
    this.divider = this.divider === null ? 0.5 : null;
    this.#show();
    if (this.divider !== null) $("divider").focus();
  }

  /** Toggles the lines over the result. */
  overlay() {
    this.lines = !this.lines;
    this.#show();
  }

  /** Tints the object in the drawing while the mask is edited. */
  #showObject() {
    const { sheet } = this.drawing;
    const { painted } = this.predictor;
    const veil = this.drawing.editor.tool === "mask" && painted ? objectOf(painted) : null;
    if (veil) for (const board of [this.drawing, this.result]) board.redraw(); // they name the area under the pointer
    if (veil === sheet.veil) return;
    sheet.veil = veil;
    sheet.redraw();
  }

  #show() {
    const { layout, divider, lines, predictor } = this;
    /** @type {HTMLElement} */ (document.querySelector("main")).dataset.layout = layout;
    for (const each of LAYOUTS) $(`layout-${each}`).setAttribute("aria-pressed", String(each === layout));
    // Samples are offered in the visible pane.
    $(layout === "drawing" ? "empty-board" : "empty-result").append($("offer"));
    $("compare").setAttribute("aria-pressed", String(divider !== null));
    $("lines").setAttribute("aria-pressed", String(lines));
    $("doubt").setAttribute("aria-pressed", String(predictor.wantsDoubt));
    $("divider").hidden = divider === null;
    $("divider").style.left = `${100 * (divider ?? 0)}%`;
    $("divider").setAttribute("aria-valuenow", String(Math.round(100 * (divider ?? 0))));
    const { sheet } = this.result;
    // The veil is as large as the map, so it is not recomputed at each step of the divider.
    if (this.doubted !== predictor.doubt) [this.doubted, sheet.veil] = [predictor.doubt, predictor.doubt && veilOf(predictor.doubt)];
    if (predictor.wantsDoubt && predictor.unsure === false) this.status.say(text.noDoubt, "warning");
    // The user draws on a maximised result, so its lines must be visible.
    const over = { lines: lines || layout === "result", paper: false };
    sheet.parts = divider === null
      ? [{ from: 0, to: 1, ...over }]
      : [{ from: 0, to: divider, lines: true, paper: true }, { from: divider, to: 1, ...over }];
    // An imported drawing has white paper, which must not hide the map.
    sheet.canvas.classList.toggle("multiplied", divider === null);
    sheet.redraw();
  }

  /** @param {HTMLElement} handle */
  #followDivider(handle) {
    let held = false;
    const move = (/** @type {number} */ share) => {
      this.divider = Math.max(0, Math.min(1, share));
      this.#show();
    };
    handle.addEventListener("pointerdown", (event) => {
      handle.setPointerCapture(event.pointerId);
      held = true;
    });
    handle.addEventListener("pointermove", (event) => {
      if (!held) return;
      const box = /** @type {HTMLElement} */ (handle.parentElement).getBoundingClientRect();
      move((event.clientX - box.left) / box.width);
    });
    for (const end of ["pointerup", "pointercancel"]) handle.addEventListener(end, () => { held = false; });
    handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -STEP, ArrowRight: STEP }[event.key];
      if (!step || this.divider === null) return;
      event.preventDefault();
      move(this.divider + step);
    });
  }
}
