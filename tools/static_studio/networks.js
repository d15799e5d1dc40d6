/** Networks: runs the networks that the worker's name lists in their own worker, so that the object can be found meanwhile. */

import * as ort from "./ort.wasm.min.mjs";

// The runtime chooses the number of threads: half the cores up to four where the page is isolated, otherwise one. The
// service worker sends the headers for isolation from the second visit on.
ort.env.wasm.wasmPaths = new URL("./", import.meta.url).href;

/** @typedef {{id: number, name: string, planes: Record<string, {data: Float32Array, shape: number[]}>}} Run of one network, with its inputs */

/** @type {() => void} */
let begin = () => {};
/** Resolves when the runtime has come, which is unpacked once for all workers. @type {Promise<void>} */
const runtime = new Promise((resolve) => { begin = resolve; });
/** @type {Record<string, Promise<import("./ort.wasm.min.mjs").InferenceSession>>} */
const sessions = Object.fromEntries(self.name.split(" ").map((name) => [name, network(`${name}.onnx`)]));

/** @param {string} name */
async function network(name) {
  const [answer] = await Promise.all([fetch(new URL(name, import.meta.url)), runtime]);
  if (!answer.ok) throw new Error("no_model");
  return ort.InferenceSession.create(new Uint8Array(await answer.arrayBuffer()), { executionProviders: ["wasm"] });
}

/** @param {Run} run @returns {Promise<Record<string, Float32Array>>} */
async function run({ name, planes }) {
  const feeds = Object.fromEntries(Object.entries(planes).map(([key, { data, shape }]) => [key, new ort.Tensor("float32", data, shape)]));
  const found = await (await sessions[name]).run(feeds);
  // Copied, because a network's output lies in the runtime's memory.
  return Object.fromEntries(Object.entries(found).map(([key, { data }]) => [key, data.slice()]));
}

const failed = (/** @type {unknown} */ error) => String(error instanceof Error ? error.message : error);
Promise.all(Object.values(sessions)).then(([first]) => postMessage({ size: Number(first.inputMetadata[0].shape[3]) }), (error) => postMessage({ failed: failed(error) }));
/** @type {Promise<void>} one at a time */
let turn = Promise.resolve();
addEventListener("message", (/** @type {MessageEvent<Run | {runtime: ArrayBuffer}>} */ { data }) => {
  if ("runtime" in data) {
    ort.env.wasm.wasmBinary = data.runtime;
    begin();
    return;
  }
  turn = turn.then(() => run(data)).then(
    (found) => postMessage({ id: data.id, found }, { transfer: Object.values(found).map(({ buffer }) => buffer) }),
    (error) => postMessage({ id: data.id, failed: failed(error) }));
});
