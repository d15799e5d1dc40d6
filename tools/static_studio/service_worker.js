/**
 * Service worker: keeps the files of the studio without a server, so that it opens where there is no network. In front of it
 * the site's build writes `VERSION`, which names what the files hold, and `FILES`.
 */

/** @type {any} what the types of a page do not know */
const worker = globalThis;
/** @type {{VERSION: string, FILES: string[]}} */
const { VERSION, FILES } = worker.BUILT;
const PREFIX = "normalgan-studio-";

worker.addEventListener("install", (/** @type {any} */ event) => {
  // What the browser has of the version before is asked about, and what is the same is not fetched twice.
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
 * Returns an answer with the headers that isolate the page from those of others, so that the network may use threads. Few hosts
 * of pages let their users set them.
 * @param {Response} answer
 */
function isolated(answer) {
  if (answer.type === "opaque" || answer.type === "opaqueredirect") return answer; // not the studio's own
  const headers = new Headers(answer.headers);
  headers.set("Cross-Origin-Opener-Policy", "same-origin");
  headers.set("Cross-Origin-Embedder-Policy", "require-corp");
  return new Response(answer.body, { status: answer.status, statusText: answer.statusText, headers });
}
