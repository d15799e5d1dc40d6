/** Exporting: the dialog that asks for a file, and the file. */

import { exported } from "./api.js";
import { $, download, make, open } from "./dom.js";
import { say, text, wordsOf } from "./text.js";

/** @type {Record<string, string[]>} */
const FORMATS = {
  map: ["png8", "png16", "exr", "tiff"],
  preview: ["png", "gif"],
  height: ["png", "tiff"],
  relief: ["glb", "obj"],
};

export class Exporting {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {import("./painter.js").Painter} painter
   * @param {import("./status.js").Status} status
   */
  constructor(editor, painter, status) {
    this.editor = editor;
    this.painter = painter;
    this.status = status;
    $("export-what").addEventListener("change", () => this.#formats());
    this.#formats();
  }

  /** Asks what to export, and hands it to the browser's downloads. */
  async ask() {
    if (!this.editor.doc.strokes.length) {
      this.status.say(text.exportEmpty);
      return;
    }
    /** @type {HTMLInputElement} */ ($("export-name")).value = this.editor.doc.settings.name;
    if (!(await open($("export-dialog")))) return;
    this.status.say(text.exporting);
    try {
      const { blob, name } = await this.painter.ask(exported, this.#wish());
      download(blob, name);
      this.status.say(say("exported", { name }));
    } catch (error) {
      this.status.fail(error);
    }
  }

  #wish() {
    const value = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ ($(`export-${id}`)).value;
    return {
      name: value("name").trim() || text.untitled.toLowerCase(),
      what: value("what"),
      format: value("format"),
      y: value("y"),
      alpha: /** @type {HTMLInputElement} */ ($("export-alpha")).checked,
      size: value("size") ? Number(value("size")) : null,
    };
  }

  /** Shows only what goes with the kind of file. */
  #formats() {
    const what = /** @type {HTMLSelectElement} */ ($("export-what")).value;
    $("export-format").replaceChildren(...FORMATS[what].map((format) => make("option", { value: format, text: wordsOf(what === "height" && format === "png" ? "png16" : format) })));
    $("export-y-row").hidden = what !== "map";
    $("export-alpha-row").hidden = what !== "map" && what !== "preview";
  }
}
