/** Importing: a picture becomes the drawing, or a layer to trace over. */

import { Refused, imported } from "./api.js";
import { choose } from "./dialogs.js";
import { MOST_PICTURES, isEmpty, withPictures, withStroke } from "./document.js";
import { $, make } from "./dom.js";
import { darkOnLight, decodeAll } from "./pictures.js";
import { say, text } from "./text.js";

const TRACED = 0.5;

export class Importing {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {import("./camera.js").View} view
   * @param {import("./status.js").Status} status
   * @param {import("./projects.js").Projects} projects
   */
  constructor(editor, view, status, projects) {
    this.editor = editor;
    this.view = view;
    this.status = status;
    this.projects = projects;
    /** @type {"" | "drawing" | "traced"} */
    this.as = "";
    /** @type {HTMLInputElement} */
    const chosen = $("import-file");
    chosen.addEventListener("change", () => {
      const [file] = chosen.files ?? [];
      chosen.value = "";
      if (file) this.take(file, this.as);
    });
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      this.#dropped(event.dataTransfer?.files[0]);
    });
    addEventListener("paste", (event) => this.#dropped(event.clipboardData?.files[0]));
  }

  /** Lets the user choose a file. @param {"" | "drawing" | "traced"} as "" asks */
  pick(as = "") {
    this.as = as;
    $("import-file").click();
  }

  /** @param {File | undefined} file */
  #dropped(file) {
    if (!file || document.querySelector("dialog[open]")) return;
    if (file.name.endsWith(".normalgan")) this.projects.openFile(file);
    else this.take(file, "");
  }

  /** Imports a file. @param {File} file @param {"" | "drawing" | "traced"} as */
  async take(file, as) {
    try {
      const { picture, width, height, given } = await imported(file);
      if (!(await this.place(`data:image/png;base64,${picture}`, width, height, as, file.name))) return;
      if (given[0] === width && given[1] === height) return;
      const [from, to] = [given, [width, height]].map(([x, y]) => say("pixels", { width: x, height: y }));
      this.status.say(say("importedSmaller", { name: file.name, from, to }));
    } catch (error) {
      if (error instanceof Refused) this.status.fail(new Error(say("badImport", { name: file.name, reason: error.message })));
      else this.status.fail(error);
    }
  }

  /**
   * Puts a picture into the document.
   * @param {string} url @param {number} width @param {number} height @param {"" | "drawing" | "traced"} as @param {string} name
   * @returns {Promise<boolean>} whether it was not cancelled
   */
  async place(url, width, height, as, name) {
    await decodeAll([url]);
    const way = as || (await this.#ask(url));
    if (!way) return false;
    const fresh = isEmpty(this.editor.doc);
    const doc = fresh ? shaped(this.editor.doc, width, height) : this.editor.doc;
    const scale = Math.min(doc.width / width, doc.height / height);
    const size = { width: width * scale, height: height * scale };
    const placed = { x: (doc.width - size.width) / 2, y: (doc.height - size.height) / 2, ...size };
    if (way === "traced") {
      if (doc.pictures.length >= MOST_PICTURES) throw new Error(text.tooManyPictures);
      this.editor.commit(withPictures(doc, [...doc.pictures, { picture: url, ...placed, opacity: TRACED, visible: true }]));
    } else {
      const picture = await darkOnLight(url);
      this.editor.commit(withStroke(doc, { kind: "picture", picture, ...placed }));
    }
    if (fresh) this.view.fit();
    this.status.say(say("imported", { name }));
    return true;
  }

  /** @param {string} url */
  #ask(url) {
    const preview = make("img", { src: url, alt: "", class: "thumbnail" });
    const ways = [{ value: "traced", text: text.asTraced }, { value: "drawing", text: text.asDrawing, strong: true }];
    return choose(text.importAs, text.importHelp, ways, preview);
  }
}

/**
 * Returns an empty document in the shape of a picture.
 * @param {import("./document.js").Doc} doc @param {number} width @param {number} height
 */
function shaped(doc, width, height) {
  return { ...doc, width, height };
}
