/** Worker: runs the method outside the page's thread, so that the pen never waits for it. */

import { compose } from "./compose.js";
import { expectedError, waysToSee } from "./context.js";
import { tileOf } from "./drawing/structures.js";
import { certaintyOf, finish, hintsOff } from "./finish.js";
import { byHand, hold } from "./hold.js";
import { Unpaintable, prepare } from "./prepare.js";
import { doubt, suggest } from "./suggest.js";

/** @typedef {{pixels: Uint8Array, width: number, height: number, channels: number}} Plane */
/**
 * @typedef {object} Layer
 * @property {string} name
 * @property {Plane} ink
 * @property {import("./hold.js").MaskStroke[]} strokes of the mask brush
 * @property {import("./drawing/document.js").Hint[]} hints
 * @property {import("./drawing/document.js").Area[]} areas
 * @property {import("./drawing/document.js").Source} source
 * @property {import("./drawing/document.js").Form | null} form
 * @property {Record<string, string>} structures PNGs as base64, by the names that areas use
 */
/**
 * @typedef {import("./result/findings.js").Finding} Finding
 * @typedef {{id: number, layers: Layer[], longest: number | null, what: "map" | "exact" | "doubt" | "points", count: number, changedOnly: boolean}} PaintRequest
 *   layers: from back to front; what: the kind of answer; count: number of points; changedOnly: whether unchanged layers are
 *   shown as before, although each is predicted among all
 * @typedef {import("./compose.js").LayerMap & {findings: Finding[], certainty: () => Float32Array}} Painted certainty: the model's κ
 * @typedef {{rgba: Uint8Array, width: number, height: number, findings: Finding[], normals?: Float32Array, mask?: Uint8Array, covered?: Float32Array,
 *   shares?: Uint8Array, points?: import("./suggest.js").Point[]}} Answer
 */

/** Pixel budget of the kept maps: of several layers, usually only one is predicted again. */
const KEPT = 2 ** 23;
/** Number of kept answers of networks: layers alone, all layers together, and the reader's, which all sizes of a picture share. */
const INFERRED = 16;
const [predicting, reading] = ["ours refiner", "reader"].map((name) => new Worker(new URL("networks.js", import.meta.url), { type: "module", name }));
/** The worker of each network; the reader runs while the model predicts. @type {Record<string, Worker>} */
const networks = { ours: predicting, refiner: predicting, reader: reading };
/** @type {Map<number, {resolve: (found: Record<string, Float32Array>) => void, reject: (error: Error) => void}>} */
const running = new Map();
let runs = 0;
const ready = load();
/** @type {Map<string, Promise<Record<string, Float32Array>>>} */
const inferred = new Map();
/** @type {Map<string, import("./prepare.js").Prepared>} kept because only the hints change while a pin is turned */
const prepared = new Map();
/** @type {Map<string, Painted>} */
const painted = new Map();
/** @type {Promise<unknown>} one at a time */
let turn = Promise.resolve();
/** @type {Set<number>} cancelled requests */
const dropped = new Set();
/** The request in progress. */
let current = 0;

/** Returns a file of the model. @param {string} name */
async function file(name) {
  const answer = await fetch(new URL(name, import.meta.url));
  if (!answer.ok) throw new Error("no_model");
  return answer;
}

/** Gives the workers of the networks their runtime, which is compressed with gzip. */
async function giveRuntime() {
  const { body } = await file("ort-wasm-simd-threaded.wasm.packed");
  if (!body) throw new Error("no_model");
  const runtime = await new Response(body.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  for (const each of [predicting, reading]) each.postMessage({ runtime });
}

async function load() {
  /** @param {Worker} worker @returns {Promise<number>} side of its first network's pictures */
  const loaded = (worker) => new Promise((resolve, reject) => {
    worker.addEventListener("message", ({ data }) => {
      const waiting = running.get(data.id);
      running.delete(data.id);
      if ("size" in data) resolve(data.size);
      else if (data.found) waiting?.resolve(data.found);
      else (waiting?.reject ?? reject)(new Error(data.failed));
    });
    worker.addEventListener("error", () => reject(new Error("no_modules")));
  });
  const sides = Promise.all([predicting, reading].map(loaded));
  const [notes] = await Promise.all([file("model.json"), giveRuntime()]);
  /** @type {{line_widths: [number, number], structures: string[]}} */
  const { line_widths: widths, structures } = await notes.json();
  // Once loaded, the page works without a network; a stroke with a structure that did not load reports it.
  const [[size]] = await Promise.all([sides, Promise.allSettled(structures.map((kind) => tileOf(kind)))]);
  return { widths, size };
}

/** Runs a network, if its answer is still wanted. @param {string} name @param {import("./networks.js").Run["planes"]} planes @returns {Promise<Record<string, Float32Array>>} */
function run(name, planes) {
  if (dropped.has(current)) return Promise.reject(new Error("this is no longer wanted"));
  const id = ++runs;
  return new Promise((resolve, reject) => {
    running.set(id, { resolve, reject });
    networks[name].postMessage({ id, name, planes });
  });
}

/** @type {import("./finish.js").Refiner} */
const refiner = async (data, width, height) => (await run("refiner", { planes: { data, shape: [1, 6, height, width] } })).normal;
/** @type {import("./reader.js").Network} */
const reader = async (data, width, height) => (await runOnce("reader", { picture: { data, shape: [1, 3, height, width] } })).read;

/** Returns the network's prediction. @param {Float32Array} seen @param {Float32Array} hints as planes @param {number} size */
const infer = (seen, hints, size) => runOnce("ours", { sketch: { data: seen, shape: [1, 1, size, size] }, hints: { data: hints, shape: [1, 4, size, size] } });

/** Runs a network, or returns the kept answer to the same inputs. @type {typeof run} */
function runOnce(name, planes) {
  const key = [name, ...Object.values(planes).map(({ data, shape }) => `${shape} ${digest(new Uint8Array(data.buffer))}`)].join();
  const found = inferred.get(key) ?? run(name, planes);
  inferred.delete(key);
  inferred.set(key, found);
  found.catch(() => inferred.delete(key));
  for (const oldest of inferred.keys()) if (inferred.size > INFERRED) inferred.delete(oldest);
  return found;
}

/**
 * Returns the kept value, or computes and keeps it, and drops the oldest values.
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

/** @param {Layer} layer @param {number | null} longest @param {boolean} alone whether the network sees it alone: it begins at once then */
async function prepareLayer({ ink, source, hints }, longest, alone) {
  const { widths, size } = await ready;
  const key = JSON.stringify([digest(ink.pixels), ink.width, ink.height, ink.channels, source, longest]);
  /** @param {Float32Array} seen @param {import("./prepare.js").Frame} frame @param {number} scale */
  const begin = (seen, frame, scale) => { if (alone) void infer(seen, hintPlanes(hints, scale, frame), size); };
  return { key, lines: await recalled(prepared, key, () => prepare(ink, size, source, longest, widths, reader, begin)) };
}

/** @param {Layer} layer @param {import("./prepare.js").Prepared[]} ways to see it @param {string} key of everything that the result depends on @returns {Promise<Painted>} */
async function paintLayer({ ink, strokes, hints, areas, form, structures }, ways, key) {
  const { size } = await ready;
  return recalled(painted, key, async () => {
    const { width: wide, height: high } = ways[0];
    const enlarged = wide / ink.width;
    const tried = [];
    for (const lines of ways) {
      const { normal, confidence } = await infer(lines.seen, hintPlanes(hints, enlarged, lines.frame), size);
      tried.push({ lines, normal, confidence });
    }
    const [{ lines, normal, confidence }] = ways.length > 1 ? byError(tried) : tried;
    const { normals, mask, covered, width, height, findings: said } = await finish(lines, normal, refiner, byHand(strokes, wide, high, enlarged, lines.ink));
    const scale = width / ink.width;
    const placed = said.map((each) => inDrawing(each, enlarged));
    const findings = [...placed, ...hintsOff(hints.filter((hint) => hint.reach === undefined), scale, { mask, width, height })];
    hold({ normals, mask, width, height }, hints, areas, form, scale, await tilesOf(areas, structures));
    // Few requests need it, and it is as large as the map.
    return { normals, mask, covered, width, height, findings, confidence: null, certainty: () => certaintyOf(confidence, lines) };
  });
}

/** Returns a finding with its places and outlines in pixels of the drawing. @param {Finding} finding @param {number} enlarged pixels of the finding for one of these @returns {Finding} */
function inDrawing({ places, outlines, ...rest }, enlarged) {
  if (!places) return rest;
  const shrunk = places.map(([x, y]) => /** @type {[number, number]} */ ([x / enlarged, y / enlarged]));
  return { ...rest, places: shrunk, ...(outlines && { outlines: outlines.map((lines) => lines.map((line) => line.map((each) => each / enlarged))) }) };
}

/** Returns the tiles of all structures, by picture or kind. @param {Layer["areas"]} areas @param {Layer["structures"]} structures */
async function tilesOf(areas, structures) {
  const used = areas.flatMap(({ structure }) => structure ?? []);
  return new Map(await Promise.all(used.map(async ({ kind, picture }) =>
    /** @type {const} */ ([picture ?? kind, await tileOf(kind, picture === undefined ? undefined : structures[picture])]))));
}

/** Returns the attempts, with the lowest expected error first. @template {{lines: import("./prepare.js").Prepared, confidence: Float32Array}} T @param {T[]} tried */
const byError = (tried) => tried.map((each) => ({ each, error: expectedError(each.lines, each.confidence) })).sort((a, b) => a.error - b.error).map(({ each }) => each);

/**
 * Predicts each layer, alone or among the others.
 * @param {Pick<PaintRequest, "layers" | "longest" | "changedOnly">} request
 * @returns {Promise<{maps: Painted[], findings: Finding[]}>} maps of the layers that can be predicted, at least one
 * @throws {Unpaintable} if none can be.
 */
async function paintLayers({ layers, longest, changedOnly }) {
  const { widths } = await ready;
  /** @type {Painted[]} */
  const maps = [];
  /** @type {{layer: Layer, name: string, key: string, lines: import("./prepare.js").Prepared}[]} */
  const parts = [];
  /** @type {{finding: Finding, layer: number}[]} layer: the number of its map */
  const said = [];
  /** @type {Finding[]} */
  const lacks = [];
  /** @param {string} name @param {unknown} error */
  const without = (name, error) => {
    if (!(error instanceof Unpaintable)) throw error;
    lacks.push({ code: error.code, layer: name });
  };
  for (const layer of layers) {
    // With a single layer its name is not needed.
    const name = layers.length > 1 ? layer.name : "";
    await prepareLayer(layer, longest, layers.length === 1).then((found) => parts.push({ layer, name, ...found }), (error) => without(name, error));
  }
  const ways = waysToSee(parts.map(({ lines }) => lines), widths);
  const all = parts.length > 1 ? digest(new TextEncoder().encode(parts.map(({ key }) => key).join())) : 0;
  for (const [i, { layer, name, key, lines }] of parts.entries()) {
    const own = JSON.stringify([key, layer.strokes, layer.hints, layer.areas, layer.form, Object.keys(layer.structures)]);
    const before = changedOnly ? [...painted.keys()].findLast((each) => each.startsWith(own)) : undefined;
    try {
      const found = await paintLayer(layer, ways[i], before ?? `${own} ${all}`);
      maps.push(found);
      const number = maps.length - 1;
      said.push(...found.findings.map((each) => ({ finding: { ...each, layer: name }, layer: number })));
      // Among other layers it is a part of something, and may be in pieces.
      if (layers.length === 1) said.push(...lines.figures.map((each) => ({ finding: inDrawing(each, lines.width / layer.ink.width), layer: number })));
      if (found.findings.length && parts.length > 1 && ways[i].length === 1) said.push({ finding: { code: "alone", layer: name }, layer: number });
    } catch (error) {
      without(name, error);
    }
  }
  if (!maps.length) throw new Unpaintable(lacks[0]?.code ?? "no_lines", lacks[0]?.layer);
  // Nobody sees where the edge of a part ends behind another.
  const inSight = said.filter(({ finding: { code, places = [] }, layer }) => code !== "edge" || !places.every(([x, y]) => maps.slice(layer + 1).some((map) => {
    const scale = map.width / layers[0].ink.width;
    return map.mask[Math.floor(y * scale) * map.width + Math.floor(x * scale)];
  })));
  return { maps, findings: [...inSight.map(({ finding }) => finding), ...lacks] };
}

/** @param {PaintRequest} request @returns {Promise<Answer>} */
async function paint({ layers, longest, what, count, changedOnly }) {
  const { maps, findings } = await paintLayers({ layers, longest, changedOnly });
  const unsure = what === "doubt" || what === "points";
  const map = compose(maps.map((each) => ({ ...each, confidence: unsure ? each.certainty() : null })));
  const { normals, mask, covered, width, height, confidence } = map;
  const rgba = new Uint8Array(4 * width * height);
  for (let i = 0; i < mask.length; i++) {
    // Bytes cut off the fraction, which is faster than `Math.round`.
    for (let c = 0; c < 3; c++) rgba[4 * i + c] = (normals[3 * i + c] + 1) * 127.5 + 0.5;
    rgba[4 * i + 3] = 255 * covered[i] + 0.5;
  }
  const answer = { rgba, width, height, findings };
  if (what === "exact") return { ...answer, normals: normals.slice(), mask: mask.slice(), covered: covered.slice() };
  if (what === "doubt") {
    return { ...answer, shares: Uint8Array.from(mask, (there, i) => (there && confidence ? Math.round(255 * Math.min(doubt(confidence[i]), 1)) : 0)) };
  }
  if (what === "points") return { ...answer, points: suggest(map, confidence, layers.flatMap(({ hints }) => hints), count, linesOf(layers)) };
  return answer;
}

/** Returns where there is ink: dark pixels of any colour. @param {Layer[]} layers of one size */
function linesOf(layers) {
  const lines = new Uint8Array(layers[0].ink.width * layers[0].ink.height);
  for (const { ink: { pixels, channels } } of layers) {
    for (let i = 0, at = 0; i < lines.length; i++, at += channels) {
      if (channels === 1 ? pixels[at] < 128 : Math.min(pixels[at], pixels[at + 1], pixels[at + 2]) < 128 && pixels[at + 3] > 127) lines[i] = 1;
    }
  }
  return lines;
}

/** Returns the network's hints: mean normals at the pins without a reach of their own, and their places. @param {import("./drawing/document.js").Hint[]} hints @param {number} scale @param {import("./prepare.js").Frame} frame */
function hintPlanes(hints, scale, { left, top, side, size }) {
  const area = size * size;
  const planes = new Float32Array(4 * area);
  for (const { x, y, normal, reach } of hints) {
    if (reach !== undefined) continue;
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

/** Returns a hash of bytes (FNV-1a). @param {Uint8Array} bytes */
function digest(bytes) {
  let hash = 0x811c9dc5;
  for (const byte of bytes) hash = Math.imul(hash ^ byte, 0x01000193);
  return hash >>> 0;
}

ready.then(({ size }) => postMessage({ size }), (error) => postMessage({ failed: String(error.message ?? error) }));
addEventListener("message", (/** @type {MessageEvent<PaintRequest | {drop: number}>} */ { data }) => {
  if ("drop" in data) {
    dropped.add(data.drop);
    return;
  }
  turn = turn.then(async () => {
    current = data.id;
    try {
      const painted = await paint(data);
      postMessage({ id: data.id, painted }, { transfer: [painted.rgba.buffer] });
    } catch (error) {
      const message = error instanceof Error ? error.message : String(error);
      postMessage(error instanceof Unpaintable ? { id: data.id, lacks: [{ code: error.code, layer: error.layer }] } : { id: data.id, failed: message });
    }
    dropped.delete(data.id);
  });
});
