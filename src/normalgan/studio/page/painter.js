/** Painter: keeps the result in step with the drawing, one request at a time, the newest only. */

import { Away, Refused, height, paint } from "./api.js";
import { paintsAlike } from "./document.js";

/** @typedef {{rgba: Uint8Array, width: number, height: number, warning: string}} Painted */

const RETRY = 400;

/** Returns a blob as base64. @param {Blob} blob @returns {Promise<string>} */
export async function base64(blob) {
  const reader = new FileReader();
  reader.readAsDataURL(blob);
  await new Promise((resolve, reject) => {
    reader.onload = resolve;
    reader.onerror = () => reject(reader.error);
  });
  return String(reader.result).split(",", 2)[1];
}

/** Events: `painting`, `painted` (detail: ms), `raising`, `height`, `empty`, `failed` (detail: the error). */
export class Painter extends EventTarget {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {import("./ink.js").Ink} ink
   * @param {import("./connection.js").Connection} connection
   * @param {string} tab
   */
  constructor(editor, ink, connection, tab) {
    super();
    Object.assign(this, { editor, ink, connection, tab });
    this.number = Date.now();
    /** @type {AbortController | null} the request that goes on */
    this.running = null;
    this.again = false;
    /** @type {import("./document.js").Doc | null} */
    this.asked = null;
    /** @type {Painted | null} */
    this.painted = null;
    this.wantsHeight = false;
    /** @type {{heights: Float32Array, width: number, height: number} | null} */
    this.heights = null;
    /** @type {Painted | null} the map whose heights were asked for */
    this.raised = null;
    editor.addEventListener("change", (event) => this.#changed(event.detail.live));
    connection.addEventListener("back", () => this.refresh());
  }

  /** Paints again whatever was painted before. */
  refresh() {
    this.asked = null;
    this.#changed(false);
  }

  /** Says whether heights are wanted beside the map. @param {boolean} wanted */
  wantHeight(wanted) {
    this.wantsHeight = wanted;
    if (!this.running) this.#raise();
  }

  /** Returns what a request to paint holds. */
  async request() {
    const { doc } = this.editor;
    this.number += 1;
    const { number } = this;
    const picture = await base64(await this.ink.png());
    return { tab: this.tab, number, picture, hints: doc.hints, mask: null, source: doc.settings.source };
  }

  /** @param {boolean} live */
  #changed(live) {
    const { doc } = this.editor;
    if (this.asked && paintsAlike(this.asked, doc)) return;
    if (!doc.strokes.length) {
      this.running?.abort();
      [this.asked, this.painted, this.heights, this.again] = [doc, null, null, false];
      this.dispatchEvent(new Event("empty"));
      return;
    }
    // While a gesture goes on every answer is worth showing; after it only the last.
    if (this.running && live) {
      this.again = true;
      return;
    }
    this.running?.abort();
    this.#run(() => this.#paint());
  }

  /** Runs a request, and the next one after it if something changed meanwhile. */
  async #run(work) {
    const running = new AbortController();
    this.running = running;
    this.again = false;
    try {
      await work();
    } catch (error) {
      if (error.name === "AbortError" || this.running !== running) return;
      this.#failed(error);
    }
    if (this.running !== running) return;
    this.running = null;
    if (this.again) this.#changed(false);
    else this.#raise();
  }

  /** Asks for the heights of the map, once. */
  #raise() {
    if (!this.wantsHeight || !this.painted || this.raised === this.painted || this.connection.away) return;
    this.raised = this.painted;
    this.#run(() => this.#height());
  }

  async #paint() {
    const start = performance.now();
    const { signal } = this.running;
    this.asked = this.editor.doc;
    this.dispatchEvent(new Event("painting"));
    const painted = await paint(await this.request(), signal);
    if (!painted || signal.aborted) return;
    this.painted = painted;
    this.heights = null;
    const ms = Math.round(performance.now() - start);
    this.dispatchEvent(new CustomEvent("painted", { detail: { ms } }));
  }

  async #height() {
    const { signal } = this.running;
    this.dispatchEvent(new Event("raising"));
    const answer = await height(await this.request(), signal);
    if (!answer || signal.aborted) return;
    this.heights = answer;
    this.dispatchEvent(new Event("height"));
  }

  #failed(error) {
    if (error instanceof Away) this.connection.lost();
    if (error instanceof Refused && error.status === 429) {
      setTimeout(() => this.refresh(), RETRY);
    }
    this.dispatchEvent(new CustomEvent("failed", { detail: error }));
  }
}
