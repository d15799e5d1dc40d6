/**
 * Exporting: a dialog for exporting one file or all files for an engine, which lists the files beforehand; the result is a
 * download or goes to the clipboard.
 */

import { clear, context2d } from "../drawing/canvas.js";
import { drawnLayers } from "../drawing/document.js";
import { linesAt } from "../drawing/ink.js";
import { $, download, enable, field, make, open } from "../elements/dom.js";
import { recalled, remember } from "../elements/settings.js";
import { exported, predict } from "../server/api.js";
import { say, text, wordsOf } from "../text/text.js";
import { drawFitted } from "./gallery.js";

const KEY = "normalgan-export";
/** Longer side of a preview in pixels. */
const LOOK = 256;
/** @returns {HTMLSelectElement} */
const whatList = () => $("export-what");

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
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../result/predictor.js").Predictor} predictor
   * @param {import("../elements/status.js").Status} status
   * @param {(map: import("../result/predictor.js").Painted, clay?: boolean) => Uint8ClampedArray<ArrayBuffer>} shaded RGBA of a map
   *   as the result shows it; clay: without the colours of the drawing
   */
  constructor(editor, predictor, status, shaded) {
    this.shaded = shaded;
    this.editor = editor;
    this.predictor = predictor;
    this.status = status;
    /** @type {Record<string, string[]>} the formats of each kind of file, in the menu's order */
    this.formats = Object.fromEntries([...whatList().options].map((each) => [each.value, (each.dataset.formats ?? "").split(" ")]));
    this.offered = this.formats;
    /** Number of requested previews, so that only the latest is shown. */
    this.looks = 0;
    const everything = /** @type {HTMLOptionElement} */ (whatList().querySelector("[value=all]"));
    everything.hidden = true; // represented by the tiles of the engines
    $("export-engines").append(...["", ...this.formats.all].map((engine) => {
      const input = make("input", { type: "radio", name: "engine", value: engine });
      input.addEventListener("change", () => this.#take(engine));
      return make("label", {}, input, make("span", { text: engine ? wordsOf(engine) : text.oneFile }));
    }));
    $("export-what").addEventListener("change", () => this.#formats());
    for (const name of ["format", "y"]) $(`export-${name}`).addEventListener("change", () => this.#rows());
    $("export-name").addEventListener("input", () => this.#list());
    this.#recall();
  }

  /** Disables kinds of files that cannot be exported here. @param {Record<string, string[]>} offered formats of each kind of file */
  offer(offered) {
    this.offered = { ...offered, lit: this.formats.lit, colours: this.formats.colours }; // made by the page itself
    const what = whatList();
    for (const option of what.options) {
      option.disabled = !(option.value in this.offered);
      option.title = option.disabled ? text.needsPython : "";
    }
    if (what.selectedOptions[0]?.disabled) what.value = Object.keys(offered)[0];
    $("export-python").hidden = false;
    this.#formats();
  }

  /** Asks what to export, and downloads it or copies it to the clipboard. */
  async ask() {
    if (!drawnLayers(this.editor.doc).length) {
      this.status.say(text.exportEmpty, "warning");
      return;
    }
    const { width, height, settings } = this.editor.doc;
    field("export-name").value = settings.name || settings.file;
    field("export-name").placeholder = text.untitled.toLowerCase();
    field("export-size").placeholder = String(Math.max(width, height));
    this.#rows();
    const way = await open($("export-dialog"));
    if (!way) return;
    this.#remember();
    await this.#made(way === "copy" ? () => this.#copy() : () => this.#save(this.#request()));
  }

  /** Downloads the lit result at the drawing's own size. */
  async saveLit() {
    const { name, file } = this.editor.doc.settings;
    await this.#made(() => this.#save({ ...this.#request(), name: name || file || text.untitled.toLowerCase(), what: "lit", size: null }));
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

  /** @param {Record<string, any>} request */
  async #save(request) {
    const { blob, name } = await this.#file(request);
    download(blob, name);
    this.status.say(say("exported", { name }));
  }

  /** Copies the picture to the clipboard. */
  async #copy() {
    // A promise, so that the browser accepts it as the result of the click however long the file takes.
    const picture = this.#file(this.#request()).then(({ blob }) => new Blob([blob], { type: "image/png" }));
    picture.catch(() => {}); // errors are reported by the write
    try {
      await navigator.clipboard.write([new ClipboardItem({ "image/png": picture })]);
    } catch (error) {
      await picture;
      throw new Error(say("noClipboard", { reason: /** @type {Error} */ (error).message }));
    }
    this.status.say(text.copied);
  }

  /**
   * @param {Record<string, any>} request
   * @returns {Promise<{blob: Blob, name: string}>}
   */
  async #file(request) {
    const { doc } = this.editor;
    const own = Math.max(doc.width, doc.height);
    const longest = request.size ?? own;
    if (request.what === "lit") return { blob: await this.#lit(longest === own ? null : longest), name: `${request.name}_lit.png` };
    if (request.what === "colours") return { blob: await toPng(linesAt(doc, longest, true)), name: `${request.name}_colour.png` };
    if (request.what === "lines") return { blob: await toPng(linesAt(doc, longest)), name: `${request.name}_line.png` };
    const more = { ...request };
    if (request.what === "all") {
      more.line_art = await toBase64(await toPng(linesAt(doc, longest)));
      more.colours = await toBase64(await toPng(linesAt(doc, longest, true)));
      more.lit_picture = await toBase64(await this.#lit(longest === own ? null : longest));
    }
    // At its own size, the file is made from the same pixels as the current map.
    return longest === own ? this.predictor.ask(exported, more) : this.predictor.askAt(longest, exported, more);
  }

  /** Returns a PNG of the result as currently lit. @param {number | null} longest longer side; null keeps the drawing's @returns {Promise<Blob>} */
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

  #request() {
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
    const { what, format, y, alpha, size } = this.#request();
    remember(KEY, { what, format, y, alpha, size });
  }

  /** Restores the last choice. */
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
    // For all files, each format is an engine.
    $("export-format").replaceChildren(...this.formats[what].map((format) => make("option", { value: format, text: words(format), disabled: !has(format) })));
    this.#rows();
  }

  /** Selects an engine, or a single file. @param {string} engine */
  #take(engine) {
    whatList().value = engine ? "all" : "map";
    this.#formats();
    if (engine) field("export-format").value = engine;
    this.#rows();
  }

  /** Shows only the options of the kind of file, and the files that will be written. */
  #rows() {
    const what = whatList().value;
    const all = what === "all";
    for (const input of /** @type {NodeListOf<HTMLInputElement>} */ ($("export-engines").querySelectorAll("input"))) {
      input.checked = input.value === (all ? field("export-format").value : "");
      input.toggleAttribute("autofocus", input.checked); // otherwise the dialog focuses the first one, which then looks chosen too
      input.disabled = input.value !== "" && !this.offered.all?.includes(input.value);
    }
    $("export-what-row").hidden = $("export-format-row").hidden = all;
    $("export-y-row").hidden = what !== "map";
    $("export-alpha-row").hidden = what !== "map";
    enable("export-copy", ["png8", "png"].includes(field("export-format").value));
    this.#list();
    this.#preview().catch(() => {}); // the export itself reports errors
  }

  /** Lists the files that will be written. */
  #list() {
    const { name, what, format } = this.#request();
    /** @type {Record<string, string[]>} */
    const files = JSON.parse(whatList().selectedOptions[0].dataset.files ?? "{}");
    const names = (files[format] ?? []).map((each) => each.replace("{}", name));
    const one = names.length === 1;
    $("export-archive").textContent = one ? names[0] : say("archive", { name: `${name}_${what === "all" ? format : what}.zip`, count: names.length });
    $("export-files").replaceChildren(...(one ? [] : names.map((each) => make("li", { text: each }))));
  }

  /** Shows a preview of the export. */
  async #preview() {
    const look = ++this.looks;
    const { what, format, y } = this.#request();
    const { painted } = this.predictor;
    const down = what === "all" ? ($("export-engines").dataset.down ?? "").split(" ").includes(format) : y === "down";
    /** @type {HTMLCanvasElement | ImageBitmap | null} */
    let picture = null;
    if (["lines", "colours"].includes(what)) picture = linesAt(this.editor.doc, LOOK, what === "colours");
    else if (what === "relief") picture = painted && canvasOf(painted, this.shaded(painted, true), false); // the mesh has no colours
    else if (["map", "all"].includes(what) || !this.offered[what]?.includes("png")) picture = painted && canvasOf(painted, painted.rgba, down);
    else if (what === "lit") picture = painted && canvasOf(painted, this.shaded(painted), false);
    else {
      const { blob } = await this.predictor.askAt(LOOK, exported, { name: "look", what, format: "png" });
      picture = await createImageBitmap(blob);
    }
    if (look !== this.looks) return;
    /** @type {HTMLCanvasElement} */
    const canvas = $("export-picture");
    canvas.classList.toggle("paper", what === "lines");
    clear(context2d(canvas));
    if (picture) drawFitted(canvas, picture);
  }
}

/** @param {import("../result/predictor.js").Painted} map @param {Uint8ClampedArray | Uint8Array} rgba @param {boolean} down whether green is flipped */
function canvasOf({ width, height }, rgba, down) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const image = new ImageData(new Uint8ClampedArray(rgba), width);
  if (down) for (let i = 1; i < image.data.length; i += 4) image.data[i] = 255 - image.data[i];
  context2d(canvas).putImageData(image, 0, 0);
  return canvas;
}
