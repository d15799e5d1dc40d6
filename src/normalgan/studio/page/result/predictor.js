/** Predictor: keeps the result in step with the drawing: one request at a time, each of the newest state. */

import { areasOf } from "../drawing/carving.js";
import { drawnLayers, paintsAlike, possiblePeriod, structuresOf } from "../drawing/document.js";
import { inkAt } from "../drawing/ink.js";
import { Away, Lacking, Refused, doubt, height, predict } from "../server/api.js";

/** @typedef {{rgba: Uint8Array, width: number, height: number, findings: import("./findings.js").Finding[]}} Painted */

/** @typedef {import("../drawing/document.js").Layer} Layer */
/**
 * @typedef {{id: number, name: string, base: number | null, bytes: number, planes: {name: string, width: number,
 *   height: number, channels: 1 | 4, box: number[]}[], hints: object[], areas: object[], mask_strokes: object[],
 *   form: object | null, source: import("../drawing/document.js").Source, structures: Record<string, string>}} Fields
 * @typedef {{fields: Fields, pixels: Uint8Array}} Part of a request: a layer
 */

/** Bytes of pixels in one request; the server takes 20 MB, and the rest of it is words. */
const MOST_BYTES = 17 * 2 ** 20;
/** Longer side of the map of a layer that is sent ahead: nobody looks at it. */
const AHEAD = 64;
/** Longer side of the map while a gesture goes on: it follows the hand, and is refined when the hand rests. */
const COARSE = { pen: 256, pin: 512 };
/** Milliseconds from the end of a stroke to the next, at one a second: where a map takes longer, one of half its size comes first. */
const PACE = 650;
/** Milliseconds after which a hand that draws is to have seen another map, and how many of them what is foreseen may be late. */
const GAP = 300;
const LATE = 30;
/** How fast the time that a map is foreseen to take falls, from one map to the next; it rises at once. */
const FALL = 0.5;
/** The server has another drawing than the one that a change was made to. */
const BEHIND = 409;

/** @param {unknown} error */
const isBrokenOff = (error) => error instanceof Error && error.name === "AbortError";

/** Returns what a layer's areas have as structures, as the server takes it. @param {import("../drawing/document.js").Doc} doc @param {Layer} layer @returns {Record<string, string>} */
const sentStructures = (doc, { areas }) => Object.fromEntries(structuresOf(doc, areas).map(({ id, picture }) => [id, picture.split(",")[1]]));

/** @param {import("../drawing/document.js").Structure} structure @param {number} scale */
const scaledStructure = (structure, scale) =>
  ({ ...structure, period: possiblePeriod(structure.period * scale), x: (structure.x ?? 0) * scale, y: (structure.y ?? 0) * scale });

/** Events: `painting`, `painted` (detail: ms, whole), `raising`, `height`, `doubt`, `empty`, `failed` (detail: the error). */
export class Predictor extends EventTarget {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../drawing/ink.js").Inks} inks
   * @param {import("../server/connection.js").Connection} connection
   * @param {string} tab
   */
  constructor(editor, inks, connection, tab) {
    super();
    this.editor = editor;
    this.inks = inks;
    this.connection = connection;
    this.tab = tab;
    this.number = Date.now();
    /** @type {Map<number, {number: number, channels: 1 | 4}>} of each layer, by its id, the request whose pixels the server has */
    this.sent = new Map();
    /** @type {AbortController | null} the painting that goes on */
    this.running = null;
    /** @type {AbortController | null} the heights that are asked for */
    this.climbing = null;
    /** Whether what is being painted is a draft: a stroke that goes on, or coarser than the drawing. */
    this.draft = false;
    /** Since when there has been no new map although there was something to paint. */
    this.since = 0;
    /** Milliseconds that a whole map is foreseen to take, until it is handed to the viewer. */
    this.took = 0;
    /** Whether something changed since the last request. */
    this.stale = false;
    /** Whether layers are on show as they were seen before others changed, or at half their size. */
    this.behind = false;
    /** Whether the missing layers, or the full size, are being painted: the next change breaks that off. */
    this.catchingUp = false;
    /** @type {"pen" | "pin" | null} the gesture that goes on */
    this.gesture = null;
    /** @type {import("../drawing/document.js").Doc | null} the document as it was painted last, or is being painted */
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
    this.sent.clear();
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

  /** Returns the layers on which something is to be seen, be it a stroke that goes on. @returns {Layer[]} */
  #drawn() {
    const { doc } = this.editor;
    const drawn = drawnLayers(doc);
    return doc.layers.filter((layer) => drawn.includes(layer) || (layer.visible && this.inks.of(layer).live));
  }

  /**
   * Sends a request about the drawing as it is now, of whose pixels only what has changed is sent.
   * @template T
   * @param {(request: import("../server/api.js").Request) => Promise<T>} send
   * @param {object} [more] further fields
   * @param {Layer[]} [layers] those that are asked about
   * @returns {Promise<T>}
   */
  async ask(send, more = {}, layers = this.#drawn()) {
    try {
      return await this.#send(send, layers.map((layer) => this.#part(layer)), more);
    } catch (error) {
      // What was broken off may have come; where it has not, the server says that it is behind.
      if (error instanceof Lacking || isBrokenOff(error)) throw error;
      // Nothing is known of what the server has now.
      this.sent.clear();
      if (!(error instanceof Refused) || error.status !== BEHIND) throw error;
      return await this.#send(send, layers.map((layer) => this.#part(layer)), more);
    }
  }

  /**
   * Sends a request about a drawing at another size: its strokes are drawn anew, and nothing is enlarged.
   * @template T
   * @param {number} longest longer side in pixels
   * @param {(request: import("../server/api.js").Request) => Promise<T>} send
   * @param {object} more further fields
   * @param {import("../drawing/document.js").Doc} [doc] its pictures are decoded
   * @param {string} [purpose] a request drops an older one of the same purpose
   * @returns {Promise<T>}
   */
  async askAt(longest, send, more, doc = this.editor.doc, purpose = "other") {
    const parts = drawnLayers(doc).map((layer) => {
      const { id, name, strokes, hints, mask, source, form } = layer;
      const { canvas, scale, pixels } = inkAt({ width: doc.width, height: doc.height, strokes }, longest);
      const { channels, bytes } = pixels();
      const { width, height } = canvas;
      /** @param {number[]} points */
      const scaled = (points) => points.map((value) => value * scale);
      const fields = {
        id, name, source, form, structures: sentStructures(doc, layer), base: null, bytes: bytes.length,
        planes: [{ name: "ink", width, height, channels, box: [0, 0, width, height] }],
        hints: hints.map((hint) => ({ ...hint, x: hint.x * scale, y: hint.y * scale, ...(hint.reach !== undefined && { reach: hint.reach * scale }) })),
        areas: areasOf(layer).map((area) => ({
          ...area, points: scaled(area.points), ...(area.size && { size: area.size * scale }), ...(area.widths && { widths: scaled(area.widths) }),
          ...(area.structure && { structure: scaledStructure(area.structure, scale) }),
        })),
        mask_strokes: mask.map((stroke) => ({ ...stroke, points: scaled(stroke.points), size: stroke.size * scale })),
      };
      return { fields, pixels: bytes };
    });
    // Apart from what the server keeps of the drawing at its own size.
    return this.#send(send, parts, { ...more, tab: `${this.tab} ${purpose}` });
  }

  /** Returns what is sent of a layer: of its pixels those that have changed since. @param {Layer} layer @returns {Part} */
  #part(layer) {
    const { id, name, hints, mask, source, form } = layer;
    const ink = this.inks.of(layer);
    const { width, height } = ink;
    const before = this.sent.get(id);
    let { channels, box, bytes } = ink.pixels(!before);
    // A picture came or went: the server's plane is of another kind.
    if (before && before.channels !== channels) ({ channels, box, bytes } = ink.pixels(true));
    const base = before?.channels === channels ? before.number : null;
    const planes = [{ name: "ink", width, height, channels, box }];
    return { fields: { id, name, source, form, structures: sentStructures(this.editor.doc, layer), base, bytes: bytes.length, planes, hints, areas: areasOf(layer), mask_strokes: mask }, pixels: bytes };
  }

  /**
   * @template T
   * @param {(request: import("../server/api.js").Request) => Promise<T>} send
   * @param {Part[]} parts @param {object} more further fields
   * @returns {Promise<T>}
   */
  async #send(send, parts, more) {
    const common = { tab: this.tab, ...more };
    const own = common.tab === this.tab;
    /** @param {Part[]} some */
    const request = (some) => {
      this.number += 1;
      if (own) for (const { fields } of some) this.sent.set(fields.id, { number: this.number, channels: fields.planes[0].channels });
      return { fields: { ...common, number: this.number, layers: some.map(({ fields }) => fields) }, pixels: some.map(({ pixels }) => pixels) };
    };
    let size = parts.reduce((sum, { pixels }) => sum + pixels.length, 0);
    const all = [...parts];
    // Too much for one request: layers go ahead one by one, and the request itself only names them.
    for (let i = 0; i < all.length && size > MOST_BYTES; i++) {
      const { fields, pixels } = all[i];
      const { fields: sent, pixels: bytes } = request([all[i]]);
      await predict({ fields: { ...sent, longest: AHEAD }, pixels: bytes }).catch((error) => { if (!(error instanceof Lacking)) throw error; });
      const [plane] = fields.planes;
      all[i] = { fields: { ...fields, base: this.number, bytes: 0, planes: [{ ...plane, box: [0, 0, 0, 0] }] }, pixels: new Uint8Array() };
      size -= pixels.length;
    }
    return send(request(all));
  }

  /** @param {"pin" | null} gesture */
  #changed(gesture) {
    const { doc } = this.editor;
    const ended = this.gesture !== null && gesture === null;
    this.gesture = gesture;
    if (!this.#drawn().length) {
      this.#empty();
      return;
    }
    // What a gesture has painted coarsely is refined when it ends.
    if (this.asked && paintsAlike(this.asked, doc) && (this.whole || !ended)) return;
    this.#touched(gesture);
  }

  /** @param {"pen" | "pin" | null} gesture */
  #touched(gesture) {
    if (this.whole || !this.painted) this.since = performance.now();
    this.gesture = gesture;
    this.stale = true;
    this.whole = false;
    if (this.catchingUp) {
      this.running?.abort();
      this.running = null;
    }
    // The server gives a draft up for what is none, and the hand sees no map until that is there: it goes on to draw, maybe.
    const affordable = performance.now() + this.took - this.since <= GAP - LATE;
    if (!gesture && this.draft && affordable) this.running = null;
    if (!this.running) this.#run();
  }

  #empty() {
    this.running?.abort();
    this.climbing?.abort();
    this.running = this.climbing = null;
    [this.asked, this.painted, this.heights] = [this.editor.doc, null, null];
    this.stale = this.behind = this.catchingUp = this.whole = false;
    this.doubt = null;
    this.dispatchEvent(new Event("doubt"));
    this.dispatchEvent(new Event("empty"));
  }

  /**
   * Paints until all that was drawn is on show: what is begun is finished, or a fast hand would never see a map; but at
   * the end of a gesture its draft is not waited for.
   */
  async #run() {
    const running = new AbortController();
    this.running = running;
    this.climbing?.abort();
    // A stroke that is becoming a shape may be all that there is.
    while ((this.stale || (this.behind && !this.gesture)) && this.running === running && this.#drawn().length) {
      try {
        await this.#paint(running);
      } catch (error) {
        if (this.running === running) this.#failed(error);
      }
    }
    if (this.running !== running) return;
    this.running = null;
    this.catchingUp = false;
    this.#raise();
    this.#doubt();
  }

  /** @param {AbortController} running what it belongs to */
  async #paint(running) {
    const start = performance.now();
    const { editor: { doc }, gesture } = this;
    const side = Math.max(doc.width, doc.height);
    const catchingUp = !this.stale;
    const slow = !gesture && !catchingUp && this.took > PACE && side >= 2 * COARSE.pen;
    const coarse = slow ? Math.round(side / 2) : gesture && COARSE[gesture];
    const longest = coarse && coarse < side ? coarse : null;
    const draft = gesture === "pen" || (gesture !== null && longest !== null);
    // What has changed is on show first; the other layers, which are seen among all, follow.
    const first = !catchingUp && !draft && (slow || this.#drawn().length > 1);
    const refines = catchingUp && Math.max(this.painted?.width ?? 0, this.painted?.height ?? 0) < side;
    [this.draft, this.catchingUp] = [draft, catchingUp];
    this.asked = doc;
    this.stale = this.behind = false;
    this.dispatchEvent(new Event("painting"));
    const asked = { longest, draft: draft || catchingUp, changed_only: first };
    const painted = await this.ask((request) => predict(request, running.signal), asked);
    if (this.running !== running) return;
    if (!painted) {
      this.stale = true; // another page of this tab's name has asked for something newer
      return;
    }
    this.painted = painted;
    this.heights = null;
    // A gesture that has ended since is refined, whether or not it changed more.
    if (gesture && longest && !this.gesture) this.stale = true;
    this.behind = first;
    this.whole = !longest && !this.stale && !first;
    const ms = Math.round(performance.now() - start);
    this.dispatchEvent(new CustomEvent("painted", { detail: { ms, whole: this.whole } }));
    this.since = performance.now();
    const took = this.since - start;
    if (!draft && !longest && (!catchingUp || refines)) this.took = Math.max(took, this.took + FALL * (took - this.took));
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
      if (!isBrokenOff(error)) this.#failed(error, false);
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
      if (this.#drawn().every((layer) => this.inks.of(layer).isBlank())) {
        this.#empty();
        return;
      }
    }
    if (error instanceof Away) this.connection.lost();
    this.dispatchEvent(new CustomEvent("failed", { detail: error }));
  }
}
