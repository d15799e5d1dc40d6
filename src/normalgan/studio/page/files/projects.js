/** Projects: save projects on the server, and open them from the server or from files. */

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
/** Setting of the tab with the project that it shows. */
const SHOWN = "normalgan-project";

/** Returns the JSON content of a project's file; null if it is damaged. @param {File} file @returns {Promise<unknown>} */
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
    /** @type {import("../drawing/document.js").Doc | null} the document that can be left without asking: saved, empty or discarded */
    this.left = null;
    /** The name under which saving failed, so that the user need not type it again. */
    this.tried = "";
    /** @type {{doc: import("../drawing/document.js").Doc, etag: string | null, past: import("../drawing/steps.js").Past} | null} the document that was just discarded */
    this.discarded = null;
    $("open-file").addEventListener("change", () => this.#openFile());
    $("open-file-button").addEventListener("click", () => $("open-file").click());
    $("download-project").addEventListener("click", () => this.download());
    $("project-name").title = text.renameHow;
    $("project-name").addEventListener("dblclick", () => (this.name ? this.rename(this.name) : this.saveAs()));
  }

  get name() {
    return this.editor.doc.settings.name;
  }

  /** The ETag of the project as last seen by this tab; null if there is none. @returns {string | null} */
  get etag() {
    return this.autosave.etag;
  }

  set etag(etag) {
    this.autosave.etag = etag;
  }

  /** Saves under the project's name, or asks for a name. @returns {Promise<boolean>} whether it was saved */
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
    // Changes made while saving stay unsaved.
    const now = editor.history.state;
    const unchanged = now.layers === doc.layers && now.pictures === doc.pictures && now.width === doc.width && now.height === doc.height;
    const named = unchanged ? doc : withSettings(editor.history.state, { name });
    // Not a step in history, because undone steps belong to the project too.
    editor.history.states = editor.history.states.map((state) => withSettings(state, { name }));
    editor.history.replace(named);
    editor.dispatchEvent(new CustomEvent("state"));
    if (unchanged) await this.autosave.settle(doc);
    this.status.say(say("saved", { name }));
    return true;
  }

  /** @param {string} name @param {string | null} etag @returns {Promise<boolean>} whether it was saved */
  async #conflict(name, etag) {
    // If another tab has deleted the project, there is nothing to overwrite.
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
   * Shows a loaded document.
   * @param {unknown} value
   * @param {string | null} etag null if it is not the server's version of the project
   * @param {boolean} saved whether it needs no backup
   * @param {import("../drawing/steps.js").Past | null} past its history; by default the one saved in the project
   * @returns {Promise<boolean>} whether it is shown; false if the user keeps changes made while it was loading
   */
  async load(value, etag = null, saved = true, past = null) {
    const doc = parseDocument(value);
    const found = past ?? pastOf(doc, /** @type {any} */ (value).history, parseDocument);
    // The project's name is not a step in history; undo does not change it.
    const before = found && { ...found, states: found.states.map((state) => withSettings(state, { name: doc.settings.name })) };
    const pictures = [...new Set([doc, ...(before?.states ?? [])].flatMap(picturesOf))];
    await decodeAll(pictures);
    if (this.editor.history.state !== this.left && !(await this.mayLeave())) return false;
    // The same object as in the history, so that unchanged parts are recognised.
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
    keepOnly([doc, ...(past?.states ?? [])].flatMap(picturesOf)); // the history of the previous document is gone
    const { discarded } = this;
    this.discarded = null;
    if (discarded) {
      const undo = () => { this.load(discarded.doc, discarded.etag, false, discarded.past).catch((error) => this.status.fail(error)); };
      toast(say("discarded", { name: discarded.doc.settings.name || text.untitled }), [{ text: text.undoIt, act: undo }]);
    }
    if (saved) this.autosave.settle(doc).catch((error) => this.status.fail(error));
  }

  /** Shows a dialog to choose a project. */
  async choose() {
    /** @type {HTMLDialogElement} */
    const dialog = $("open-dialog");
    if (!dialog.open) dialog.showModal();
    $("open-none").hidden = true; // the list is still loading
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
        dialog.close(); // the user may draw while it is loading
        this.open(name);
      },
      ways: [
        { icon: "pen", words: say("renameProject", { name }), act: () => this.rename(name) },
        { icon: "remove", words: say("deleteProject", { name }), act: () => this.#remove(name) },
      ],
    })));
  }

  /** Opens a project from the server. @param {string} name */
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

  /** Reopens the project that this tab showed before a reload, if it still exists. */
  async reopen() {
    const name = tabRecalls(SHOWN);
    if (name === null) return;
    this.#remember(null);
    await this.open(name);
  }

  /** @param {string | null} name of the project that this tab shows, or null */
  #remember(name) {
    tabRemembers(SHOWN, name);
  }

  /** Asks for another name of a project. @param {string} name */
  async rename(name) {
    const after = await askName(name, text.renameTitle, text.rename);
    if (after && after !== name && (await this.#move(name, after))) {
      toast(say("renamed", { before: name, name: after }), [{ text: text.undoIt, act: () => { this.#move(after, name); } }]);
    }
  }

  /** Gives a project another name; unsaved changes stay unsaved. @param {string} before @param {string} name @returns {Promise<boolean>} whether it has it */
  async #move(before, name) {
    try {
      const { doc, etag } = await projects.read(before);
      const renamed = await projects.write(name, { ...doc, settings: { ...doc.settings, name } }, null);
      await projects.remove(before, etag);
      if (before === this.name) await this.#called(name, renamed);
    } catch (error) {
      if (error instanceof Refused && error.status === CONFLICT) this.status.say(say("taken", { name }), "warning");
      else this.status.fail(error);
      return false;
    } finally {
      if ($("open-dialog").matches("[open]")) await this.choose();
    }
    return true;
  }

  /** Takes over the new name of the project that this tab shows. @param {string} name @param {string | null} etag */
  async #called(name, etag) {
    const { autosave, editor: { history } } = this;
    const { dirty } = autosave;
    this.etag = etag;
    this.#remember(name);
    // Not a step in history, as when it is saved.
    history.states = history.states.map((state) => withSettings(state, { name }));
    if (!dirty) autosave.clean = history.state;
    this.editor.dispatchEvent(new CustomEvent("state"));
    if (dirty) await autosave.secure();
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

  /** Opens a project from a file. @param {File} file @param {() => void} [ready] called once it is read */
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

  /** Downloads the project as a file. */
  download() {
    const { history } = this.editor;
    const doc = { ...history.state, history: savedSteps(history.state, history) };
    download(new Blob([JSON.stringify(doc)], { type: "application/json" }), `${this.name || text.untitled}${ENDING}`);
  }
}
