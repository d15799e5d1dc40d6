/** Exporting: the dialog that asks for a file or for all of them, and what comes of it: a download or the clipboard. */

import { exported, predict } from "./api.js";
import { context2d } from "./canvas.js";
import { drawnLayers } from "./document.js";
import { $, download, enable, field, make, open } from "./dom.js";
import { linesAt } from "./ink.js";
import { recalled, remember } from "./settings.js";
import { say, text, wordsOf } from "./text.js";

const KEY = "normalgan-export";

/** @param {HTMLCanvasElement} canvas @returns {Promise<Blob>} a PNG */
function toPng(canvas) {
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error(text.noMemory))), "image/png");
  });
}

/** @param {Blob} blob @returns {Promise<string>} base64 */
async function toBase64(blob) {
  const bytes = new Uint8Array(await blob.arrayBuffer());
  let letters = "";
  for (let at = 0; at < bytes.length; at += 32768) letters += String.fromCharCode(...bytes.subarray(at, at + 32768));
  return btoa(letters);
}

export class Exporting {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {import("./predictor.js").Predictor} predictor
   * @param {import("./status.js").Status} status
   * @param {(map: import("./predictor.js").Painted) => Uint8ClampedArray<ArrayBuffer>} shaded RGBA of a map as the result shows it
   */
  constructor(editor, predictor, status, shaded) {
    this.shaded = shaded;
    this.editor = editor;
    this.predictor = predictor;
    this.status = status;
    /** @type {Record<string, string[]>} */
    /** @type {Record<string, string[]>} the formats of each kind of file, as the menu lists them */
    this.formats = Object.fromEntries([.../** @type {HTMLSelectElement} */ ($("export-what")).options].map((each) => [each.value, (each.dataset.formats ?? "").split(" ")]));
    this.offered = this.formats;
    $("export-what").addEventListener("change", () => this.#formats());
    $("export-format").addEventListener("change", () => this.#rows());
    this.#recall();
  }

  /** Has only what can be exported here be chosen. @param {Record<string, string[]>} offered formats of each kind of file */
  offer(offered) {
    this.offered = { ...offered, lit: this.formats.lit }; // the page makes it
    /** @type {HTMLSelectElement} */
    const what = $("export-what");
    for (const option of what.options) {
      option.disabled = !(option.value in this.offered);
      option.title = option.disabled ? text.needsPython : "";
    }
    if (what.selectedOptions[0]?.disabled) what.value = Object.keys(offered)[0];
    $("export-python").hidden = false;
    this.#formats();
  }

  /** Asks what to export, and hands it to the browser's downloads or to the clipboard. */
  async ask() {
    if (!drawnLayers(this.editor.doc).length) {
      this.status.say(text.exportEmpty, "warning");
      return;
    }
    field("export-name").value = this.editor.doc.settings.name;
    const way = await open($("export-dialog"));
    if (!way) return;
    this.#remember();
    await this.#made(way === "copy" ? () => this.#copy() : () => this.#save(this.#wish()));
  }

  /** Hands the lit result to the browser's downloads, at the drawing's own size. */
  async saveLit() {
    await this.#made(() => this.#save({ ...this.#wish(), name: this.editor.doc.settings.name || text.untitled.toLowerCase(), what: "lit", size: null }));
  }

  /** @param {() => Promise<void>} make */
  async #made(make) {
    this.status.say(text.exporting);
    try {
      await make();
    } catch (error) {
      this.status.fail(error);
    }
  }

  /** @param {Record<string, any>} wish */
  async #save(wish) {
    const { blob, name } = await this.#file(wish);
    download(blob, name);
    this.status.say(say("exported", { name }));
  }

  /** Puts the picture onto the clipboard. */
  async #copy() {
    // A promise, so that the browser takes it as what was clicked for however long the file takes.
    const picture = this.#file(this.#wish()).then(({ blob }) => new Blob([blob], { type: "image/png" }));
    picture.catch(() => {}); // what goes wrong is told by the writing
    try {
      await navigator.clipboard.write([new ClipboardItem({ "image/png": picture })]);
    } catch (error) {
      await picture;
      throw new Error(say("noClipboard", { reason: /** @type {Error} */ (error).message }));
    }
    this.status.say(text.copied);
  }

  /**
   * @param {Record<string, any>} wish
   * @returns {Promise<{blob: Blob, name: string}>}
   */
  async #file(wish) {
    const { doc } = this.editor;
    const own = Math.max(doc.width, doc.height);
    const longest = wish.size ?? own;
    if (wish.what === "lit") return { blob: await this.#lit(longest === own ? null : longest), name: `${wish.name}_lit.png` };
    const more = { ...wish };
    if (["lines", "all"].includes(wish.what)) {
      const lines = await toPng(linesAt(doc, longest));
      if (wish.what === "lines") return { blob: lines, name: `${wish.name}_line.png` };
      more.line_art = await toBase64(lines);
    }
    // At its own size the file is of the very pixels that the map on show is of.
    return longest === own ? this.predictor.ask(exported, more) : this.predictor.askAt(longest, exported, more);
  }

  /** Returns the result under the light as it is seen, a PNG. @param {number | null} longest longer side; null is the drawing's own @returns {Promise<Blob>} */
  async #lit(longest) {
    const { predictor } = this;
    const shown = longest === null && predictor.whole ? predictor.painted : null;
    const map = shown ?? (longest === null ? await predictor.ask((request) => predict(request)) : await predictor.askAt(longest, (request) => predict(request), {}));
    if (!map) throw new Error(text.busy);
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [map.width, map.height];
    context2d(canvas).putImageData(new ImageData(this.shaded(map), map.width), 0, 0);
    return toPng(canvas);
  }

  #wish() {
    const value = (/** @type {string} */ id) => field(`export-${id}`).value;
    return {
      name: value("name").trim() || text.untitled.toLowerCase(),
      what: value("what"),
      format: value("format"),
      y: value("y"),
      alpha: /** @type {HTMLInputElement} */ ($("export-alpha")).checked,
      size: value("size") ? Number(value("size")) : null,
    };
  }

  #remember() {
    const { what, format, y, alpha, size } = this.#wish();
    remember(KEY, { what, format, y, alpha, size });
  }

  /** Shows what was chosen the last time. */
  #recall() {
    const before = recalled(KEY) ?? {};
    if (Object.hasOwn(this.formats, before.what)) field("export-what").value = before.what;
    this.#formats();
    if (this.formats[field("export-what").value].includes(before.format)) field("export-format").value = before.format;
    if (["up", "down"].includes(before.y)) field("export-y").value = before.y;
    if (typeof before.alpha === "boolean") field("export-alpha").checked = before.alpha;
    if (Number.isInteger(before.size)) field("export-size").value = String(before.size);
    this.#rows();
  }

  #formats() {
    const what = field("export-what").value;
    const words = (/** @type {string} */ format) => (format in text ? wordsOf(what === "height" && format === "png" ? "png16" : format) : format.toUpperCase());
    const has = (/** @type {string} */ format) => this.offered[what]?.includes(format) ?? false;
    $("export-format").replaceChildren(...this.formats[what].map((format) => make("option", { value: format, text: words(format), disabled: !has(format) })));
    this.#rows();
  }

  /** Shows only what goes with the kind of file. */
  #rows() {
    const what = field("export-what").value;
    $("export-y-row").hidden = what !== "map";
    $("export-alpha-row").hidden = what !== "map";
    $("export-all-rule").hidden = what !== "all";
    enable("export-copy", ["png8", "png"].includes(field("export-format").value));
  }
}
