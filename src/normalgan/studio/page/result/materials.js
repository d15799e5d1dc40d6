/** Materials: show the lit result as clay or in the drawing's own colours. */

import { context2d } from "../drawing/canvas.js";
import { paintsAlike } from "../drawing/document.js";
import { linesAt } from "../drawing/ink.js";
import { $ } from "../elements/dom.js";
import { recalled, remember } from "../elements/settings.js";

const KEY = "normalgan-material";
/** @type {("clay" | "colours")[]} */
const MATERIALS = ["clay", "colours"];
/** Views that show a material. */
const SHOWN = ["lit", "relief"];

export class Materials {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("./predictor.js").Predictor} predictor
   * @param {import("./result.js").Result} result
   */
  constructor(editor, predictor, result) {
    this.editor = editor;
    this.predictor = predictor;
    this.result = result;
    const before = recalled(KEY);
    /** @type {"clay" | "colours"} */
    this.chosen = MATERIALS.includes(before) ? before : "clay";
    /** @type {import("../drawing/document.js").Doc | null} the document whose colours the result shows */
    this.coloured = null;
    for (const each of MATERIALS) $(`material-${each}`).addEventListener("click", () => this.choose(each));
    predictor.addEventListener("painted", () => this.#colour());
    // A fill changes the colours, but not the map.
    editor.addEventListener("change", (event) => {
      const { coloured } = this;
      if (coloured && coloured.layers !== editor.doc.layers && !/** @type {CustomEvent} */ (event).detail.live && paintsAlike(coloured, editor.doc)) this.#colour();
    });
    predictor.addEventListener("empty", () => this.#show());
    let { tool } = editor;
    /** The tool used before the light tool, which its button restores. */
    let beforeLight = tool;
    editor.addEventListener("state", () => {
      if (editor.tool === tool) return;
      if (editor.tool === "light") beforeLight = tool;
      ({ tool } = editor);
      this.#show();
    });
    $("lamp-more").addEventListener("click", () => editor.set({ tool: tool === "light" ? beforeLight : "light" }));
    result.addEventListener("view", () => this.#show());
    this.#show();
  }

  /** @param {"clay" | "colours"} material */
  choose(material) {
    this.chosen = material;
    remember(KEY, material);
    this.#colour();
  }

  /**
   * Returns the drawing's colours, if the result shows them.
   * @param {number} longest longer side in pixels
   * @returns {import("./viewer.js").Picture | null}
   */
  colours(longest) {
    if (this.chosen === "clay") return null;
    const canvas = linesAt(this.editor.doc, longest, true);
    const { width, height } = canvas;
    const { data } = context2d(canvas).getImageData(0, 0, width, height);
    return { rgba: new Uint8Array(data.buffer), width, height };
  }

  #colour() {
    const { painted } = this.predictor;
    this.coloured = this.editor.doc;
    this.result.viewer.setColours(painted && this.colours(Math.max(painted.width, painted.height)));
    this.#show();
  }

  #show() {
    const { view } = this.result;
    for (const each of MATERIALS) $(`material-${each}`).setAttribute("aria-pressed", String(each === this.chosen));
    $("lamp-more").setAttribute("aria-pressed", String(this.editor.tool === "light"));
    $("materials").hidden = !SHOWN.includes(view);
    $("lamp").hidden = !this.predictor.painted || (view === "map" && this.editor.tool !== "light");
  }
}
