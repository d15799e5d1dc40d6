/** The server, as functions; each fails with `Refused` (it said why) or `Away` (it does not answer). */

/**
 * @typedef {import("../result/findings.js").Finding} Finding
 * @typedef {{fields: Record<string, unknown>, pixels: Uint8Array[]}} Request
 *   about a drawing: what is asked, and the bytes of its planes, or of the boxes that have changed
 */

/** What the server says is wrong. */
export class Refused extends Error {
  /** @param {number} status @param {string} message */
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

/** @param {unknown} error @returns {boolean} whether the server says that it holds no such document */
export const isGone = (error) => error instanceof Refused && error.status === 404;

/** The drawing is not yet, or no longer, one that can be painted. */
export class Lacking extends Error {
  /** @param {Finding[]} findings what it lacks */
  constructor(findings) {
    super();
    this.findings = findings;
  }
}

/** The server does not answer. */
export class Away extends Error {}

/** @param {string} path @param {RequestInit} [options] @returns {Promise<Response>} */
async function ask(path, options = {}) {
  let response;
  try {
    response = await fetch(path, { cache: "no-store", ...options });
  } catch (error) {
    if (error instanceof Error && error.name === "AbortError") throw error;
    throw new Away(String(error));
  }
  if (response.ok) return response;
  const answer = await response.json().catch(() => ({}));
  throw new Refused(response.status, answer.error ?? response.statusText);
}

/** Bytes from which a body is sent as a blob: Chromium passes bytes to its network process in one piece, for which the page waits. */
const LARGE = 2 ** 21;

/**
 * Sends a request about a drawing: the length of its fields as JSON, the JSON, then the bytes of its planes.
 * @param {string} path @param {Request} request @param {AbortSignal} [signal]
 */
function post(path, { fields, pixels }, signal) {
  const json = new TextEncoder().encode(JSON.stringify(fields));
  const body = new Uint8Array(pixels.reduce((sum, each) => sum + each.length, 4 + json.length));
  new DataView(body.buffer).setUint32(0, json.length, true);
  body.set(json, 4);
  let at = 4 + json.length;
  for (const each of pixels) {
    body.set(each, at);
    at += each.length;
  }
  return ask(path, { method: "POST", body: body.length < LARGE ? body : new Blob([body]), headers: { "Content-Type": "application/x-normalgan-drawing" }, signal });
}

/** @param {Response} response @param {string} name */
const number = (response, name) => Number(response.headers.get(name));
/** @param {Response} response @returns {Finding[]} */
const findingsOf = (response) => JSON.parse(decodeURIComponent(response.headers.get("X-Findings") || "[]"));

/** Milliseconds after which a server that says nothing is taken to be away, where the page waits for it to begin. */
const PATIENCE = 10_000;
const inTime = () => ({ signal: AbortSignal.timeout(PATIENCE) });

/**
 * Returns what answers; `exports`: what can be exported and in which formats, all where that is not said.
 * @returns {Promise<{version: string, model: {name: string, size: number}, exports?: Record<string, string[]>}>}
 */
export const about = async () => (await ask("/api/about")).json();

/** Returns what the command line named. @returns {Promise<{kind: string, name: string, [more: string]: any} | null>} */
export const named = async () => (await ask("/api/open", inTime())).json();

/** Returns the drawing's file that the command line named. @param {string} name @returns {Promise<File>} */
export const namedFile = async (name) => new File([await (await ask("/api/open/file", inTime())).blob()], name);

/**
 * Returns a painted map, or null if a newer request came in between.
 * @param {Request} request @param {AbortSignal} [signal]
 * @throws {Lacking} if there is nothing to be painted.
 */
export async function predict(request, signal) {
  const response = await post("/api/predict", request, signal);
  if (response.status === 204) {
    const lacks = findingsOf(response);
    if (lacks.length) throw new Lacking(lacks);
    return null;
  }
  const rgba = new Uint8Array(await response.arrayBuffer());
  const [width, height] = [number(response, "X-Width"), number(response, "X-Height")];
  return { rgba, width, height, findings: findingsOf(response) };
}

/**
 * Returns heights in pixels, NaN off the object, or null if a newer request came in between.
 * @param {Request} request @param {AbortSignal} [signal]
 */
export async function height(request, signal) {
  const response = await post("/api/height", request, signal);
  if (response.status === 204) return null;
  const heights = new Float32Array(await response.arrayBuffer());
  return { heights, width: number(response, "X-Width"), height: number(response, "X-Height") };
}

/**
 * Returns how unsure the model is, a share of a right angle as 0 to 255, or null if a newer request came in between.
 * @param {Request} request
 */
export async function doubt(request) {
  const response = await post("/api/uncertainty", request);
  if (response.status === 204) return null;
  const shares = new Uint8Array(await response.arrayBuffer());
  return { shares, width: number(response, "X-Width"), height: number(response, "X-Height"), known: shares.length > 0 };
}

/** @param {Request} request @returns {Promise<{x: number, y: number, normal: import("../drawing/document.js").Normal, gain: number}[]>} */
export const suggest = async (request) => (await (await post("/api/suggest", request)).json()).points;

/** Returns a file and what it is called. @param {Request} request @returns {Promise<{blob: Blob, name: string}>} */
export async function exported(request) {
  const response = await post("/api/export", request);
  const header = response.headers.get("Content-Disposition") ?? "";
  const encoded = /filename\*=utf-8''([^;]+)/i.exec(header)?.[1];
  const name = encoded ? decodeURIComponent(encoded) : /filename="?([^";]+)/.exec(header)?.[1];
  return { blob: await response.blob(), name: name ?? "drawing" };
}

/**
 * @typedef {{name: string, reason: string}} LayerNote a layer that is left out, or not shown as its program shows it
 * @typedef {{picture: string, width: number, height: number, given: [number, number], layered: boolean, parts: number,
 *   pages: boolean, notes: LayerNote[]}} Imported picture: base64 of a PNG; given: width and height of the file; layered: whether it may
 *   have layers; parts: how many pages or frames it has; pages: whether they are pages
 * @typedef {{name: string, opacity: number, picture: string, x: number, y: number, width: number, height: number}} ImportedLayer
 *   opacity: 0 to 1, which the picture does not have; x, y, width, height: where it lies in the whole
 * @typedef {{layers: ImportedLayer[], plain: string[], notes: LayerNote[], frames: number, width: number, height: number, given: [number, number]}} ImportedLayers
 *   layers: the hindmost first; plain: names of those that are all paper, and left out;
 *   notes: those that are not shown as their program shows them, and why
 */

/** @param {Blob} file @param {string} path */
function sendFile(file, path) {
  // What kind a file is, its content tells: what the system calls it may be wrong, or something else than a picture.
  const headers = { "Content-Type": file.type.startsWith("image/") ? file.type : "application/octet-stream" };
  return ask(path, { method: "POST", body: file, headers });
}

/** Reads an image file of any kind. @param {Blob} file @param {number} [part] which of its pages or frames, from 1 @returns {Promise<Imported>} */
export const imported = async (file, part = 1) => (await sendFile(file, part > 1 ? `/api/import?part=${part}` : "/api/import")).json();

/** Reads the visible layers of a layered file. @param {Blob} file @returns {Promise<ImportedLayers>} */
export const importedLayers = async (file) => (await sendFile(file, "/api/import?as=layers")).json();

/** Projects and autosaves: documents in a folder of the server. @param {string} path */
const folder = (path) => ({
  /** @returns {Promise<{name: string, changed: string}[]>} */
  list: async () => (await ask(path, inTime())).json(),
  /** @param {string} name */
  read: async (name) => {
    const response = await ask(`${path}/${encodeURIComponent(name)}`);
    return { doc: await response.json(), etag: response.headers.get("ETag") };
  },
  /**
   * Writes a document; `etag` null writes only a new one, undefined whatever is there.
   * @param {string} name @param {object} doc @param {string | null} [etag]
   */
  write: async (name, doc, etag) => {
    /** @type {Record<string, string>} */
    const guard = etag === null ? { "If-None-Match": "*" } : etag ? { "If-Match": etag } : {};
    const headers = { "Content-Type": "application/json", ...guard };
    const options = { method: "PUT", body: JSON.stringify(doc), headers };
    return (await ask(`${path}/${encodeURIComponent(name)}`, options)).headers.get("ETag");
  },
  /** @param {string} name @param {string | null} [etag] */
  remove: async (name, etag) => {
    /** @type {Record<string, string>} */
    const headers = etag ? { "If-Match": etag } : {};
    await ask(`${path}/${encodeURIComponent(name)}`, { method: "DELETE", headers });
  },
});

export const projects = folder("/api/projects");
export const autosaves = folder("/api/autosave");
