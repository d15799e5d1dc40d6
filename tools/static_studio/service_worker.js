/**
 * Service worker: caches the files of the studio without a server, so that it opens without a network. The site's build
 * writes `VERSION`, a fingerprint of the files' contents, and `FILES` in front of it.
 */

/** @type {any} not part of the types for pages */
const worker = globalThis;
/** @type {{VERSION: string, FILES: string[]}} */
const { VERSION, FILES } = worker.BUILT;
const PREFIX = "normalgan-studio-";

worker.addEventListener("install", (/** @type {any} */ event) => {
  // Files that the browser has from the previous version are revalidated, so that unchanged ones are not fetched twice.
  const fresh = FILES.map((file) => new Request(file, { cache: "no-cache" }));
  event.waitUntil(caches.open(PREFIX + VERSION).then((cache) => cache.addAll(fresh)).then(() => worker.skipWaiting()));
});

worker.addEventListener("activate", (/** @type {any} */ event) => {
  event.waitUntil((async () => {
    for (const name of await caches.keys()) if (name.startsWith(PREFIX) && name !== PREFIX + VERSION) await caches.delete(name);
    await worker.clients.claim();
  })());
});

worker.addEventListener("fetch", (/** @type {any} */ event) => {
  if (event.request.method !== "GET" || !event.request.url.startsWith(worker.registration.scope)) return;
  event.respondWith((async () => {
    const cache = await caches.open(PREFIX + VERSION);
    return isolated((await cache.match(event.request, { ignoreSearch: true })) ?? await fetch(event.request));
  })());
});

/**
 * Returns an answer with the headers that isolate the page from other pages, so that the network may use threads. Few hosts
 * let their users set these headers.
 * @param {Response} answer
 */
function isolated(answer) {
  if (answer.type === "opaque" || answer.type === "opaqueredirect") return answer; // not one of the studio's files
  const headers = new Headers(answer.headers);
  headers.set("Cross-Origin-Opener-Policy", "same-origin");
  headers.set("Cross-Origin-Embedder-Policy", "require-corp");
  return new Response(answer.body, { status: answer.status, statusText: answer.statusText, headers });
}
