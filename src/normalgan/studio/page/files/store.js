/** Store: keep unsaved work in the browser's own database, without the server. */

import { fromSteps, toSteps } from "../drawing/steps.js";

const NAME = "normalgan-studio";
/** Documents by tab, with numbers instead of strokes and pictures. */
const HEADS = "unsaved";
/** Strokes and pictures by [tab, number], so that each stroke is written only once. */
const PIECES = "pieces";

/** @typedef {import("../drawing/document.js").Doc} Doc @typedef {import("../drawing/document.js").Layer} Layer
 * @typedef {import("../drawing/steps.js").Piece} Piece @typedef {import("../drawing/steps.js").Past} Past */
/**
 * @typedef {{tab: string, changed: string, etag: string | null, revision: number, doc: Doc}} Unsaved
 *   changed: ISO time; etag: the server's tag for the project when it was opened or saved here; revision: of the tab's work
 * @typedef {Omit<Layer, "strokes"> & {strokes: number[]}} LayerHead
 * @typedef {Omit<Doc, "layers" | "pictures"> & {layers: LayerHead[], pictures: number[]}} Head
 * @typedef {{tab: string, changed: string, etag?: string | null, revision?: number, doc: Head,
 *   history?: import("../drawing/steps.js").Steps}} Entry
 */

/** Version of the database schema; a page of another version may have used the database before. */
const VERSION = 2;
/** Timeouts in milliseconds for reading and for writing, after which the store counts as unusable. */
const PATIENCE = { readonly: 10_000, readwrite: 60_000 };

/**
 * @typedef {"full" | "newer" | "blocked" | "silent" | "broken"} Why full: no space is left; newer: a newer studio has changed
 *   the database; blocked: a page of an older studio prevents its upgrade; silent: the browser does not answer;
 *   broken: anything else, such as a browser set to store nothing
 */
export class StoreFailure extends Error {
  /** @param {Why} why @param {unknown} [cause] */
  constructor(why, cause) {
    super(why, { cause });
    this.why = why;
  }
}

/** @param {unknown} error @returns {StoreFailure} */
function failure(error) {
  if (error instanceof StoreFailure) return error;
  const { name } = /** @type {{name?: string}} */ (error ?? {});
  return new StoreFailure(name === "QuotaExceededError" ? "full" : name === "VersionError" ? "newer" : "broken", error);
}

/** @type {Promise<IDBDatabase> | null} */
let opened = null;
/** @type {WeakMap<object, number>} the numbers of this page's strokes and pictures */
const numbers = new WeakMap();
/** @type {Set<number>} this page's items in the database */
const stored = new Set();
let next = 0;
/** @type {Promise<unknown>} the last write; `stored` matches the database only between writes */
let writing = Promise.resolve();

/** @template T @param {() => Promise<T>} work @returns {Promise<T>} */
function inTurn(work) {
  const done = writing.then(work, work);
  writing = done.catch(() => {});
  return done;
}

/** Marks the database as closed; it is reopened on the next access, and its content is unknown until then. */
function closed() {
  opened = null;
  stored.clear();
}

/** @returns {Promise<IDBDatabase>} */
function database() {
  if (opened) return opened;
  const opening = new Promise((resolve, reject) => {
    let given = false;
    /** @param {Why | DOMException | null} why */
    const fail = (why) => {
      given = true;
      reject(typeof why === "string" ? new StoreFailure(why) : failure(why));
    };
    const request = indexedDB.open(NAME, VERSION);
    const timer = setTimeout(() => fail("silent"), PATIENCE.readonly);
    request.onupgradeneeded = () => {
      const { result } = request;
      if (!result.objectStoreNames.contains(HEADS)) result.createObjectStore(HEADS, { keyPath: "tab" });
      if (!result.objectStoreNames.contains(PIECES)) result.createObjectStore(PIECES);
    };
    request.onblocked = () => fail("blocked");
    request.onerror = () => {
      clearTimeout(timer);
      fail(request.error);
    };
    request.onsuccess = () => {
      clearTimeout(timer);
      const { result } = request;
      // Nobody waits for it any longer; it is reopened on the next access.
      if (given) return result.close();
      // An open connection would block the upgrade of a newer page.
      result.onversionchange = () => {
        result.close();
        closed();
      };
      result.onclose = closed;
      return resolve(result);
    };
  });
  opened = opening;
  // Retried with the next change.
  opening.catch(() => { if (opened === opening) opened = null; });
  return opening;
}

/**
 * @template T
 * @param {IDBTransactionMode} mode
 * @param {(heads: IDBObjectStore, pieces: IDBObjectStore) => IDBRequest<T>} work
 * @returns {Promise<T>}
 * @throws {StoreFailure}
 */
async function run(mode, work) {
  try {
    const connection = await database();
    return await new Promise((resolve, reject) => {
      const transaction = connection.transaction([HEADS, PIECES], mode, { durability: "strict" });
      const timer = setTimeout(() => reject(new StoreFailure("silent")), PATIENCE[mode === "readonly" ? mode : "readwrite"]);
      /** @type {IDBRequest<T>} */
      let request;
      transaction.onabort = () => {
        clearTimeout(timer);
        reject(failure(transaction.error ?? request?.error));
      };
      try {
        request = work(transaction.objectStore(HEADS), transaction.objectStore(PIECES));
      } catch (error) {
        transaction.abort(); // otherwise half of the work would be stored
        throw error;
      }
      if (mode === "readonly") {
        // Large values arrive after the request; an explicit commit would complete the transaction without them.
        request.onsuccess = () => {
          clearTimeout(timer);
          resolve(request.result);
        };
        return;
      }
      transaction.oncomplete = () => {
        clearTimeout(timer);
        resolve(request.result);
      };
      // An automatic commit waits for the result of the request, and would be lost if the page closed before that.
      transaction.commit();
    });
  } catch (error) {
    const failed = failure(error);
    const { name } = /** @type {{name?: string}} */ (failed.cause ?? {});
    if (name === "InvalidStateError") closed(); // the connection was closed without an event
    throw failed;
  }
}

/** @param {string} tab */
const ofTab = (tab) => IDBKeyRange.bound([tab], [tab, []]);

/** Maximum number of stored steps of history. */
const MOST_STEPS = 100;

/**
 * Stores this page's document and its history, and writes only the new parts. If there is no room for both, it stores the
 * document without the history.
 * @param {Unsaved & {past: Past}} entry
 * @throws {StoreFailure} if it cannot even store the document; the earlier entry remains.
 */
export const keep = (entry) => inTurn(async () => {
  try {
    await write(entry);
  } catch (error) {
    if (failure(error).why !== "full" || entry.past.states.length < 2) throw error;
    await write({ ...entry, past: { states: [entry.doc], at: 0 } });
  }
});

/** @param {Unsaved & {past: Past}} entry */
async function write({ tab, changed, etag, revision, doc, past }) {
  const wanted = new Map();
  /** @param {Piece} each */
  const numbered = (each) => {
    const number = numbers.get(each) ?? next++;
    numbers.set(each, number);
    wanted.set(number, each);
    return number;
  };
  const layers = doc.layers.map((layer) => ({ ...layer, strokes: layer.strokes.map(numbered) }));
  const head = { ...doc, layers, pictures: doc.pictures.map(numbered) };
  const history = toSteps(past, MOST_STEPS, numbered);
  const fresh = [...wanted].filter(([number]) => !stored.has(number));
  const old = [...stored].filter((number) => !wanted.has(number));
  await run("readwrite", (heads, pieces) => {
    for (const [number, piece] of fresh) pieces.put(piece, [tab, number]);
    for (const number of old) pieces.delete([tab, number]);
    return heads.put({ tab, changed, etag, revision, doc: head, history });
  });
  for (const [number] of fresh) stored.add(number);
  for (const number of old) stored.delete(number);
}

/** @typedef {{doc: unknown, past: Past | null, missing: number}} Whole missing: strokes and pictures that cannot be read */

/**
 * Returns the stored entries; `read` reads their documents on request.
 * @returns {Promise<{tab: string, changed: string, etag: string | null, revision: number, name: string, read: () => Promise<Whole>}[]>} of an
 *   entry that cannot be read, `read` fails
 * @throws {StoreFailure} if nothing can be read.
 */
export async function kept() {
  const entries = await each((heads) => heads.getAll(), (heads) => heads.getAllKeys(), (key) => (heads) => heads.get(key));
  return entries.map(([key, entry]) => {
    const { changed, etag, revision, doc, history } = /** @type {Partial<Entry>} */ (entry ?? {});
    const tab = String(key);
    return {
      tab, changed: changed ?? "", etag: etag ?? null, revision: revision ?? 0, name: String(doc?.settings?.name ?? ""),
      read: async () => {
        if (!doc) throw new StoreFailure("broken");
        return whole(tab, doc, history);
      },
    };
  });
}

/**
 * Returns all values with their keys; one that cannot be read, as its file on the disk is damaged, is undefined.
 * @param {(heads: IDBObjectStore, pieces: IDBObjectStore) => IDBRequest<any[]>} values
 * @param {(heads: IDBObjectStore, pieces: IDBObjectStore) => IDBRequest<IDBValidKey[]>} keys
 * @param {(key: IDBValidKey) => (heads: IDBObjectStore, pieces: IDBObjectStore) => IDBRequest<any>} one
 * @returns {Promise<[IDBValidKey, any][]>}
 */
async function each(values, keys, one) {
  const found = await run("readonly", keys);
  const all = await run("readonly", values).catch(() => null);
  // Another page may have written between the two reads.
  if (all?.length === found.length) return found.map((key, i) => [key, all[i]]);
  return Promise.all(found.map(async (key) => /** @type {[IDBValidKey, any]} */ ([key, await run("readonly", one(key)).catch(() => undefined)])));
}

/**
 * @param {string} tab @param {any} head a `Head`, or one of an older version, which `parseDocument` brings up to date
 * @param {import("../drawing/steps.js").Steps | undefined} history
 * @returns {Promise<Whole>}
 */
async function whole(tab, head, history) {
  const entries = await each((_, pieces) => pieces.getAll(ofTab(tab)), (_, pieces) => pieces.getAllKeys(ofTab(tab)), (key) => (_, pieces) => pieces.get(key));
  const found = new Map(entries.map(([key, value]) => [/** @type {[string, number]} */ (key)[1], value]));
  // The first version stored the strokes themselves.
  /** @param {any} each */
  const piece = (each) => (typeof each === "number" ? found.get(each) : each);
  let missing = 0;
  /** @param {any[]} list */
  const list = (list) => {
    const there = list.map(piece).filter(Boolean);
    missing += list.length - there.length;
    return there;
  };
  if (!head.pictures) {
    const doc = { ...head, strokes: list(head.strokes), layers: list(head.layers) };
    return { doc, past: null, missing };
  }
  const layers = head.layers.map((/** @type {LayerHead} */ layer) => ({ ...layer, strokes: list(layer.strokes) }));
  const doc = { ...head, layers, pictures: list(head.pictures) };
  const past = missing ? null : fromSteps(history, piece);
  // The same object as in the history, so that unchanged parts are recognised.
  return { doc: past ? past.states[past.at] : doc, past, missing };
}

/** @param {string} tab @param {boolean} [own] whether it is this page's */
export const forget = (tab, own = false) => inTurn(async () => {
  if (own) stored.clear();
  await run("readwrite", (heads, pieces) => {
    pieces.delete(ofTab(tab));
    return heads.delete(tab);
  });
});
