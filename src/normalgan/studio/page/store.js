/** Store: unsaved work in the browser's own database, at once and without the server. */

const NAME = "normalgan-studio";
/** Of each tab its document, with the numbers of its strokes and layers in place of these. */
const HEADS = "unsaved";
/** Strokes and layers by [tab, number]: a stroke is written once, and not with every one that follows. */
const PIECES = "pieces";

/** @typedef {import("./document.js").Doc} Doc @typedef {import("./document.js").Stroke} Stroke
 * @typedef {import("./document.js").Layer} Layer */
/**
 * @typedef {{tab: string, changed: string, etag: string | null, doc: Doc}} Unsaved
 *   changed: ISO time; etag: what the server called the project when it was opened or saved here
 * @typedef {Omit<Doc, "strokes" | "layers"> & {strokes: (number | Stroke)[], layers: (number | Layer)[]}} Head
 * @typedef {{tab: string, changed: string, etag?: string | null, doc: Head}} Entry
 */

/** @type {Promise<IDBDatabase> | null} */
let opened = null;
/** @type {WeakMap<object, number>} the number of each stroke and layer of this page */
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

/** Keeps this page's document: only what is new of it is written. @param {Unsaved} entry */
export const keep = (entry) => inTurn(() => write(entry));

/** @param {Unsaved} entry */
async function write({ tab, changed, etag, doc }) {
  const wanted = new Map();
  /** @param {Stroke | Layer} each */
  const numbered = (each) => {
    const number = numbers.get(each) ?? next++;
    numbers.set(each, number);
    wanted.set(number, each);
    return number;
  };
  const head = { ...doc, strokes: doc.strokes.map(numbered), layers: doc.layers.map(numbered) };
  const fresh = [...wanted].filter(([number]) => !stored.has(number));
  const old = [...stored].filter((number) => !wanted.has(number));
  await run("readwrite", (heads, pieces) => {
    for (const [number, piece] of fresh) pieces.put(piece, [tab, number]);
    for (const number of old) pieces.delete([tab, number]);
    return heads.put({ tab, changed, etag, doc: head });
  });
  for (const [number] of fresh) stored.add(number);
  for (const number of old) stored.delete(number);
}

/**
 * Returns what was kept, without the documents, which are read when they are asked for.
 * @returns {Promise<{tab: string, changed: string, etag: string | null, name: string, read: () => Promise<Doc>}[]>}
 */
export async function kept() {
  const entries = /** @type {Entry[]} */ (await run("readonly", (heads) => heads.getAll()));
  return entries.map(({ tab, changed, etag, doc }) => ({
    tab, changed, etag: etag ?? null, name: doc.settings?.name ?? "", read: () => whole(tab, doc),
  }));
}

/** @param {string} tab @param {Head} head @returns {Promise<Doc>} */
async function whole(tab, head) {
  const [keys, values] = await Promise.all([
    run("readonly", (_, pieces) => pieces.getAllKeys(ofTab(tab))),
    run("readonly", (_, pieces) => pieces.getAll(ofTab(tab))),
  ]);
  const found = new Map(keys.map((key, i) => [/** @type {[string, number]} */ (key)[1], values[i]]));
  // The first version kept the strokes themselves.
  /** @param {number | Stroke | Layer} each */
  const piece = (each) => (typeof each === "number" ? found.get(each) : each);
  return /** @type {Doc} */ ({ ...head, strokes: head.strokes.map(piece), layers: head.layers.map(piece) });
}

/** @param {string} tab @param {boolean} [own] whether it is this page's */
export const forget = (tab, own = false) => inTurn(async () => {
  if (own) stored.clear();
  await run("readwrite", (heads, pieces) => {
    pieces.delete(ofTab(tab));
    return heads.delete(tab);
  });
});
