/** Projects: saved on the server, opened again, or kept as files. */

import { isEmpty, newDocument, parseDocument, picturesOf, withSettings } from "../drawing/document.js";
import { decodeAll, keepOnly } from "../drawing/pictures.js";
import { pastOf, savedSteps } from "../drawing/steps.js";
import { askName, choose } from "../elements/dialogs.js";
import { $, download } from "../elements/dom.js";
import { tabRecalls, tabRemembers } from "../elements/settings.js";
import { toast } from "../elements/toast.js";
import { Away, Refused, isGone, projects } from "../server/api.js";
import { say, text } from "../text/text.js";
import { drawDocument, showTiles } from "./gallery.js";

const CONFLICT = 412;
const ENDING = ".normalgan";
/** What the tab remembers: the project that it shows as the server has it. */
const SHOWN = "normalgan-project";

/** Returns what the JSON of a project's file holds; null, which is no project, if it is damaged. @param {File} file @returns {Promise<unknown>} */
export const projectIn = (file) => file.text().then(JSON.parse).catch(() => null);

export class Projects {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("./autosave.js").Autosave} autosave
   * @param {import("../elements/status.js").Status} status
   */
  constructor(editor, autosave, status) {
    this.editor = editor;
    this.autosave = autosave;
    this.status = status;
    /** @type {import("../drawing/document.js").Doc | null} what may be left: saved, empty, or given up when that was asked */
    this.left = null;
    /** The name under which this drawing could not be saved yet: nobody types it twice. */
    this.tried = "";
    /** @type {{doc: import("../drawing/document.js").Doc, etag: string | null, past: import("../drawing/steps.js").Past} | null} what was given up now */
    this.discarded = null;
    $("open-file").addEventListener("change", () => this.#openFile());
    $("open-file-button").addEventListener("click", () => $("open-file").click());
    $("download-project").addEventListener("click", () => this.download());
  }

  get name() {
    return this.editor.doc.settings.name;
  }

  /** What the server called the state that this tab has seen; null: none yet. @returns {string | null} */
  get etag() {
    return this.autosave.etag;
  }

  set etag(etag) {
    this.autosave.etag = etag;
  }

  /** Saves under the project's name, or asks for one. @returns {Promise<boolean>} whether it was saved */
  async save() {
    return this.name ? this.#write(this.name, this.etag) : this.saveAs();
  }

  /** Asks for a name and saves. @returns {Promise<boolean>} */
  async saveAs() {
    const name = await askName(this.name || this.tried || this.editor.doc.settings.file);
    if (!name) return false;
    this.tried = name;
    return this.#write(name, name === this.name ? this.etag : null);
  }

  /** @param {string} name @param {string | null} etag @returns {Promise<boolean>} whether it was saved */
  async #write(name, etag) {
    const { editor } = this;
    const doc = withSettings(editor.history.state, { name });
    try {
      this.etag = await projects.write(name, { ...doc, history: savedSteps(doc, editor.history) }, etag);
    } catch (error) {
      if (error instanceof Refused && error.status === CONFLICT) return this.#conflict(name, etag);
      this.status.fail(error);
      return false;
    }
    this.#remember(name);
    // What was drawn while it was being saved stays unsaved.
    const now = editor.history.state;
    const unchanged = now.layers === doc.layers && now.pictures === doc.pictures && now.width === doc.width && now.height === doc.height;
    const named = unchanged ? doc : withSettings(editor.history.state, { name });
    // No step either: what is undone is of that project.
    editor.history.states = editor.history.states.map((state) => withSettings(state, { name }));
    editor.history.replace(named);
    editor.dispatchEvent(new CustomEvent("state"));
    if (unchanged) await this.autosave.settle(doc);
    this.status.say(say("saved", { name }));
    return true;
  }

  /** @param {string} name @param {string | null} etag @returns {Promise<boolean>} whether it was saved */
  async #conflict(name, etag) {
    // Where another tab has deleted it there is nothing to overwrite.
    const gone = etag !== null && (await projects.read(name).then(() => false, isGone));
    if (gone) return this.#write(name, null);
    const ways = [{ value: "overwrite", text: text.overwrite }, { value: "copy", text: text.copy, strong: true }];
    const way = await choose(etag ? text.conflictTitle : text.takenTitle, say(etag ? "conflict" : "taken", { name }), ways);
    if (way === "copy") return this.saveAs();
    if (way !== "overwrite") return false;
    const now = await projects.read(name).catch(() => ({ etag: null }));
    return this.#write(name, now.etag);
  }

  /** Asks what to do with unsaved work. @returns {Promise<boolean>} whether to go on */
  async mayLeave() {
    this.discarded = null;
    if (this.autosave.unsaved && !isEmpty(this.editor.doc)) {
      const ways = [{ value: "drop", text: text.discard }, { value: "save", text: text.save, strong: true }];
      const way = await choose(text.leaveTitle, text.leave, ways);
      if (way !== "drop" && !(way === "save" && (await this.save()))) return false;
      const { history } = this.editor;
      if (way === "drop") this.discarded = { doc: history.state, etag: this.etag, past: { states: [...history.states], at: history.at } };
    }
    this.left = this.editor.history.state;
    return true;
  }

  /** Starts an empty drawing. @param {number} width @param {number} height */
  create(width, height) {
    this.#show(newDocument(width, height), null);
  }

  /**
   * Shows a document that came from somewhere.
   * @param {unknown} value
   * @param {string | null} etag null: it is not the project of that name as the server has it
   * @param {boolean} saved whether it need not be kept
   * @param {import("../drawing/steps.js").Past | null} past the steps that led to it; by default those that a project keeps
   * @returns {Promise<boolean>} whether it is shown: what was drawn while it came may be kept instead
   */
  async load(value, etag = null, saved = true, past = null) {
    const doc = parseDocument(value);
    const found = past ?? pastOf(doc, /** @type {any} */ (value).history, parseDocument);
    // A project's name is no step: whatever is undone, it is that project.
    const before = found && { ...found, states: found.states.map((state) => withSettings(state, { name: doc.settings.name })) };
    const pictures = [...new Set([doc, ...(before?.states ?? [])].flatMap(picturesOf))];
    await decodeAll(pictures);
    if (this.editor.history.state !== this.left && !(await this.mayLeave())) return false;
    // The very document of the history, by which others see what in it is the same as in the step before.
    this.#show(before ? before.states[before.at] : doc, etag, saved, before);
    return true;
  }

  /**
   * @param {import("../drawing/document.js").Doc} doc
   * @param {string | null} etag
   * @param {boolean} [saved]
   * @param {import("../drawing/steps.js").Past | null} [past]
   */
  #show(doc, etag, saved = true, past = null) {
    this.etag = etag;
    this.tried = "";
    this.#remember(etag === null ? null : doc.settings.name);
    if (saved) this.autosave.clean = doc;
    this.editor.open(doc, past);
    keepOnly([doc, ...(past?.states ?? [])].flatMap(picturesOf)); // the history of the document before has gone
    const { discarded } = this;
    this.discarded = null;
    if (discarded) {
      const undo = () => { this.load(discarded.doc, discarded.etag, false, discarded.past).catch((error) => this.status.fail(error)); };
      toast(say("discarded", { name: discarded.doc.settings.name || text.untitled }), [{ text: text.undoIt, act: undo }]);
    }
    if (saved) this.autosave.settle(doc).catch((error) => this.status.fail(error));
  }

  /** Shows the projects to choose from. */
  async choose() {
    /** @type {HTMLDialogElement} */
    const dialog = $("open-dialog");
    if (!dialog.open) dialog.showModal();
    $("open-none").hidden = true; // not known yet
    /** @type {{name: string, changed: string}[]} */
    let rows = [];
    let none = text.openNone;
    try {
      rows = await projects.list();
    } catch (error) {
      if (error instanceof Away) this.status.fail(error);
      none = error instanceof Away ? text.offline : text.listFailed;
    }
    $("open-none").textContent = none;
    $("open-none").hidden = rows.length > 0;
    showTiles($("project-list"), rows.map(({ name, changed }) => ({
      name, key: `${name} ${changed}`, note: new Date(changed).toLocaleString([], { dateStyle: "medium", timeStyle: "short" }),
      draw: async (canvas) => drawDocument(canvas, (await projects.read(name)).doc),
      open: () => {
        dialog.close(); // one may draw while it comes
        this.open(name);
      },
      remove: { words: say("deleteProject", { name }), act: () => this.#remove(name) },
    })));
  }

  /** Opens a project of the server. @param {string} name */
  async open(name) {
    if (!(await this.mayLeave())) return;
    try {
      const { doc, etag } = await projects.read(name);
      const shown = await this.load({ ...doc, settings: { ...doc.settings, name } }, etag);
      if (shown) this.status.say(say("opened", { name }));
    } catch (error) {
      this.status.fail(error);
    }
  }

  /** Opens the project that this tab showed before the page was loaded again, if any; it may be gone by now. */
  async reopen() {
    const name = tabRecalls(SHOWN);
    if (name === null) return;
    this.#remember(null);
    await this.open(name);
  }

  /** @param {string | null} name of the project that this tab shows; null: it shows none */
  #remember(name) {
    tabRemembers(SHOWN, name);
  }

  /** @param {string} name */
  async #remove(name) {
    const way = await choose(text.delete, say("reallyDelete", { name }), [{ value: "delete", text: text.delete }]);
    if (way !== "delete") return;
    try {
      const { etag } = await projects.read(name);
      await projects.remove(name, etag);
      if (name === this.name) {
        this.etag = null;
        this.#remember(null);
      }
    } catch (error) {
      this.status.fail(error);
    }
    await this.choose();
  }

  async #openFile() {
    /** @type {HTMLInputElement} */
    const chosen = $("open-file");
    const [file] = chosen.files ?? [];
    chosen.value = "";
    if (!file) return;
    /** @type {HTMLDialogElement} */ ($("open-dialog")).close();
    await this.openFile(file);
  }

  /** Opens a project that was kept as a file. @param {File} file @param {() => void} [ready] called once it is read */
  async openFile(file, ready = () => {}) {
    if (!(await this.mayLeave())) return;
    try {
      const value = await projectIn(file);
      parseDocument(value);
      ready();
      if (await this.load(value, null, false)) this.status.say(say("opened", { name: file.name }));
    } catch (error) {
      this.status.fail(error);
    }
  }

  /** Gives the project as a file. */
  download() {
    const { history } = this.editor;
    const doc = { ...history.state, history: savedSteps(history.state, history) };
    download(new Blob([JSON.stringify(doc)], { type: "application/json" }), `${this.name || text.untitled}${ENDING}`);
  }
}
