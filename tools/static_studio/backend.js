/**
 * Backend: answers the requests of the studio's page in the browser, in place of a server. It is loaded before the
 * page, which is the same as the server's, and replaces `fetch` for addresses under /api/.
 */

import { documents } from "./documents.js";
import { LIMITS } from "./drawing/limits.js";
import { corners } from "./drawing/simplify.js";
import { encodePng, levelsOf, padEdge } from "./png.js";

/** The outputs that can be exported without Python, with their formats. */
const EXPORTS = { map: ["png8", "png16"], lines: ["png"] };
/** Maximum distance of a figure's outline from its part of the page, in pixels of the drawing. */
const DETAIL = 1.5;
/** The number of layers whose pixels are kept. */
const MOST_KEPT = 64;
/** Messages for what may go wrong in the workers, by their codes. */
const SAID = /** @type {const} */ ({ no_model: "webNoModel", no_modules: "webNoModules" });
/** @typedef {{pixels: Uint8Array, width: number, height: number, channels: number}} Plane */
/** @typedef {import("./worker.js").Answer} Painted */

/** @type {Map<string, {number: number, planes: Map<string, Plane>}>} the last planes sent, for each layer of each tab */
const kept = new Map();
let asked = 0;
/** @type {Map<number, {resolve: (painted: Painted) => void, reject: (error: Error) => void}>} */
const waiting = new Map();
const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
/** @type {Promise<number>} side of the model's pictures */
const size = new Promise((resolve, reject) => {
  worker.addEventListener("message", ({ data }) => {
    if (data.size) resolve(data.size);
    if (data.failed && data.id === undefined) reject(new Error(data.failed));
    const asker = waiting.get(data.id);
    waiting.delete(data.id);
    if (data.painted) asker?.resolve(data.painted);
    else if (data.lacks) asker?.reject(new Lacking(data.lacks));
    else asker?.reject(new Error(data.failed));
  });
  worker.addEventListener("error", () => reject(new Error("no_modules")));
});
size.catch(() => {}); // reported with the first request

class Lacking extends Error {
  /** @param {import("./result/findings.js").Finding[]} findings */
  constructor(findings) {
    super();
    this.findings = findings;
  }
}

/** Returns a closed line with fewer points. @param {number[]} line x, y, x, y, … */
function simplified(line) {
  const points = Array.from({ length: line.length / 2 + 1 }, (_, i) => ({ x: line[(2 * i) % line.length], y: line[(2 * i + 1) % line.length] }));
  const away = points.map(({ x, y }) => Math.hypot(x - points[0].x, y - points[0].y));
  const half = away.indexOf(Math.max(...away));
  const kept = [...corners(points, DETAIL, 0, half).slice(0, -1), ...corners(points, DETAIL, half).slice(0, -1)];
  return kept.flatMap((i) => [Math.round(points[i].x), Math.round(points[i].y)]);
}

/** Returns findings with outlines of as many figures as there can be layers. @param {import("./result/findings.js").Finding[]} findings */
const outlined = (findings) => findings.map(({ outlines, ...rest }) => (outlines
  ? { ...rest, outlines: outlines.length > LIMITS.layers ? [] : outlines.map((lines) => lines.map(simplified)) }
  : rest));

/** @param {import("./result/findings.js").Finding[]} findings */
const findingsHeader = (findings) => ({ "X-Findings": encodeURIComponent(JSON.stringify(outlined(findings))) });

/** @param {unknown} value @param {number} [status] @param {Record<string, string>} [headers] */
const json = (value, status = 200, headers = {}) =>
  new Response(JSON.stringify(value), { status, headers: { "Content-Type": "application/json", ...headers } });
/** @param {string} error @param {number} status */
const refused = (error, status) => json({ error: error.replace(/[.。]?$/, (end) => end || ".") }, status);

/**
 * @param {string} key of the layer @param {Record<string, any>} fields @param {number} number of the request
 * @param {Uint8Array} pixels
 * @returns {Map<string, Plane> | null} null: all is to be sent
 */
function take(key, fields, number, pixels) {
  const based = fields.base !== null && fields.base !== undefined;
  const before = kept.get(key);
  if (based && before?.number !== fields.base) return null;
  /** @type {Map<string, Plane>} */
  const planes = new Map(based ? before?.planes : []);
  let at = 0;
  for (const { name, width, height, channels, box: [left, top, right, bottom] } of fields.planes) {
    const old = planes.get(name);
    const alike = old && old.width === width && old.height === height && old.channels === channels;
    const whole = right - left === width && bottom - top === height;
    if (!alike && !whole) return null;
    const plane = { pixels: whole || !old ? new Uint8Array(width * height * channels) : old.pixels.slice(), width, height, channels };
    const line = (right - left) * channels;
    for (let y = top; y < bottom; y++, at += line) plane.pixels.set(pixels.subarray(at, at + line), (y * width + left) * channels);
    planes.set(name, plane);
  }
  kept.delete(key);
  kept.set(key, { number, planes });
  for (const oldest of kept.keys()) if (kept.size > MOST_KEPT) kept.delete(oldest);
  return planes;
}

/**
 * @param {import("./worker.js").Layer[]} layers @param {number | null} longest
 * @param {{what?: import("./worker.js").PaintRequest["what"], count?: number, changedOnly?: boolean}} [more] count: of points
 * @param {AbortSignal | null} [signal]
 * @returns {Promise<Painted>}
 */
async function painted(layers, longest, { what = "map", count = 0, changedOnly = false } = {}, signal = null) {
  await size;
  const id = ++asked;
  return new Promise((resolve, reject) => {
    waiting.set(id, { resolve, reject });
    worker.postMessage({ id, layers, longest, what, count, changedOnly });
    signal?.addEventListener("abort", () => waiting.has(id) && worker.postMessage({ drop: id }));
  });
}

/** @param {string} path @param {Uint8Array} body @param {AbortSignal | null} [signal] */
async function drawing(path, body, signal) {
  const length = new DataView(body.buffer, body.byteOffset).getUint32(0, true);
  const fields = JSON.parse(new TextDecoder().decode(body.subarray(4, 4 + length)));
  const layers = [];
  let at = 4 + length;
  // A drawing with one layer may have no list of layers.
  for (const layer of fields.layers ?? [{ ...fields, id: 0, name: "", bytes: body.length - at }]) {
    const { id, name, bytes, hints = [], areas = [], mask_strokes: strokes = [], source = fields.source ?? null, form = null, structures = {} } = layer;
    const planes = take(`${fields.tab} ${id}`, layer, fields.number, body.subarray(at, at + bytes));
    at += bytes;
    const ink = planes?.get("ink");
    if (!ink) return refused("send all of the drawing", 409);
    layers.push({ name, ink, strokes, hints, areas, source, form, structures });
  }
  if (path === "/api/predict") {
    try {
      const { rgba, width, height, findings } = await painted(layers, fields.longest ?? null, { changedOnly: fields.changed_only }, signal);
      const headers = { "X-Width": String(width), "X-Height": String(height), ...findingsHeader(findings) };
      return new Response(/** @type {Uint8Array<ArrayBuffer>} */ (rgba), { headers });
    } catch (error) {
      if (error instanceof Lacking) return new Response(null, { status: 204, headers: findingsHeader(error.findings) });
      throw error;
    }
  }
  const bits = { png8: /** @type {const} */ (8), png16: /** @type {const} */ (16) }[String(fields.format)];
  if (path === "/api/export" && fields.what === "map" && bits) {
    const file = await png(await painted(layers, fields.size ?? null, { what: "exact" }), bits, fields.y === "down", fields.alpha !== false);
    const name = encodeURIComponent(`${fields.name}_normal.png`);
    return new Response(file, { headers: { "Content-Disposition": `attachment; filename*=UTF-8''${name}` } });
  }
  if (path === "/api/suggest") return json({ points: (await painted(layers, null, { what: "points", count: fields.count ?? 5 })).points });
  if (path === "/api/uncertainty") {
    const { shares, width, height } = await painted(layers, null, { what: "doubt" });
    return new Response(/** @type {Uint8Array<ArrayBuffer>} */ (shares), { headers: { "X-Width": String(width), "X-Height": String(height) } });
  }
  return needsPython();
}

/** Loaded late, because the page must not begin before this module. */
const words = () => import("./text/text.js");
const needsPython = async () => refused((await words()).text.webPython, 501);

/** Returns a map as a file. @param {Painted} map @param {8 | 16} bits @param {boolean} down whether green points down @param {boolean} transparent */
function png({ width, height, normals = new Float32Array(), mask = new Uint8Array(), covered = new Float32Array() }, bits, down, transparent) {
  const alpha = transparent ? covered.map((value) => Math.round(255 * value) / 255) : null;
  const levels = levelsOf(normals, mask, alpha, down, bits);
  if (alpha) padEdge(levels, width, height);
  return encodePng(levels, width, height, bits);
}

/** Returns whether a picture is not cut off: an image element shows what there is of it, but a bitmap is made of whole files alone. @param {Blob} file */
async function isWhole(file) {
  if (/^\s*</.test(await file.slice(0, 64).text())) return true; // an SVG, of which no bitmap can be made
  const bitmap = await createImageBitmap(file).catch(() => null);
  bitmap?.close();
  return bitmap !== null;
}

/** Reads a picture as the browser can. @param {Blob} file */
async function picture(file) {
  const image = new Image();
  image.src = URL.createObjectURL(file);
  try {
    await image.decode();
  } catch {
    return refused((await words()).text.webPicture, 400);
  } finally {
    URL.revokeObjectURL(image.src);
  }
  if (!(await isWhole(file))) return refused((await words()).text.webDamaged, 400);
  const given = [image.naturalWidth || 1024, image.naturalHeight || 1024];
  const { least, most } = LIMITS.sides;
  const scale = Math.min(1, most / Math.max(...given));
  const [width, height] = given.map((side) => Math.max(1, Math.round(side * scale)));
  if (Math.min(width, height) < least) return refused((await words()).say("webSmall", { width, height, least, most }), 400);
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  const [, content] = canvas.toDataURL("image/png").split(",");
  return json({ picture: content, width: canvas.width, height: canvas.height, given, layered: false, parts: 1, pages: false, notes: [] });
}

/** @param {string} path @param {RequestInit} options @returns {Promise<Response>} */
async function answer(path, { method = "GET", body, headers, signal }) {
  try {
    const stored = /^\/api\/(projects|autosave)(?:\/(.+))?$/.exec(path);
    if (stored) return await documents(stored[1], stored[2] && decodeURIComponent(stored[2]), method, new Headers(headers), String(body ?? ""));
    if (path === "/api/about") {
      return json({ version: "in the browser", model: { name: "ours.onnx", size: await size, confidence: true }, limits: { side: LIMITS.sides.most }, exports: EXPORTS });
    }
    if (path === "/api/open") return json(null);
    if (path === "/api/import" && body instanceof Blob) return await picture(body);
    if (body instanceof Blob) return await drawing(path, new Uint8Array(await body.arrayBuffer()), signal);
    if (body instanceof Uint8Array) return await drawing(path, body, signal);
    return await needsPython();
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    return refused(message in SAID ? (await words()).text[SAID[/** @type {keyof typeof SAID} */ (message)]] : message, 500);
  }
}

// It lets the page open again without a network. Some browsers have no service workers, or none in private windows.
globalThis.navigator.serviceWorker?.register("service_worker.js").catch(() => {});

const beyond = globalThis.fetch;
/** @param {RequestInfo | URL} address @param {RequestInit} [options] */
globalThis.fetch = async (address, options = {}) => {
  if (typeof address !== "string" || !address.startsWith("/api/")) return beyond(address, options);
  const found = await answer(address, options);
  options.signal?.throwIfAborted();
  return found;
};
