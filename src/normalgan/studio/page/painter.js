/** Painter: keeps the result in step with the drawing: one request at a time, each of the newest state. */

import { Away, Lacking, Refused, doubt, height, paint } from "./api.js";
import { paintsAlike } from "./document.js";
import { inkAt } from "./ink.js";

/** @typedef {{rgba: Uint8Array, width: number, height: number, warning: string}} Painted */

/** Milliseconds after which a server that is busy is asked again. */
const RETRY = 400;
/** Longer side of the map while a gesture goes on: it follows the hand, and is refined when the hand rests. */
const COARSE = { pen: 256, pin: 512 };
/** The server has another drawing than the one that a change was made to. */
const BEHIND = 409;

/** Events: `painting`, `painted` (detail: ms, whole), `raising`, `height`, `doubt`, `empty`, `failed` (detail: the error). */
export class Painter extends EventTarget {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {import("./ink.js").Ink} ink
   * @param {import("./connection.js").Connection} connection
   * @param {string} tab
   */
  constructor(editor, ink, connection, tab) {
    super();
    this.editor = editor;
    this.ink = ink;
    this.connection = connection;
    this.tab = tab;
    this.number = Date.now();
    /** @type {number | null} the request whose pixels the server has */
    this.base = null;
    /** @type {1 | 4} */
    this.channels = 1;
    /** @type {AbortController | null} the painting that goes on */
    this.running = null;
    /** @type {AbortController | null} the heights that are asked for */
    this.climbing = null;
    /** Whether something changed since the last request. */
    this.stale = false;
    /** @type {"pen" | "pin" | null} the gesture that goes on */
    this.gesture = null;
    /** @type {import("./document.js").Doc | null} the document as it was painted last, or is being painted */
    this.asked = null;
    /** @type {Painted | null} */
    this.painted = null;
    /** Whether the map on show is of all that is drawn, and as fine as it will be. */
    this.whole = false;
    this.wantsHeight = false;
    /** @type {{heights: Float32Array, width: number, height: number} | null} */
    this.heights = null;
    this.wantsDoubt = false;
    /** @type {{shares: Uint8Array, width: number, height: number} | null} of a right angle, as 0 to 255 */
    this.doubt = null;
    /** @type {boolean | null} whether the model says how sure it is; null is not known yet */
    this.unsure = null;
    editor.addEventListener("change", (event) => this.#changed(/** @type {CustomEvent} */ (event).detail.live ? "pin" : null));
    editor.addEventListener("drawing", (event) => /** @type {CustomEvent} */ (event).detail.ended || this.#touched("pen"));
    connection.addEventListener("back", () => this.refresh());
  }

  /** Paints again whatever was painted before. */
  refresh() {
    this.asked = null;
    this.base = null;
    this.#changed(null);
  }

  /** Says whether heights are wanted beside the map. @param {boolean} wanted */
  wantHeight(wanted) {
    this.wantsHeight = wanted;
    if (wanted && this.connection.away) this.#failed(new Away());
    if (!this.running) this.#raise();
  }

  /** Says whether it is wanted how unsure the model is. @param {boolean} wanted */
  wantDoubt(wanted) {
    this.wantsDoubt = wanted;
    this.doubt = null;
    this.dispatchEvent(new Event("doubt"));
    if (wanted && this.connection.away) this.#failed(new Away(), false);
    if (!this.running) this.#doubt();
  }

  /** Asks how unsure the model is of the map on show. */
  async #doubt() {
    const { painted } = this;
    if (!this.wantsDoubt || !this.whole || this.connection.away) return;
    try {
      const found = await this.ask((request) => doubt(request));
      if (!found || painted !== this.painted || !this.wantsDoubt) return;
      this.unsure = found.known;
      this.doubt = found.known ? found : null;
      this.dispatchEvent(new Event("doubt"));
    } catch (error) {
      this.#failed(error, false);
    }
  }

  /**
   * Sends a request about the drawing as it is now, of whose pixels only what has changed is sent.
   * @template T
   * @param {(request: import("./api.js").Request) => Promise<T>} send
   * @param {object} [more] further fields
   * @returns {Promise<T>}
   */
  async ask(send, more = {}) {
    try {
      return await send(this.#request(more));
    } catch (error) {
      if (error instanceof Lacking) throw error;
      // Nothing is known of what the server has now.
      this.base = null;
      if (!(error instanceof Refused) || error.status !== BEHIND) throw error;
      return await send(this.#request(more));
    }
  }

  /**
   * Returns a request about the drawing at another size: its strokes are drawn anew, and nothing is enlarged.
   * @param {number} longest longer side in pixels
   * @param {object} more further fields
   * @returns {import("./api.js").Request}
   */
  requestAt(longest, more) {
    const { doc } = this.editor;
    const { canvas, scale, pixels } = inkAt(doc, longest);
    const { channels, bytes } = pixels();
    const { width, height } = canvas;
    /** @param {number[]} points */
    const scaled = (points) => points.map((value) => value * scale);
    this.number += 1;
    const fields = {
      tab: this.tab, number: this.number, base: null, keep: false,
      planes: [{ name: "ink", width, height, channels, box: [0, 0, width, height] }],
      hints: doc.hints.map((hint) => ({ ...hint, x: hint.x * scale, y: hint.y * scale, ...(hint.reach !== undefined && { reach: hint.reach * scale }) })),
      areas: doc.areas.map((area) => ({ ...area, points: scaled(area.points), ...(area.size && { size: area.size * scale }) })),
      mask_strokes: doc.mask.map((stroke) => ({ ...stroke, points: scaled(stroke.points), size: stroke.size * scale })),
      source: doc.settings.source, ...more,
    };
    return { fields, pixels: [bytes] };
  }

  /** @param {object} more further fields @returns {import("./api.js").Request} */
  #request(more) {
    const { doc } = this.editor;
    const { width, height } = this.ink;
    this.number += 1;
    const { channels, box, bytes } = this.ink.pixels(this.base === null);
    // A picture came or went: the server's plane is of another kind.
    const alike = this.base !== null && channels === this.channels;
    const { box: all, bytes: pixels } = this.base === null || alike ? { box, bytes } : this.ink.pixels(true);
    const fields = {
      tab: this.tab, number: this.number, base: alike ? this.base : null,
      planes: [{ name: "ink", width, height, channels, box: all }],
      hints: doc.hints, areas: doc.areas, mask_strokes: doc.mask, source: doc.settings.source, ...more,
    };
    this.base = this.number;
    this.channels = channels;
    return { fields, pixels: [pixels] };
  }

  /** @param {"pin" | null} gesture */
  #changed(gesture) {
    const { doc } = this.editor;
    const ended = this.gesture !== null && gesture === null;
    this.gesture = gesture;
    if (!doc.strokes.length) {
      this.#empty();
      return;
    }
    // What a gesture has painted coarsely is refined when it ends.
    if (this.asked && paintsAlike(this.asked, doc) && (this.whole || !ended)) return;
    this.#touched(gesture);
  }

  /** @param {"pen" | "pin" | null} gesture */
  #touched(gesture) {
    this.gesture = gesture;
    this.stale = true;
    this.whole = false;
    if (!this.running) this.#run();
  }

  #empty() {
    this.running?.abort();
    this.climbing?.abort();
    this.running = this.climbing = null;
    [this.asked, this.painted, this.heights, this.stale, this.whole] = [this.editor.doc, null, null, false, false];
    this.doubt = null;
    this.dispatchEvent(new Event("doubt"));
    this.dispatchEvent(new Event("empty"));
  }

  /** Paints until all that was drawn is on show: what is begun is finished, or a fast hand would never see a map. */
  async #run() {
    const running = new AbortController();
    this.running = running;
    this.climbing?.abort();
    while (this.stale && !running.signal.aborted) {
      try {
        await this.#paint(running.signal);
      } catch (error) {
        if (running.signal.aborted) break;
        this.#failed(error);
      }
    }
    if (this.running !== running) return;
    this.running = null;
    this.#raise();
    this.#doubt();
  }

  /** @param {AbortSignal} signal */
  async #paint(signal) {
    const start = performance.now();
    const { doc } = this.editor;
    const coarse = this.gesture && COARSE[this.gesture];
    const longest = coarse && coarse < Math.max(doc.width, doc.height) ? coarse : null;
    this.asked = doc;
    this.stale = false;
    this.dispatchEvent(new Event("painting"));
    const painted = await this.ask((request) => paint(request, signal), { longest });
    if (signal.aborted) return;
    if (!painted) {
      this.stale = true; // another page of this tab's name has asked for something newer
      return;
    }
    this.painted = painted;
    this.heights = null;
    // A gesture that has ended since is refined, whether or not it changed more.
    if (longest && !this.gesture) this.stale = true;
    this.whole = !longest && !this.stale;
    const ms = Math.round(performance.now() - start);
    this.dispatchEvent(new CustomEvent("painted", { detail: { ms, whole: this.whole } }));
  }

  /** Asks for the heights of the map, once. */
  async #raise() {
    if (!this.wantsHeight || !this.whole || this.heights || this.climbing || this.connection.away) return;
    const climbing = new AbortController();
    this.climbing = climbing;
    this.dispatchEvent(new Event("raising"));
    try {
      const heights = await this.ask((request) => height(request, climbing.signal));
      if (!heights || climbing.signal.aborted) return;
      this.heights = heights;
      this.dispatchEvent(new Event("height"));
    } catch (error) {
      if (!(error instanceof Error && error.name === "AbortError")) this.#failed(error, false);
    } finally {
      if (this.climbing === climbing) this.climbing = null;
    }
  }

  /** @param {unknown} error @param {boolean} [painting] */
  #failed(error, painting = true) {
    if (painting && error instanceof Lacking) {
      // A stroke that was just begun may be no drawing yet, and more may have come since.
      if (this.gesture || this.stale) {
        this.asked = null;
        return;
      }
      if (this.ink.isBlank()) {
        this.#empty();
        return;
      }
    }
    if (error instanceof Away) this.connection.lost();
    if (error instanceof Refused && error.status === 429) {
      setTimeout(() => this.refresh(), RETRY);
    }
    this.dispatchEvent(new CustomEvent("failed", { detail: error }));
  }
}
