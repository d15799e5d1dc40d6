/** Predictor: keep the result up to date with the drawing, with one request at a time for the newest state. */

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

/** Maximum bytes of pixels per request; the server accepts 20 MB including the JSON. */
const MOST_BYTES = 17 * 2 ** 20;
/** Longer side of the map of a layer that is sent ahead; this map is not shown. */
const AHEAD = 64;
/** Longer side of the map during a gesture; it is refined when the hand rests. */
const COARSE = { pen: 256, pin: 512 };
/** Milliseconds between strokes at one stroke per second; if a map takes longer, a map of half the size is predicted first. */
const PACE = 650;
/** Maximum milliseconds between maps while drawing, and tolerance of the estimate. */
const GAP = 300;
const LATE = 30;
/** Decay per map of the estimated prediction time, which rises immediately. */
const FALL = 0.5;
/** Status of the server if a change is based on a drawing that it does not have. */
const BEHIND = 409;

/** @param {unknown} error */
const isBrokenOff = (error) => error instanceof Error && error.name === "AbortError";

/** Returns the structure pictures of a layer's areas, as the server takes them. @param {import("../drawing/document.js").Doc} doc @param {Layer} layer @returns {Record<string, string>} */
const sentStructures = (doc, { areas }) => Object.fromEntries(structuresOf(doc, areas).map(({ id, picture }) => [id, picture.split(",")[1]]));

/** @param {import("../drawing/document.js").Structure} structure @param {number} scale */
const scaledStructure = (structure, scale) =>
  ({ ...structure, period: possiblePeriod(structure.period * scale), x: (structure.x ?? 0) * scale, y: (structure.y ?? 0) * scale });

/** Events: `painting`, `painted` (detail: ms, whole), `raising`, `height`, `unraised` (detail: why there are no heights), `doubt`, `empty`, `failed` (detail: the error, painting: whether there is no map). */
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
    /** @type {Map<number, {number: number, channels: 1 | 4}>} by layer id, the number of the request whose pixels the server has */
    this.sent = new Map();
    /** @type {AbortController | null} the current prediction */
    this.running = null;
    /** @type {AbortController | null} the current request for heights */
    this.climbing = null;
    /** Whether the current prediction is a draft, that is, of an unfinished stroke or coarser than the drawing. */
    this.draft = false;
    /** Time since which a new map has been due. */
    this.since = 0;
    /** Estimated milliseconds for a full map until it is shown. */
    this.took = 0;
    /** Whether something changed since the last request. */
    this.stale = false;
    /** Whether the shown maps of some layers are outdated in context or at half size. */
    this.behind = false;
    /** Whether the remaining layers or the full size are being predicted, which the next change interrupts. */
    this.catchingUp = false;
    /** @type {"pen" | "pin" | null} the current gesture */
    this.gesture = null;
    /** @type {import("../drawing/document.js").Doc | null} the document of the last or current prediction */
    this.asked = null;
    /** @type {Painted | null} */
    this.painted = null;
    /** Whether the shown map is up to date and at full size. */
    this.whole = false;
    this.wantsHeight = false;
    /** @type {{heights: Float32Array, width: number, height: number} | null} */
    this.heights = null;
    this.wantsDoubt = false;
    /** @type {{shares: Uint8Array, width: number, height: number} | null} of a right angle, as 0 to 255 */
    this.doubt = null;
    /** @type {boolean | null} whether the model has a confidence; null if not yet known */
    this.unsure = null;
    editor.addEventListener("change", (event) => this.#changed(/** @type {CustomEvent} */ (event).detail.live ? "pin" : null));
    editor.addEventListener("drawing", (event) => /** @type {CustomEvent} */ (event).detail.ended || this.#touched("pen"));
    connection.addEventListener("back", () => this.refresh());
  }

  /** Predicts again, even if nothing has changed. */
  refresh() {
    this.asked = null;
    this.sent.clear();
    this.#changed(null);
  }

  /** Sets whether heights are requested with the map. @param {boolean} wanted */
  wantHeight(wanted) {
    this.wantsHeight = wanted;
    if (wanted && this.connection.away) this.#failed(new Away());
    if (!this.running) this.#raise();
  }

  /** Sets whether the uncertainty is requested. @param {boolean} wanted */
  wantDoubt(wanted) {
    this.wantsDoubt = wanted;
    this.doubt = null;
    this.dispatchEvent(new Event("doubt"));
    if (wanted && this.connection.away) this.#failed(new Away(), false);
    if (!this.running) this.#doubt();
  }

  /** Requests the uncertainty of the shown map. */
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

  /** Returns the visible layers that are not empty, including unfinished strokes. @returns {Layer[]} */
  #drawn() {
    const { doc } = this.editor;
    const drawn = drawnLayers(doc);
    return doc.layers.filter((layer) => drawn.includes(layer) || (layer.visible && this.inks.of(layer).live));
  }

  /**
   * Sends a request about the current drawing with only the changed pixels.
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
      // An aborted request may have arrived; if not, the server reports that it is behind.
      if (error instanceof Lacking || isBrokenOff(error)) throw error;
      // The server's state is unknown now.
      this.sent.clear();
      if (!(error instanceof Refused) || error.status !== BEHIND) throw error;
      return await this.#send(send, layers.map((layer) => this.#part(layer)), more);
    }
  }

  /**
   * Sends a request about a drawing at another size, for which the strokes are redrawn instead of scaled.
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
    // Kept separate from the server's pixels of the drawing at its own size.
    return this.#send(send, parts, { ...more, tab: `${this.tab} ${purpose}` });
  }

  /** Returns the part of a layer that has changed since the last request. @param {Layer} layer @returns {Part} */
  #part(layer) {
    const { id, name, hints, mask, source, form } = layer;
    const ink = this.inks.of(layer);
    const { width, height } = ink;
    const before = this.sent.get(id);
    let { channels, box, bytes } = ink.pixels(!before);
    // A picture was added or removed, so the server's plane has a different number of channels.
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
    // Too large for one request: the layers are sent ahead one by one, and the request only refers to them.
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
    // A coarse map of a gesture is refined when the gesture ends.
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
    // A final request makes the server drop the draft, and no map would be shown until it arrives; the user may continue drawing.
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
   * Predicts until the map of the whole drawing is visible. It finishes every started prediction, because otherwise a fast
   * hand would never see a map, but does not wait for a gesture's draft once the gesture has ended.
   */
  async #run() {
    const running = new AbortController();
    this.running = running;
    this.climbing?.abort();
    // A stroke that is becoming a shape may be the only one.
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

  /** @param {AbortController} running the run it belongs to */
  async #paint(running) {
    const start = performance.now();
    const { editor: { doc }, gesture } = this;
    const side = Math.max(doc.width, doc.height);
    const catchingUp = !this.stale;
    const slow = !gesture && !catchingUp && this.took > PACE && side >= 2 * COARSE.pen;
    const coarse = slow ? Math.round(side / 2) : gesture && COARSE[gesture];
    const longest = coarse && coarse < side ? coarse : null;
    const draft = gesture === "pen" || (gesture !== null && longest !== null);
    // Changed layers are shown first; the other layers, whose context has changed, follow.
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
      this.stale = true; // another page with this tab's id has sent a newer request
      return;
    }
    this.painted = painted;
    this.heights = null;
    // A gesture that has ended meanwhile is refined, even if nothing else changed.
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
      if (error instanceof Refused) this.dispatchEvent(new CustomEvent("unraised", { detail: error }));
      else if (!isBrokenOff(error)) this.#failed(error, false);
    } finally {
      if (this.climbing === climbing) this.climbing = null;
    }
  }

  /** @param {unknown} error @param {boolean} [painting] */
  #failed(error, painting = true) {
    if (painting && error instanceof Lacking) {
      // A stroke that was just begun may not be a drawing yet, and more may have been drawn since.
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
    this.dispatchEvent(new CustomEvent("failed", { detail: { error, painting } }));
  }
}
