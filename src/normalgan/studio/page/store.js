/** Store: unsaved work in the browser's own database, at once and without the server. */

import { fromSteps, toSteps } from "./steps.js";

const NAME = "normalgan-studio";
/** Of each tab its document, with the numbers of its strokes and pictures in place of these. */
const HEADS = "unsaved";
/** Strokes and pictures by [tab, number]: a stroke is written once, and not with every one that follows. */
const PIECES = "pieces";

/** @typedef {import("./document.js").Doc} Doc @typedef {import("./document.js").Layer} Layer
 * @typedef {import("./steps.js").Piece} Piece @typedef {import("./steps.js").Past} Past */
/**
 * @typedef {{tab: string, changed: string, etag: string | null, doc: Doc}} Unsaved
 *   changed: ISO time; etag: what the server called the project when it was opened or saved here
 * @typedef {Omit<Layer, "strokes"> & {strokes: number[]}} LayerHead
 * @typedef {Omit<Doc, "layers" | "pictures"> & {layers: LayerHead[], pictures: number[]}} Head
 * @typedef {{tab: string, changed: string, etag?: string | null, doc: Head,
 *   history?: import("./steps.js").Steps}} Entry
 */

/** @type {Promise<IDBDatabase> | null} */
let opened = null;
/** @type {WeakMap<object, number>} the number of each stroke and picture of this page */
const numbers = new WeakMap();
/** @type {Set<number>} what is in the database of this page */
const stored = new Set();
let next = 0;
/** @type {Promise<unknown>} what writes last: `stored` is true of the database only between writings */
let writing = Promise.resolve();

/** @template T @param {() => Promise<T>} work @returns {Promise<T>} */
function inTurn(work) {
  const done = writing.then(work, work);
  writing = done.catch(() => {});
  return done;
}

function database() {
  opened ??= new Promise((resolve, reject) => {
    const request = indexedDB.open(NAME, 2);
    request.onupgradeneeded = () => {
      const { result } = request;
      if (!result.objectStoreNames.contains(HEADS)) result.createObjectStore(HEADS, { keyPath: "tab" });
      if (!result.objectStoreNames.contains(PIECES)) result.createObjectStore(PIECES);
    };
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
  return opened;
}

/**
 * @template T
 * @param {IDBTransactionMode} mode
 * @param {(heads: IDBObjectStore, pieces: IDBObjectStore) => IDBRequest<T>} work
 * @returns {Promise<T>}
 */
async function run(mode, work) {
  const transaction = (await database()).transaction([HEADS, PIECES], mode, { durability: "strict" });
  const request = work(transaction.objectStore(HEADS), transaction.objectStore(PIECES));
  // Left to itself it commits when the request's answer is back here: a page that closes first takes it along.
  transaction.commit();
  return new Promise((resolve, reject) => {
    transaction.oncomplete = () => resolve(request.result);
    transaction.onabort = transaction.onerror = () => reject(transaction.error);
  });
}

/** @param {string} tab */
const ofTab = (tab) => IDBKeyRange.bound([tab], [tab, []]);

/** Steps of history that are kept. */
const MOST_STEPS = 100;

/** Keeps this page's document and its history: only what is new of it is written. @param {Unsaved & {past: Past}} entry */
export const keep = (entry) => inTurn(() => write(entry));

/** @param {Unsaved & {past: Past}} entry */
async function write({ tab, changed, etag, doc, past }) {
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
    return heads.put({ tab, changed, etag, doc: head, history });
  });
  for (const [number] of fresh) stored.add(number);
  for (const number of old) stored.delete(number);
}

/**
 * Returns what was kept, without the documents, which are read when they are asked for.
 * @returns {Promise<{tab: string, changed: string, etag: string | null, name: string,
 *   read: () => Promise<{doc: unknown, past: Past | null}>}[]>}
 */
export async function kept() {
  const entries = /** @type {Entry[]} */ (await run("readonly", (heads) => heads.getAll()));
  return entries.map(({ tab, changed, etag, doc, history }) => ({
    tab, changed, etag: etag ?? null, name: doc.settings?.name ?? "", read: () => whole(tab, doc, history),
  }));
}

/**
 * @param {string} tab @param {any} head a `Head`, or one of an older version, which `parseDocument` brings up to date
 * @param {import("./steps.js").Steps | undefined} history
 * @returns {Promise<{doc: unknown, past: Past | null}>}
 */
async function whole(tab, head, history) {
  const [keys, values] = await Promise.all([
    run("readonly", (_, pieces) => pieces.getAllKeys(ofTab(tab))),
    run("readonly", (_, pieces) => pieces.getAll(ofTab(tab))),
  ]);
  const found = new Map(keys.map((key, i) => [/** @type {[string, number]} */ (key)[1], values[i]]));
  // The first version kept the strokes themselves.
  /** @param {any} each */
  const piece = (each) => (typeof each === "number" ? found.get(each) : each);
  if (!head.pictures) return { doc: { ...head, strokes: head.strokes.map(piece), layers: head.layers.map(piece) }, past: null };
  const layers = head.layers.map((/** @type {LayerHead} */ layer) => ({ ...layer, strokes: layer.strokes.map(piece) }));
  const past = fromSteps(history, piece);
  // The very document of the history, by which others see what in it is the same as in the step before.
  return { doc: past ? past.states[past.at] : { ...head, layers, pictures: head.pictures.map(piece) }, past };
}

/** @param {string} tab @param {boolean} [own] whether it is this page's */
export const forget = (tab, own = false) => inTurn(async () => {
  if (own) stored.clear();
  await run("readwrite", (heads, pieces) => {
    pieces.delete(ofTab(tab));
    return heads.delete(tab);
  });
});
