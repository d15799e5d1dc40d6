/** Importing: open a picture as the drawing, as layers, or as a reference picture. */

import { MOST_LAYERS, MOST_PICTURES, activeLayer, isEmpty, withLayers, withNewLayer, withPictures, withSettings, withStroke } from "../drawing/document.js";
import { darkOnLight } from "../drawing/paper_tone.js";
import { decodeAll } from "../drawing/pictures.js";
import { choose } from "../elements/dialogs.js";
import { $, make } from "../elements/dom.js";
import { Refused, imported, importedLayers } from "../server/api.js";
import { say, text } from "../text/text.js";

/** @typedef {"" | "drawing" | "layers" | "traced"} Way how a picture is imported; "" asks the user */

/**
 * @typedef {{picture: string, width: number, height: number, given: [number, number], parts: number, pages: boolean,
 *   notes: import("../server/api.js").LayerNote[], layers: (() => Promise<import("../server/api.js").ImportedLayers>) | null}} Found layers: reads the layers; null if there are none
 */

const TRACED = 0.5;

/** @param {{picture: string}} found */
const urlOf = ({ picture }) => `data:image/png;base64,${picture}`;

/** Returns the name of a file without its ending and characters that are invalid in project names. @param {string} file */
const plainName = (file) => file.replace(/\.[^.]*$/, "").replace(/[^\p{L}\p{M}\p{N}_-]+/gu, " ").trim();

export class Importing {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../board/camera.js").View} view
   * @param {import("../elements/status.js").Status} status
   * @param {import("./projects.js").Projects} projects
   */
  constructor(editor, view, status, projects) {
    this.editor = editor;
    this.view = view;
    this.status = status;
    this.projects = projects;
    /** @type {Way} */
    this.as = "";
    /** Handles dropped files if they are a folder or several files. @type {(dropped: DataTransfer) => boolean} */
    this.onSeveral = () => false;
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
      this.#dropped(event.dataTransfer);
    });
    addEventListener("paste", (event) => this.#dropped(event.clipboardData));
  }

  /** Lets the user choose a file. @param {Way} as */
  pick(as = "") {
    this.as = as;
    $("import-file").click();
  }

  /** @param {DataTransfer | null} dropped or pasted */
  #dropped(dropped) {
    if (!dropped || this.onSeveral(dropped)) return;
    const [file] = dropped.files;
    if (!file || document.querySelector("dialog[open]")) return;
    if (file.name.endsWith(".normalgan")) this.projects.openFile(file);
    else this.take(file, "");
  }

  /** Imports a file. @param {File} file @param {Way} as */
  async take(file, as) {
    this.status.say(say("importing", { name: file.name }));
    try {
      await this.put(await this.read(file), as, file);
    } catch (error) {
      this.#failed(error, file.name);
    }
  }

  /** @param {File} file @returns {Promise<Found>} its first page or frame */
  async read(file) {
    const { layered, ...picture } = await imported(file);
    return { ...picture, layers: layered ? () => importedLayers(file) : null };
  }

  /** Returns a picture as a data URL, its first page or frame; null after announcing an error. @param {File} file */
  async pictureOf(file) {
    try {
      return urlOf(await this.read(file));
    } catch (error) {
      this.#failed(error, file.name);
      return null;
    }
  }

  /** Imports a file into the document, asking for anything that is not specified. @param {Found} first its first page or frame @param {Way} as @param {File} file */
  async put(first, as, file) {
    const found = await this.#chosen(first, as, file);
    if (found) await this.#place(found.picture, found.way, file.name, found.part);
  }

  /**
   * Asks how a file is imported, and which page or frame.
   * @param {Found} picture its first one @param {Way} as @param {File} file
   * @returns {Promise<{picture: Found, way: Way, part: number} | null>} null if the user cancels
   */
  async #chosen(picture, as, file) {
    let chosen = { picture, way: as, part: 1 };
    if (!(picture.parts > 1) || as) return chosen; // without a server, they cannot be counted
    const input = make("input", { type: "number", min: "1", max: String(picture.parts), value: "1" });
    const preview = make("img", { src: urlOf(picture), alt: "", class: "thumbnail" });
    let asked = Promise.resolve();
    input.addEventListener("change", () => {
      const part = input.checkValidity() ? input.valueAsNumber : 1;
      input.value = String(part);
      asked = imported(file, part).then((other) => {
        chosen = { ...chosen, picture: { ...other, layers: picture.layers }, part };
        preview.src = urlOf(chosen.picture);
      });
      asked.catch((error) => this.#failed(error, file.name));
    });
    const row = make("label", { class: "wide" }, make("span", { text: say(picture.pages ? "pageOf" : "frameOf", { count: picture.parts }) }), input);
    const way = /** @type {Way} */ (await this.#ask(make("div", {}, preview, row), picture.layers !== null));
    await asked;
    return way ? { ...chosen, way } : null;
  }

  /** Opens a picture as a new drawing. @param {File} file @param {() => void} [ready] called once it is read */
  async open(file, ready = () => {}) {
    try {
      const picture = await this.read(file);
      ready();
      if (!(await this.projects.mayLeave())) return;
      this.projects.create(picture.width, picture.height);
      await this.#place(picture, "drawing", file.name);
    } catch (error) {
      this.#failed(error, file.name);
    }
  }

  /**
   * Adds a picture, or the layers of its file, to the document, and announces it.
   * @param {Found} found @param {Way} as @param {string} name @param {number} [part] which of its pages or frames it is
   */
  async #place(found, as, name, part = 1) {
    const { width, height, given, parts, pages, notes, layers } = found;
    const url = urlOf(found);
    await decodeAll([url]);
    const way = as || (await this.#ask(make("img", { src: url, alt: "", class: "thumbnail" }), layers !== null));
    if (!way) return;
    const fresh = isEmpty(this.editor.doc);
    /** @param {import("../drawing/document.js").Doc} doc */
    const named = (doc) => (fresh ? withSettings(doc, { file: plainName(name) }) : doc);
    let said = say("imported", { name });
    /** @type {string[]} */
    let lost = [];
    if (way === "layers" && layers) {
      const read = await layers();
      said = await this.#placeLayers(read, fresh, name);
      lost = notesOf(read.notes);
    } else {
      lost = notesOf(notes.filter(({ reason }) => reason !== "frame")); // the frame is announced anyway
      if (parts > 1) said = `${said} ${say(pages ? "importedPage" : "importedFrame", { number: part, count: parts })}`;
      const doc = fresh ? { ...this.editor.doc, width, height } : this.editor.doc;
      const placed = within(doc, width, height)({ x: 0, y: 0, width, height });
      if (way === "traced") {
        if (doc.pictures.length >= MOST_PICTURES) throw new Error(say("tooManyPictures", { most: MOST_PICTURES }));
        this.editor.commit(named(withPictures(doc, [...doc.pictures, { picture: url, ...placed, opacity: TRACED, visible: true }])));
      } else {
        // On a layer with lines, its paper would cover them, and their points would apply to it.
        const apart = activeLayer(doc).strokes.length > 0 && doc.layers.length < MOST_LAYERS;
        const onto = apart ? withNewLayer(doc) : doc;
        const drawn = await darkOnLight(url);
        this.editor.commit(named(withStroke(onto, { kind: "picture", picture: drawn, ...placed })));
        if (drawn !== url) said = `${said} ${text.importedTurned}`;
        if (apart) said = `${said} ${say("layerWorked", { name: this.editor.layer.name })}`;
      }
    }
    if (fresh) this.view.fit();
    const smaller = given[0] !== width || given[1] !== height;
    const [from, to] = [given, [width, height]].map(([x, y]) => say("pixels", { width: x, height: y }));
    this.status.say([said, ...(smaller ? [say("importedSmaller", { from, to })] : []), ...lost].join(" "), lost.length ? "loss" : "");
  }

  /**
   * Adds layers in front of the existing ones, or replaces the layers of an empty document.
   * @param {import("../server/api.js").ImportedLayers} found @param {boolean} fresh @param {string} name
   * @returns {Promise<string>} message about the result
   */
  async #placeLayers({ layers, plain, frames, width, height }, fresh, name) {
    const doc = fresh ? { ...this.editor.doc, width, height } : this.editor.doc;
    const room = MOST_LAYERS - (fresh ? 0 : doc.layers.length);
    if (layers.length > room) throw new Error(say("tooManyLayers", { name, count: layers.length, most: MOST_LAYERS, room }));
    const place = within(doc, width, height);
    const drawn = await Promise.all(layers.map(async ({ name: given, opacity, picture, ...box }) => {
      const url = `data:image/png;base64,${picture}`;
      await decodeAll([url]);
      // An opaque sheet may be light on dark and needs inverting; a dark part of a figure does not.
      const whole = box.width === width && box.height === height;
      /** @type {import("../drawing/document.js").Placed} */
      const stroke = { kind: "picture", picture: await darkOnLight(url, whole), ...place(box) };
      return { name: given, visible: opacity > 0, strokes: [stroke] };
    }));
    const whole = withLayers(doc, drawn, fresh);
    this.editor.commit(fresh ? withSettings(whole, { file: plainName(name) }) : whole);
    return [
      say(layers.length === 1 ? "importedLayer" : "importedLayers", { name, count: layers.length }),
      ...(plain.length ? [say("importedPlain", { names: quoted(plain) })] : []),
      ...(frames > 1 ? [say("importedFrame", { number: 1, count: frames })] : []),
    ].join(" ");
  }

  /** Announces why a file was not imported. @param {unknown} error @param {string} name */
  #failed(error, name) {
    if (error instanceof Refused) this.status.fail(new Error(say("badImport", { name, reason: error.message })));
    else this.status.fail(error);
  }

  /** @param {Node} preview @param {boolean} layered @returns {Promise<string>} a way, or "" */
  #ask(preview, layered) {
    this.status.say(""); // it is read
    const ways = [
      { value: "traced", text: text.asTraced },
      { value: "drawing", text: layered ? text.asOne : text.asDrawing, strong: !layered },
      ...(layered ? [{ value: "layers", text: text.asLayers, strong: true }] : []),
    ];
    return choose(text.importAs, layered ? `${text.importHelp} ${text.layersHelp}` : text.importHelp, ways, preview);
  }
}

/** @param {string[]} names */
const quoted = (names) => [...new Set(names)].map((each) => `“${each}”`).join(", ");

/** Returns messages about layers that look different from the program that wrote the file. @param {import("../server/api.js").LayerNote[]} notes @returns {string[]} */
function notesOf(notes) {
  /** @type {Record<string, keyof typeof text>} */
  const words = { damaged: "importedDamaged", no_pixels: "importedNoPixels", foreign: "importedForeign", effect: "importedEffect", frame: "importedStill" };
  return Object.entries(words).flatMap(([reason, key]) => {
    const names = notes.filter((each) => each.reason === reason).map(({ name }) => name);
    return names.length ? [say(key, { names: quoted(names) })] : [];
  });
}

/**
 * Returns a function that places a part of a picture that is centred in a document and scaled to fit.
 * @param {import("../drawing/document.js").Doc} doc @param {number} width of the picture @param {number} height
 */
function within(doc, width, height) {
  const scale = Math.min(doc.width / width, doc.height / height);
  const [left, top] = [(doc.width - width * scale) / 2, (doc.height - height * scale) / 2];
  /** @param {{x: number, y: number, width: number, height: number}} box */
  return (box) => ({ x: left + box.x * scale, y: top + box.y * scale, width: box.width * scale, height: box.height * scale });
}
