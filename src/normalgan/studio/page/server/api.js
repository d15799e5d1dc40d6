/** The server's API as functions, each of which throws `Refused` (with a reason) or `Away` (no answer). */

/**
 * @typedef {import("../result/findings.js").Finding} Finding
 * @typedef {{fields: Record<string, unknown>, pixels: Uint8Array[]}} Request
 *   about a drawing: the fields of the request, and the bytes of its planes or of the changed boxes
 */

/** The server's error message. */
export class Refused extends Error {
  /** @param {number} status @param {string} message */
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

/** @param {unknown} error @returns {boolean} whether the server reports that it has no such document */
export const isGone = (error) => error instanceof Refused && error.status === 404;

/** The drawing cannot be predicted yet, or any longer. */
export class Lacking extends Error {
  /** @param {Finding[]} findings the reasons */
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

/** Number of bytes from which a body is sent as a blob: Chromium passes plain bytes to its network process in one piece, and the page waits for it. */
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

/** Milliseconds after which a silent server counts as away, where the page waits for it at the start. */
const PATIENCE = 10_000;
const inTime = () => ({ signal: AbortSignal.timeout(PATIENCE) });

/**
 * Returns the server's description; `exports`: the outputs that can be exported with their formats, all if it is missing.
 * @returns {Promise<{version: string, model: {name: string, size: number}, exports?: Record<string, string[]>}>}
 */
export const about = async () => (await ask("/api/about")).json();

/** Returns the files named on the command line. @returns {Promise<{kind: string, name: string, [more: string]: any} | null>} */
export const named = async () => (await ask("/api/open", inTime())).json();

/** Returns the drawing's file named on the command line. @param {string} name @returns {Promise<File>} */
export const namedFile = async (name) => new File([await (await ask("/api/open/file", inTime())).blob()], name);

/**
 * Returns a predicted map, or null if a newer request came in between.
 * @param {Request} request @param {AbortSignal} [signal]
 * @throws {Lacking} if there is nothing to predict.
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
 * Returns the model's uncertainty, as a share of a right angle from 0 to 255, or null if a newer request came in between.
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

/** Returns a file with its name. @param {Request} request @returns {Promise<{blob: Blob, name: string}>} */
export async function exported(request) {
  const response = await post("/api/export", request);
  const header = response.headers.get("Content-Disposition") ?? "";
  const encoded = /filename\*=utf-8''([^;]+)/i.exec(header)?.[1];
  const name = encoded ? decodeURIComponent(encoded) : /filename="?([^";]+)/.exec(header)?.[1];
  return { blob: await response.blob(), name: name ?? "drawing" };
}

/**
 * @typedef {{name: string, reason: string}} LayerNote a layer that is left out, or looks different from its program
 * @typedef {{picture: string, width: number, height: number, given: [number, number], layered: boolean, parts: number,
 *   pages: boolean, notes: LayerNote[]}} Imported picture: base64 of a PNG; given: width and height of the file; layered: whether it may
 *   have layers; parts: the number of pages or frames; pages: whether they are pages
 * @typedef {{name: string, opacity: number, picture: string, x: number, y: number, width: number, height: number}} ImportedLayer
 *   opacity: 0 to 1, not included in the picture; x, y, width, height: its place in the whole
 * @typedef {{layers: ImportedLayer[], plain: string[], notes: LayerNote[], frames: number, width: number, height: number, given: [number, number]}} ImportedLayers
 *   layers: from back to front; plain: names of layers that were left out because they are only paper;
 *   notes: layers that look different from their program, with the reasons
 */

/** @param {Blob} file @param {string} path */
function sendFile(file, path) {
  // The server determines the kind of file from its content: the system's type may be wrong, or not that of a picture.
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
