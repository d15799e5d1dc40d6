/** Store: unsaved work in the browser's own database, at once and without the server. */

const NAME = "normalgan-studio";
const TABLE = "unsaved";

/** @typedef {{tab: string, changed: string, doc: import("./document.js").Doc}} Unsaved changed: ISO time */

/** @type {Promise<IDBDatabase> | null} */
let opened = null;

function database() {
  opened ??= new Promise((resolve, reject) => {
    const request = indexedDB.open(NAME, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(TABLE, { keyPath: "tab" });
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
  return opened;
}

/** @param {IDBTransactionMode} mode @param {(table: IDBObjectStore) => IDBRequest} work */
async function run(mode, work) {
  const transaction = (await database()).transaction(TABLE, mode, { durability: "strict" });
  const request = work(transaction.objectStore(TABLE));
  // Left to itself it commits when the request's answer is back here: a page that closes first takes it along.
  transaction.commit();
  return new Promise((resolve, reject) => {
    transaction.oncomplete = () => resolve(request.result);
    transaction.onabort = transaction.onerror = () => reject(transaction.error);
  });
}

/** @param {Unsaved} entry */
export const keep = (entry) => run("readwrite", (table) => table.put(entry));

/** @returns {Promise<Unsaved[]>} */
export const kept = () => run("readonly", (table) => table.getAll());

/** @param {string} tab */
export const forget = (tab) => run("readwrite", (table) => table.delete(tab));
