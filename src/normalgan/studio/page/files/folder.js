/** Folder: a gallery of a folder's drawings or their maps, from which they are opened. */

import { context2d } from "../drawing/canvas.js";
import { newDocument, parseDocument, picturesOf, withStroke } from "../drawing/document.js";
import { darkOnLight } from "../drawing/paper_tone.js";
import { decodeAll, free } from "../drawing/pictures.js";
import { $, make } from "../elements/dom.js";
import { recalled, remember } from "../elements/settings.js";
import { wordsOfFindings } from "../result/findings.js";
import { Away, Lacking, imported, predict } from "../server/api.js";
import { say, text } from "../text/text.js";
import { SIDE, drawDocument, drawFitted, showTiles } from "./gallery.js";
import { projectIn } from "./projects.js";

const PROJECT = ".normalgan";
const KEY = "normalgan-folder";
/** Longer side of the maps, which are sharp on screens with two pixels per CSS pixel. */
const LONGEST = 2 * SIDE;
/** @typedef {"drawings" | "maps" | "lit"} Shown what the tiles display */

/** Returns the files in a dropped folder, without those in subfolders. @param {FileSystemDirectoryEntry} folder @returns {Promise<File[]>} */
async function filesIn(folder) {
  const reader = folder.createReader();
  /** @type {File[]} */
  const files = [];
  for (;;) {
    // Chromium returns a hundred entries at a time.
    const entries = await new Promise((resolve, reject) => { reader.readEntries(resolve, reject); });
    if (!entries.length) return files;
    for (const entry of entries) if (entry.isFile) files.push(await new Promise((resolve, reject) => { entry.file(resolve, reject); }));
  }
}

export class Folder {
  /**
   * @param {import("./importing.js").Importing} importing
   * @param {import("./projects.js").Projects} projects
   * @param {import("../result/predictor.js").Predictor} predictor
   * @param {(map: import("../result/predictor.js").Painted) => Uint8ClampedArray<ArrayBuffer>} lit RGBA of a map under the user's lights
   */
  constructor(importing, projects, predictor, lit) {
    this.importing = importing;
    this.projects = projects;
    this.predictor = predictor;
    this.lit = lit;
    /** @type {File[]} */
    this.drawings = [];
    /** @type {HTMLSelectElement} */
    const shown = $("folder-shown");
    shown.value = ["drawings", "maps", "lit"].includes(recalled(KEY)) ? recalled(KEY) : "drawings";
    shown.addEventListener("change", () => {
      remember(KEY, shown.value);
      this.#fill();
    });
    this.endings = /** @type {HTMLInputElement} */ ($("import-file")).accept.split(",").filter((each) => each.startsWith("."));
    /** @type {HTMLInputElement} */
    const chosen = $("open-folder");
    // Phones cannot choose folders.
    $("open-folder-button").hidden = !("webkitdirectory" in chosen);
    $("open-folder-button").addEventListener("click", () => chosen.click());
    chosen.addEventListener("change", () => {
      const files = [...chosen.files ?? []];
      chosen.value = "";
      if (files.length) this.show(files, files[0].webkitRelativePath.split("/")[0]);
    });
  }

  /** Shows dropped files if they are a folder or several files. @param {DataTransfer} dropped @returns {boolean} */
  take(dropped) {
    const entry = dropped.items[0]?.webkitGetAsEntry?.();
    if (entry?.isDirectory) {
      filesIn(/** @type {FileSystemDirectoryEntry} */ (entry)).then((files) => this.show(files, entry.name)).catch((error) => this.projects.status.fail(error));
    } else if (dropped.files.length > 1) {
      this.show([...dropped.files], "");
    } else return false;
    return true;
  }

  /** @param {File[]} files @param {string} name of the folder; "" if there is none */
  show(files, name) {
    this.drawings = files.filter((file) => this.#kind(file)).sort((a, b) => a.name.localeCompare(b.name, undefined, { numeric: true }));
    $("folder-title").textContent = !name ? text.drawings : say(this.drawings.length ? "folderOf" : "folderNone", { name });
    $("folder").hidden = false;
    $("folder-shown").hidden = !this.drawings.length;
    /** @type {HTMLDialogElement} */
    const dialog = $("open-dialog");
    if (!dialog.open) this.projects.choose();
    this.#fill();
    $("folder").scrollIntoView({ block: "start" });
  }

  #fill() {
    const shown = /** @type {Shown} */ (/** @type {HTMLSelectElement} */ ($("folder-shown")).value);
    showTiles($("folder-list"), this.drawings.map((file) => ({
      name: file.name, key: `${shown} ${file.name} ${file.lastModified} ${file.size}`,
      draw: (canvas, note) => (shown === "drawings" ? this.#draw(file, canvas) : this.#drawMap(file, canvas, shown === "lit", note)),
      open: () => this.#open(file),
    })));
  }

  /** @param {File} file @returns {"project" | "picture" | ""} */
  #kind({ name, type }) {
    const ending = name.slice(name.lastIndexOf(".")).toLowerCase();
    if (ending === PROJECT) return "project";
    return !name.startsWith(".") && (type.startsWith("image/") || this.endings.includes(ending)) ? "picture" : "";
  }

  /** @param {File} file @param {HTMLCanvasElement} canvas */
  async #draw(file, canvas) {
    if (this.#kind(file) === "project") {
      await drawDocument(canvas, await projectIn(file));
      return;
    }
    // The server can read more formats than the browser.
    const bitmap = await createImageBitmap(file).catch(() => null);
    if (bitmap) {
      drawFitted(canvas, bitmap);
      bitmap.close();
      return;
    }
    const image = new Image();
    image.src = `data:image/png;base64,${(await imported(file)).picture}`;
    await image.decode();
    drawFitted(canvas, image);
  }

  /** Draws the map of a file. @param {File} file @param {HTMLCanvasElement} canvas @param {boolean} lit @param {(words: string) => void} note */
  async #drawMap(file, canvas, lit, note) {
    note(text.predicting);
    /** @type {string[]} */
    let fresh = [];
    try {
      let doc;
      if (this.#kind(file) === "project") {
        doc = parseDocument(await projectIn(file));
        fresh = await decodeAll(picturesOf(doc));
      } else {
        const { picture, width, height } = await imported(file);
        const url = `data:image/png;base64,${picture}`;
        fresh = await decodeAll([url]);
        const dark = await darkOnLight(url);
        fresh.push(dark);
        doc = withStroke(newDocument(width, height), { kind: "picture", picture: dark, x: 0, y: 0, width, height });
      }
      const longest = Math.min(LONGEST, Math.max(doc.width, doc.height));
      const map = await this.predictor.askAt(longest, (request) => predict(request), {}, doc);
      if (!map) throw new Error(text.busy);
      const pixels = lit ? this.lit(map) : new Uint8ClampedArray(map.rgba);
      const whole = make("canvas", { width: map.width, height: map.height });
      context2d(whole).putImageData(new ImageData(pixels, map.width), 0, 0);
      drawFitted(canvas, whole);
      note(wordsOfFindings(map.findings));
    } catch (error) {
      if (error instanceof Away) this.projects.status.fail(error);
      throw error instanceof Lacking ? new Error(wordsOfFindings(error.findings)) : error;
    } finally {
      // A drawing that is being opened may need them.
      if (canvas.closest("dialog[open]")) free(fresh);
    }
  }

  /** @param {File} file */
  #open(file) {
    /** @type {HTMLDialogElement} */
    const dialog = $("open-dialog");
    const ready = () => dialog.close();
    if (this.#kind(file) === "project") this.projects.openFile(file, ready);
    else this.importing.open(file, ready);
  }
}
