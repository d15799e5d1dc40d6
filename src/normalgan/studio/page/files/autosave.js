/** Autosave: save each change to the browser's store at once, and to the server some seconds later. */

import { isEmpty } from "../drawing/document.js";
import { tabRecalls, tabRemembers } from "../elements/settings.js";
import { Away, autosaves, isGone } from "../server/api.js";
import { text } from "../text/text.js";
import { StoreFailure, forget, keep, kept } from "./store.js";

const LATER = 2500;

/** Messages for failures of the browser's store. */
const SAID = { full: text.storageFull, newer: text.storageNewer, blocked: text.storageBlocked, silent: text.storageSilent, broken: text.noStorage };

/** Returns the message for a failure of the store; other errors are returned unchanged. @param {unknown} error @returns {unknown} */
export const inWords = (error) => (error instanceof StoreFailure ? new Error(SAID[error.why]) : error);

/** Remembers across a reload whose work this tab shows: its own, until it borrows that of another. */
const WORKED = "normalgan-worked";

/** Event `failed` (detail: the error) when the browser cannot keep the work. */
export class Autosave extends EventTarget {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../server/connection.js").Connection} connection
   * @param {string} tab
   */
  constructor(editor, connection, tab) {
    super();
    this.editor = editor;
    this.connection = connection;
    this.tab = tab;
    /** @type {string | null} the project's ETag as last seen by this tab */
    this.etag = null;
    /** @type {import("../drawing/document.js").Doc | null} the document as last saved or opened, which needs no backup */
    this.clean = editor.doc;
    /** @type {Left | null} work of another tab that this tab shows; it is kept until new work has been saved */
    this.borrowed = null;
    /** Lets other tabs have the borrowed work. */
    this.release = () => {};
    this.stale = false;
    /** Number of changes of the document, which shows which copy is newer independently of the clock. */
    this.revision = 0;
    /** @type {Promise<void> | null} the current write to the browser's store */
    this.writing = null;
    /** @type {import("../drawing/document.js").Doc | null} the document in the browser's store */
    this.kept = null;
    /** Whether the browser's store was full at the last attempt to write. */
    this.full = false;
    this.timer = 0;
    /** @type {import("../drawing/document.js").Doc | null} the document on the server, as acknowledged */
    this.sent = null;
    /** Whether the server may hold work of this tab, because a request may have arrived without an answer. */
    this.there = false;
    /** @type {Promise<void>} the current or last write to the server */
    this.sending = Promise.resolve();
    editor.addEventListener("change", (event) => /** @type {CustomEvent} */ (event).detail.live || this.#changed());
    editor.addEventListener("replaced", (event) => {
      const { before, after } = /** @type {CustomEvent} */ (event).detail;
      if (this.clean === before) this.clean = after; // changing the active layer is not work that could be lost
    });
    connection.addEventListener("back", () => this.flush());
    addEventListener("pagehide", () => this.flush());
  }

  /** Returns the tab whose work was shown here before the page was reloaded; null if it was not. From now on it is this page's. */
  previousTab() {
    const before = tabRecalls(WORKED);
    tabRemembers(WORKED, this.tab);
    return before;
  }

  get dirty() {
    return this.editor.history.state !== this.clean;
  }

  /** Whether the current work is not saved in a project. */
  get unsaved() {
    return this.dirty || this.borrowed !== null;
  }

  /** Marks the current document as work left by another tab. @param {Left} left @param {() => void} release lets other tabs have it */
  borrow(left, release) {
    this.borrowed = left;
    tabRemembers(WORKED, left.tab);
    this.release = release;
    this.clean = this.editor.history.state;
  }

  /** Leaves the borrowed work as it was. */
  putBack() {
    this.borrowed = null;
    tabRemembers(WORKED, this.tab);
    this.release();
  }

  /** Deletes work left by another tab, which has been saved, backed up by this tab, or discarded. */
  async #return() {
    const { borrowed, release } = this;
    this.borrowed = null;
    if (!borrowed) return;
    tabRemembers(WORKED, this.tab);
    await this.drop(borrowed);
    release();
  }

  /** Marks the document as saved or new, and deletes its backup. */
  async settle(doc = this.editor.history.state) {
    this.clean = doc;
    if (this.dirty) return;
    await this.#return();
    clearTimeout(this.timer);
    this.timer = 0;
    await this.sending; // otherwise the backup would remain although the document is saved
    await forget(this.tab, true).catch((error) => this.#failed(error));
    await this.#withdraw();
  }

  /** Deletes the backup of a tab, here and on the server. @param {Left} left */
  async drop({ tab, here, there }) {
    if (here) await forget(tab, tab === this.tab).catch((error) => this.#failed(error));
    if (there) await autosaves.remove(tab).catch((error) => this.#failed(error));
  }

  /** Backs up the drawing here and on the server. @returns {Promise<boolean>} whether at least one backup succeeded */
  async secure() {
    await Promise.all([this.#keep(), this.flush()]);
    const { state } = this.editor.history;
    return this.kept === state || this.sent === state;
  }

  /** Sends changes to the server. */
  async flush() {
    clearTimeout(this.timer);
    this.timer = 0;
    const doc = this.editor.history.state;
    if (this.connection.away) return;
    if (!this.dirty) this.sending = this.sending.then(() => this.#withdraw());
    else if (!isEmpty(doc) && this.sent !== doc) this.sending = this.#send(doc);
    await this.sending;
  }

  /** Deletes the server's backup if all changes were undone; otherwise it would be offered as unsaved work. */
  async #withdraw() {
    if (this.dirty || !this.there) return;
    this.sent = null;
    try {
      await autosaves.remove(this.tab);
      this.there = false;
    } catch (error) {
      this.there = !isGone(error); // retried once the server is back
      this.#failed(error);
    }
  }

  /** @param {import("../drawing/document.js").Doc} doc */
  async #send(doc) {
    this.there = true;
    try {
      await autosaves.write(this.tab, { ...doc, etag: this.etag, revision: this.revision });
      this.sent = doc;
    } catch (error) {
      this.#failed(error);
    }
  }

  #changed() {
    // From now on it is this tab's work, even after undo.
    if (this.borrowed && this.dirty) this.clean = null;
    this.revision += 1;
    this.#keep();
    this.timer ||= setTimeout(() => this.flush(), LATER);
  }

  /** Writes to the browser's store, one write at a time, the newest last. @returns {Promise<void>} */
  #keep() {
    this.stale = true;
    this.writing ??= this.#write();
    return this.writing;
  }

  async #write() {
    while (this.stale) {
      this.stale = false;
      const { state } = this.editor.history;
      try {
        if (!this.dirty) await forget(this.tab, true);
        else await keep({ tab: this.tab, changed: new Date().toISOString(), etag: this.etag, revision: this.revision, doc: state, past: this.editor.history });
        this.kept = state;
        this.full = false;
        if (this.borrowed && this.dirty) await this.#return();
      } catch (error) {
        this.#storeFailed(error);
      }
    }
    this.writing = null;
  }

  /** Reports a failure of the browser's store; while the server accepts the work, a full store is reported only once. @param {unknown} error */
  #storeFailed(error) {
    const full = error instanceof StoreFailure && error.why === "full";
    if (!full || !this.full || !this.sent || this.connection.away) this.#failed(error);
    this.full = full;
  }

  /** @param {unknown} error */
  #failed(error) {
    if (error instanceof Away) this.connection.lost();
    else if (!isGone(error)) this.dispatchEvent(new CustomEvent("failed", { detail: inWords(error) }));
  }
}

/**
 * @typedef {{doc: unknown, etag: string | null, revision: number, past: import("../drawing/steps.js").Past | null, missing: number}} Found
 *   etag: of the project it started from, null for none; revision: higher is newer, 0 is unknown; past: its history, if
 *   stored; missing: strokes and pictures that could not be read
 * @typedef {{tab: string, changed: string, name: string, here: boolean, there: boolean, read: () => Promise<Found>}} Left
 *   unsaved work of a tab; here: it is in the browser's store; there: it is on the server
 */

/**
 * Returns unsaved work of closed tabs, newest first, without duplicates between the two stores.
 * @param {Set<string> | null} open tabs that live, if that is known
 * @returns {Promise<{left: Left[], failed: unknown}>} failed: why the browser's store could not be read, null if it was
 */
export async function unsaved(open) {
  /** @type {unknown} */
  let failed = null;
  const [here, there] = await Promise.all([
    kept().catch((error) => {
      failed = inWords(error);
      return [];
    }),
    autosaves.list().catch(() => []),
  ]);
  /** @type {Map<string, Left>} */
  const found = new Map(there.map(({ name: tab, changed }) =>
    [tab, { tab, changed, name: "", here: false, there: true, read: () => fromServer(tab) }]));
  for (const { tab, changed, etag, revision, name, read } of here) {
    const other = found.get(tab);
    const both = async () => {
      const own = await read().catch((error) => {
        if (!other) throw error instanceof StoreFailure && error.why === "broken" ? new Error(text.damaged) : inWords(error);
        return null;
      });
      const whole = await other?.read().catch(() => null);
      if (!whole && !own) throw new Error(text.damaged);
      // The store holds each change at once, the server some seconds later; but one that is full holds an older one, or it may
      // be damaged.
      const better = whole && (!own || own.missing || whole.revision > revision);
      return better ? whole : { .../** @type {import("./store.js").Whole} */ (own), etag, revision };
    };
    found.set(tab, { tab, changed: changed || (other?.changed ?? ""), name, here: true, there: other !== undefined, read: both });
  }
  const left = [...found.values()].filter(({ tab }) => !open?.has(tab)).sort((a, b) => (a.changed < b.changed ? 1 : -1));
  return { left, failed };
}

/** @param {string} tab @returns {Promise<Found>} */
async function fromServer(tab) {
  const { doc } = await autosaves.read(tab);
  return { doc, etag: typeof doc.etag === "string" ? doc.etag : null, revision: Number(doc.revision ?? 0), past: null, missing: 0 };
}
