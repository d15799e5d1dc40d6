/** Worker: the network and what is about it, beside the page, so that the pen never waits for them. */

import * as ort from "./ort.wasm.min.mjs";
import { compose } from "./compose.js";
import { inContext } from "./context.js";
import { finish, hintsOff, restored } from "./finish.js";
import { byHand, hold } from "./hold.js";
import { Unpaintable, prepare } from "./prepare.js";
import { doubt, suggest } from "./suggest.js";

// How many threads it takes is the runtime's choice: half the cores, up to four, where the page is isolated, and else one. The
// service worker sends the headers for that, from the second visit on.
ort.env.wasm.wasmPaths = new URL("./", import.meta.url).href;
const RUNTIME = "ort-wasm-simd-threaded.wasm.packed"; // by gzip

/** @typedef {{pixels: Uint8Array, width: number, height: number, channels: number}} Plane */
/**
 * @typedef {object} Layer
 * @property {string} name
 * @property {Plane} ink
 * @property {import("./hold.js").MaskStroke[]} strokes of the mask brush
 * @property {import("./document.js").Hint[]} hints
 * @property {import("./document.js").Area[]} areas
 * @property {import("./document.js").Source} source
 * @property {import("./document.js").Form | null} form
 */
/**
 * @typedef {{id: number, layers: Layer[], longest: number | null, what: "map" | "exact" | "doubt" | "points", count: number}} Wish
 *   layers: the hindmost first; what is to be answered; count: of points
 * @typedef {import("./compose.js").LayerMap & {warning: string, certainty: () => Float32Array}} Painted certainty: the model's κ
 * @typedef {{rgba: Uint8Array, width: number, height: number, warning: string, normals?: Float32Array, mask?: Uint8Array, covered?: Float32Array,
 *   shares?: Uint8Array, points?: import("./suggest.js").Point[]}} Answer
 */

/** Pixels of what is kept: of several layers only one is painted again. */
const KEPT = 2 ** 23;
const runtime = unpack();
const ready = load();
/** @type {Map<string, import("./prepare.js").Prepared>} while a pin is turned, nothing but the hints changes */
const prepared = new Map();
/** @type {Map<string, Painted>} */
const painted = new Map();
/** @type {Promise<unknown>} one at a time */
let turn = Promise.resolve();

async function load() {
  const [session, second, third, notes] = await Promise.all([network("ours.onnx"), network("refiner.onnx"), network("reader.onnx"), file("model.json")]);
  /** @type {{line_widths: [number, number]}} */
  const { line_widths: widths } = await notes.json();
  /** @type {import("./finish.js").Refiner} */
  const refiner = async (planes, width, height) => {
    const { normal } = await second.run({ planes: new ort.Tensor("float32", planes, [1, 6, height, width]) });
    return normal.data;
  };
  /** @type {import("./reader.js").Network} */
  const reader = async (picture, width, height) => {
    const { read } = await third.run({ picture: new ort.Tensor("float32", picture, [1, 3, height, width]) });
    return read.data;
  };
  return { session, refiner, reader, widths, size: Number(session.inputMetadata[0].shape[3]) };
}

/** @param {string} name */
async function file(name) {
  const answer = await fetch(new URL(name, import.meta.url));
  if (!answer.ok) throw new Error("the model cannot be fetched");
  return answer;
}

async function unpack() {
  const { body } = await file(RUNTIME);
  if (!body) throw new Error(`${RUNTIME} is empty`);
  ort.env.wasm.wasmBinary = await new Response(body.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

/** @param {string} name */
async function network(name) {
  const [answer] = await Promise.all([file(name), runtime]);
  return ort.InferenceSession.create(new Uint8Array(await answer.arrayBuffer()), { executionProviders: ["wasm"] });
}

/**
 * Returns what was kept, or makes and keeps it; the oldest go.
 * @template {{width: number, height: number}} T
 * @param {Map<string, T>} kept @param {string} key @param {() => T | Promise<T>} make
 * @returns {Promise<T>}
 */
async function recalled(kept, key, make) {
  const found = kept.get(key) ?? await make();
  kept.delete(key);
  kept.set(key, found);
  let pixels = [...kept.values()].reduce((sum, { width, height }) => sum + width * height, 0);
  for (const [old, { width, height }] of kept) {
    if (pixels <= KEPT || kept.size === 1) break;
    pixels -= width * height;
    kept.delete(old);
  }
  return found;
}

/** @param {Layer} layer @param {number | null} longest */
async function prepareLayer({ ink, source }, longest) {
  const { reader, widths, size } = await ready;
  const key = JSON.stringify([digest(ink.pixels), ink.width, ink.height, ink.channels, source, longest]);
  return { key, lines: await recalled(prepared, key, () => prepare(ink, size, source, longest, widths, reader)) };
}

/** @param {Layer} layer @param {import("./prepare.js").Prepared} lines as they are seen among others @param {string} key what that depends on @returns {Promise<Painted>} */
async function paintLayer({ ink, strokes, hints, areas, form }, lines, key) {
  const { session, refiner, size } = await ready;
  return recalled(painted, JSON.stringify([key, strokes, hints, areas, form]), async () => {
    const { width, height, frame } = lines;
    const scale = width / ink.width;
    const given = hintPlanes(hints.filter((hint) => hint.reach === undefined), scale, frame);
    const feeds = { sketch: new ort.Tensor("float32", lines.seen, [1, 1, size, size]), hints: new ort.Tensor("float32", given, [1, 4, size, size]) };
    const { normal, confidence } = await session.run(feeds);
    const { normals, mask, covered, warning: said } = await finish(lines, normal.data, refiner, byHand(strokes, width, height, scale, lines.ink));
    const warning = [said, hintsOff(hints.filter((hint) => hint.reach === undefined), scale, { mask, width, height })].filter(Boolean).join("; ");
    hold({ normals, mask, width, height }, hints, areas, form, scale);
    // Only few ask for it, and it is as large as the map.
    return { normals, mask, covered, width, height, warning, confidence: null, certainty: () => restored(confidence.data, lines, 1) };
  });
}

/** @param {Wish} wish @returns {Promise<Answer>} */
async function paint({ layers, longest, what, count }) {
  const { widths } = await ready;
  /** @type {Painted[]} */
  const maps = [];
  /** @type {{layer: Layer, name: string, key: string, lines: import("./prepare.js").Prepared}[]} */
  const parts = [];
  /** @type {string[]} */
  const said = [];
  /** @type {Unpaintable | null} */
  let first = null;
  /** @param {string} name @param {unknown} error */
  const lacks = (name, error) => {
    if (!(error instanceof Unpaintable)) throw error;
    first ??= new Unpaintable(`${name}${error.message}`);
    said.push(`${name}${error.message.replace(/\.$/, "")}`);
  };
  for (const layer of layers) {
    // Of one layer it is clear which is meant.
    const name = layers.length > 1 ? `${layer.name}: ` : "";
    await prepareLayer(layer, longest).then((found) => parts.push({ layer, name, ...found }), (error) => lacks(name, error));
  }
  const among = inContext(parts.map(({ lines }) => lines), widths);
  const all = parts.length > 1 ? digest(new TextEncoder().encode(parts.map(({ key }) => key).join())) : 0;
  for (const [i, { layer, name, key }] of parts.entries()) {
    try {
      const found = await paintLayer(layer, among[i], `${key} ${all}`);
      maps.push(found);
      if (found.warning) said.push(`${name}${found.warning}`);
    } catch (error) {
      lacks(name, error);
    }
  }
  if (!maps.length) throw first ?? new Unpaintable("there is nothing to be painted.");
  const unsure = what === "doubt" || what === "points";
  const map = compose(maps.map((each) => ({ ...each, confidence: unsure ? each.certainty() : null })));
  const { normals, mask, covered, width, height, confidence } = map;
  const rgba = new Uint8Array(4 * width * height);
  for (let i = 0; i < mask.length; i++) {
    for (let c = 0; c < 3; c++) rgba[4 * i + c] = Math.round((normals[3 * i + c] + 1) * 127.5);
    rgba[4 * i + 3] = Math.round(255 * covered[i]);
  }
  const answer = { rgba, width, height, warning: said.join("; ") };
  if (what === "exact") return { ...answer, normals: normals.slice(), mask: mask.slice(), covered: covered.slice() };
  if (what === "doubt") {
    return { ...answer, shares: Uint8Array.from(mask, (there, i) => (there && confidence ? Math.round(255 * Math.min(doubt(confidence[i]), 1)) : 0)) };
  }
  if (what === "points") return { ...answer, points: suggest(map, confidence, layers.flatMap(({ hints }) => hints), count) };
  return answer;
}

/** Returns what the network is told: mean normals at the pins, and where they are. @param {import("./document.js").Hint[]} hints @param {number} scale @param {import("./prepare.js").Frame} frame */
function hintPlanes(hints, scale, { left, top, side, size }) {
  const area = size * size;
  const planes = new Float32Array(4 * area);
  for (const { x, y, normal } of hints) {
    const column = Math.floor(((x * scale - left) * size) / side);
    const row = Math.floor(((y * scale - top) * size) / side);
    if (column < 0 || row < 0 || column >= size || row >= size) continue;
    for (let c = 0; c < 3; c++) planes[c * area + row * size + column] += normal[c];
    planes[3 * area + row * size + column] = 1;
  }
  for (let i = 0; i < area; i++) {
    if (!planes[3 * area + i]) continue;
    const length = Math.hypot(planes[i], planes[area + i], planes[2 * area + i]) || 1;
    for (let c = 0; c < 3; c++) planes[c * area + i] /= length;
  }
  return planes;
}

/** Returns a number that tells pictures apart (FNV-1a). @param {Uint8Array} bytes */
function digest(bytes) {
  let hash = 0x811c9dc5;
  for (const byte of bytes) hash = Math.imul(hash ^ byte, 0x01000193);
  return hash >>> 0;
}

ready.then(({ size }) => postMessage({ size }), (error) => postMessage({ failed: String(error.message ?? error) }));
addEventListener("message", (/** @type {MessageEvent<Wish>} */ { data }) => {
  turn = turn.then(async () => {
    try {
      postMessage({ id: data.id, painted: await paint(data) });
    } catch (error) {
      const message = error instanceof Error ? error.message : String(error);
      postMessage(error instanceof Unpaintable ? { id: data.id, lacks: message } : { id: data.id, failed: message });
    }
  });
});
