/** Documents: stores projects and unsaved work in the browser's own database, behind the server's interface. */

const [NAME, STORE] = ["normalgan-browser-studio", "documents"];
/** @typedef {{folder: string, name: string, changed: string, etag: string, doc: string}} Entry */

/** @type {Promise<IDBDatabase> | null} */
let opened = null;

function database() {
  opened ??= new Promise((resolve, reject) => {
    const request = indexedDB.open(NAME, 1);
    request.onupgradeneeded = () => { request.result.createObjectStore(STORE, { keyPath: ["folder", "name"] }); };
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
  return opened;
}

/** @template T @param {IDBTransactionMode} mode @param {(store: IDBObjectStore) => IDBRequest<T>} work @returns {Promise<T>} */
async function run(mode, work) {
  const transaction = (await database()).transaction(STORE, mode);
  const request = work(transaction.objectStore(STORE));
  return new Promise((resolve, reject) => {
    transaction.oncomplete = () => resolve(request.result);
    transaction.onabort = transaction.onerror = () => reject(transaction.error);
  });
}

/** @param {string} error @param {number} status */
const refused = (error, status) => new Response(JSON.stringify({ error }), { status });

/**
 * Answers a request for documents as the server does.
 * @param {string} folder @param {string | undefined} name @param {string} method @param {Headers} headers @param {string} body
 * @returns {Promise<Response>}
 */
export async function documents(folder, name, method, headers, body) {
  if (!name) {
    /** @type {Entry[]} */
    const all = await run("readonly", (store) => store.getAll());
    const rows = all.filter((each) => each.folder === folder).map((each) => ({ name: each.name, changed: each.changed }));
    return new Response(JSON.stringify(rows.sort((a, b) => (a.changed < b.changed ? 1 : -1))));
  }
  /** @type {Entry | undefined} */
  const there = await run("readonly", (store) => store.get([folder, name]));
  const wanted = headers.get("If-Match");
  if ((wanted && there?.etag !== wanted) || (headers.get("If-None-Match") === "*" && there)) {
    return refused("it was changed elsewhere in the meantime.", 412);
  }
  if (method === "PUT") {
    const etag = `"${crypto.randomUUID()}"`;
    await run("readwrite", (store) => store.put({ folder, name, changed: new Date().toISOString(), etag, doc: body }));
    return new Response(null, { status: 204, headers: { ETag: etag } });
  }
  if (!there) return refused("there is no such project.", 404);
  if (method === "DELETE") {
    await run("readwrite", (store) => store.delete([folder, name]));
    return new Response(null, { status: 204 });
  }
  return new Response(there.doc, { headers: { ETag: there.etag } });
}
