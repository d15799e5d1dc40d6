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
 * @typedef {{tab: string, changed: string, etag?: string | null, doc: Head,
 *   history?: {steps: Step[], at: number}}} Entry
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

/** Steps of history that are kept. */
const MOST_STEPS = 100;

/**
 * @typedef {object} Step a document of the history, beside the step before it
 * @property {[number, ...number[]]} strokes how many are the same as there, then the numbers of the others
 * @property {[number, ...number[]]} layers
 * @property {Partial<Doc>} more what else differs
 * @typedef {{states: Doc[], at: number}} Past
 */

/**
 * Returns a history as steps, each of which holds only what it changed.
 * @param {Past} past
 * @param {(piece: Stroke | Layer) => number} numbered
 * @returns {{steps: Step[], at: number}}
 */
function toSteps({ states, at }, numbered) {
  const first = Math.max(0, Math.min(at, states.length - MOST_STEPS));
  const shown = states.slice(first, first + MOST_STEPS);
  const steps = shown.map((state, i) => {
    const before = /** @type {Record<string, any> | undefined} */ (shown[i - 1]);
    const others = (/** @type {(Stroke | Layer)[]} */ to, /** @type {(Stroke | Layer)[]} */ from) => {
      let same = 0;
      while (same < to.length && same < from.length && to[same] === from[same]) same++;
      return /** @type {[number, ...number[]]} */ ([same, ...to.slice(same).map(numbered)]);
    };
    const { strokes, layers, ...rest } = state;
    const more = Object.fromEntries(Object.entries(rest).filter(([key, value]) => !before || before[key] !== value));
    return { strokes: others(strokes, before?.strokes ?? []), layers: others(layers, before?.layers ?? []), more };
  });
  return { steps, at: at - first };
}

/**
 * Returns the history that was kept as steps; null if something of it is missing.
 * @param {{steps: Step[], at: number} | undefined} kept
 * @param {(number: number) => any} piece
 * @returns {Past | null}
 */
function fromSteps(kept, piece) {
  if (!kept) return null;
  /** @type {Doc[]} */
  const states = [];
  for (const { strokes, layers, more } of kept.steps) {
    const before = states[states.length - 1];
    const list = (/** @type {number[]} */ [same, ...others], /** @type {any[]} */ from) => {
      const found = others.map(piece);
      // Equal lists are one list, by which others see that nothing has changed.
      return from && same === from.length && !found.length ? from : [...(from ?? []).slice(0, same), ...found];
    };
    const state = /** @type {Doc} */ ({ ...before, ...more, strokes: list(strokes, before?.strokes), layers: list(layers, before?.layers) });
    if ([...state.strokes, ...state.layers].some((each) => each === undefined)) return null;
    states.push(state);
  }
  return states[kept.at] ? { states, at: kept.at } : null;
}

/** Keeps this page's document and its history: only what is new of it is written. @param {Unsaved & {past: Past}} entry */
export const keep = (entry) => inTurn(() => write(entry));

/** @param {Unsaved & {past: Past}} entry */
async function write({ tab, changed, etag, doc, past }) {
  const wanted = new Map();
  /** @param {Stroke | Layer} each */
  const numbered = (each) => {
    const number = numbers.get(each) ?? next++;
    numbers.set(each, number);
    wanted.set(number, each);
    return number;
  };
  const head = { ...doc, strokes: doc.strokes.map(numbered), layers: doc.layers.map(numbered) };
  const history = toSteps(past, numbered);
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
 *   read: () => Promise<{doc: Doc, past: Past | null}>}[]>}
 */
export async function kept() {
  const entries = /** @type {Entry[]} */ (await run("readonly", (heads) => heads.getAll()));
  return entries.map(({ tab, changed, etag, doc, history }) => ({
    tab, changed, etag: etag ?? null, name: doc.settings?.name ?? "", read: () => whole(tab, doc, history),
  }));
}

/**
 * @param {string} tab @param {Head} head @param {{steps: Step[], at: number} | undefined} history
 * @returns {Promise<{doc: Doc, past: Past | null}>}
 */
async function whole(tab, head, history) {
  const [keys, values] = await Promise.all([
    run("readonly", (_, pieces) => pieces.getAllKeys(ofTab(tab))),
    run("readonly", (_, pieces) => pieces.getAll(ofTab(tab))),
  ]);
  const found = new Map(keys.map((key, i) => [/** @type {[string, number]} */ (key)[1], values[i]]));
  // The first version kept the strokes themselves.
  /** @param {number | Stroke | Layer} each */
  const piece = (each) => (typeof each === "number" ? found.get(each) : each);
  const doc = /** @type {Doc} */ ({ ...head, strokes: head.strokes.map(piece), layers: head.layers.map(piece) });
  return { doc, past: fromSteps(history, piece) };
}

/** @param {string} tab @param {boolean} [own] whether it is this page's */
export const forget = (tab, own = false) => inTurn(async () => {
  if (own) stored.clear();
  await run("readwrite", (heads, pieces) => {
    pieces.delete(ofTab(tab));
    return heads.delete(tab);
  });
});
