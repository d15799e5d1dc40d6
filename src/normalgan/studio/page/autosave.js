/** Autosave: each change goes to the browser's store at once and to the server some seconds later. */

import { Away, Refused, autosaves } from "./api.js";
import { isEmpty } from "./document.js";
import { forget, keep, kept } from "./store.js";
import { text } from "./text.js";

const LATER = 2500;

/** Event `failed` (detail: the error) when the browser cannot keep the work. */
export class Autosave extends EventTarget {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {import("./connection.js").Connection} connection
   * @param {string} tab
   */
  constructor(editor, connection, tab) {
    super();
    this.editor = editor;
    this.connection = connection;
    this.tab = tab;
    /** @type {string | null} what the server called the project as this tab has seen it */
    this.etag = null;
    /** The document as it was last saved or opened: nothing to keep. */
    this.clean = editor.doc;
    this.writing = false;
    this.stale = false;
    this.timer = 0;
    /** @type {import("./document.js").Doc | null} what the server holds, as it has answered */
    this.sent = null;
    /** Whether the server may hold work of this tab: what was sent may have arrived although no answer came. */
    this.there = false;
    /** @type {Promise<void>} the writing to the server that goes on, or the last one */
    this.sending = Promise.resolve();
    editor.addEventListener("change", (event) => /** @type {CustomEvent} */ (event).detail.live || this.#changed());
    editor.addEventListener("replaced", (event) => {
      const { before, after } = /** @type {CustomEvent} */ (event).detail;
      if (this.clean === before) this.clean = after; // which layer is worked on is no work that could be lost
    });
    connection.addEventListener("back", () => this.flush());
    addEventListener("pagehide", () => this.flush());
  }

  get dirty() {
    return this.editor.history.state !== this.clean;
  }

  /** Notes that the document is saved as a project, or fresh: what was kept is dropped. */
  async settle(doc = this.editor.history.state) {
    this.clean = doc;
    if (this.dirty) return;
    clearTimeout(this.timer);
    this.timer = 0;
    await this.sending; // or it would lie there although it is saved
    await forget(this.tab, true);
    await this.#withdraw();
  }

  /** Drops what a tab has kept, here and on the server. @param {string} tab @param {boolean} there it is on the server */
  async drop(tab, there) {
    await forget(tab, tab === this.tab);
    if (there) await autosaves.remove(tab).catch((error) => this.#failed(error));
  }

  /** Sends what has changed to the server. */
  async flush() {
    clearTimeout(this.timer);
    this.timer = 0;
    const doc = this.editor.history.state;
    if (this.connection.away) return;
    if (!this.dirty) this.sending = this.sending.then(() => this.#withdraw());
    else if (!isEmpty(doc) && this.sent !== doc) this.sending = this.#send(doc);
    await this.sending;
  }

  /** Takes back what the server holds where all that changed was undone: it would be offered as unsaved work. */
  async #withdraw() {
    if (this.dirty || !this.there) return;
    this.sent = null;
    try {
      await autosaves.remove(this.tab);
      this.there = false;
    } catch (error) {
      this.there = !isGone(error); // tried again once the server is back
      this.#failed(error);
    }
  }

  /** @param {import("./document.js").Doc} doc */
  async #send(doc) {
    this.there = true;
    try {
      await autosaves.write(this.tab, { ...doc, etag: this.etag });
      this.sent = doc;
    } catch (error) {
      this.#failed(error);
    }
  }

  #changed() {
    this.#keep();
    this.timer ||= setTimeout(() => this.flush(), LATER);
  }

  /** Writes to the browser's store, one writing at a time, the newest last. */
  async #keep() {
    this.stale = true;
    if (this.writing) return;
    this.writing = true;
    try {
      while (this.stale) {
        this.stale = false;
        if (!this.dirty) await forget(this.tab, true);
        else await keep({ tab: this.tab, changed: new Date().toISOString(), etag: this.etag, doc: this.editor.history.state, past: this.editor.history });
      }
    } catch (error) {
      const full = /** @type {Error} */ (error).name === "QuotaExceededError";
      this.dispatchEvent(new CustomEvent("failed", { detail: new Error(full ? text.storageFull : text.noStorage) }));
    } finally {
      this.writing = false;
    }
  }

  /** @param {unknown} error */
  #failed(error) {
    if (error instanceof Away) this.connection.lost();
    else if (!isGone(error)) this.dispatchEvent(new CustomEvent("failed", { detail: error }));
  }
}

/** @param {unknown} error @returns {boolean} whether the server says that it holds no such work */
function isGone(error) {
  return error instanceof Refused && error.status === 404;
}

/**
 * @typedef {{doc: unknown, etag: string | null, past: import("./steps.js").Past | null}} Found etag: of the project it
 *   was made from, null for none; past: its history, if that was kept
 * @typedef {{tab: string, changed: string, name: string, there: boolean, read: () => Promise<Found>}} Left
 *   unsaved work of a tab; there: it is on the server
 */

/**
 * Returns unsaved work of tabs that are closed, newest first; what both stores hold counts once.
 * @param {Set<string>} open tabs that live
 * @returns {Promise<Left[]>}
 */
export async function unsaved(open) {
  const [here, there] = await Promise.all([kept(), autosaves.list().catch(() => [])]);
  /** @type {Map<string, Left>} */
  const found = new Map(there.map(({ name: tab, changed }) => [tab, { tab, changed, name: "", there: true, read: () => fromServer(tab) }]));
  for (const { tab, changed, etag, name, read } of here) {
    // The store holds each change at once, the server some seconds later: the store's is never older.
    found.set(tab, { tab, changed, name, there: found.has(tab), read: async () => ({ ...(await read()), etag }) });
  }
  return [...found.values()].filter(({ tab }) => !open.has(tab)).sort((a, b) => (a.changed < b.changed ? 1 : -1));
}

/** @param {string} tab @returns {Promise<Found>} */
async function fromServer(tab) {
  const { doc } = await autosaves.read(tab);
  return { doc, etag: typeof doc.etag === "string" ? doc.etag : null, past: null };
}
