/** Arranging: flip, rotate, duplicate, copy, paste, nudge the selection, or move it to another layer. */

import { LISTS, MOST_LAYERS, activeLayer, changedLayer, drawnLayers, hasRoom, newDocument, parseDocument, picturesOf, structuresOf, withActive, withLayerMoved, withNewLayer, withStructures } from "../drawing/document.js";
import { chosenBy } from "../drawing/lasso.js";
import { aboutPoint, movedParts } from "../drawing/moving.js";
import { decodeAll } from "../drawing/pictures.js";
import { alongOf, boxOfSelection, cutFailed, hasInk, isCut, isNothing, keepAlong, onceCut, withCuts, withMoved } from "../drawing/selection.js";
import { $, enable, fieldOf, make } from "../elements/dom.js";
import { say, text } from "../text/text.js";
import { ARROWS } from "./keyboard_pen.js";

/** @typedef {import("../drawing/document.js").Doc} Doc @typedef {import("../drawing/document.js").Layer} Layer */
/** @typedef {Pick<Layer, "strokes" | "hints" | "areas" | "mask">} Parts */

/** Offset in pixels of a copy from its original. */
const BESIDE = 12;
/** Nudge in pixels with Shift. */
const FAR = 10;
/** Name of a document on the clipboard, which only holds the copied parts. */
const NAME = "clipboard";

/**
 * Returns the parts of a layer that belong to a selection, or the parts that stay.
 * @param {Layer} layer @param {import("../drawing/editor.js").Selection} selection in the layer, with all cuts done @param {boolean} goes
 * @returns {Parts}
 */
function partsOf(layer, selection, goes) {
  const along = alongOf(layer, selection);
  const pick = (/** @type {any[]} */ list, /** @type {Set<number>} */ places) => list.filter((_, i) => places.has(i) === goes);
  return {
    strokes: pick(layer.strokes, along.strokes), hints: pick(layer.hints, along.hints),
    areas: pick(layer.areas, along.areas), mask: pick(layer.mask, along.mask),
  };
}

/** @param {import("../drawing/document.js").Stroke} stroke */
const isInk = ({ kind }) => kind !== "eraser";

/** Adds parts in front of a layer's own. @param {Layer} layer @param {Parts} parts @returns {Layer | null} null: there is no room */
function withParts(layer, parts) {
  const both = { ...layer, ...Object.fromEntries(LISTS.map((list) => [list, [...layer[list], ...parts[list]]])) };
  return hasRoom(both) ? both : null;
}

/**
 * Moves the selected lines of the active layer to another layer, with all that belongs to them.
 * @param {Doc} given @param {import("../drawing/editor.js").Selection} chosen @param {string} target its id, or "new"
 * @returns {{doc: Doc, parts: Parts} | null} the document with the other layer as the active one; null: there is no room
 */
function brought(given, chosen, target) {
  const { doc: cut, selection } = withCuts(given, chosen);
  const layer = activeLayer(cut);
  const parts = partsOf(layer, selection, true);
  const stays = partsOf(layer, selection, false);
  if (stays.strokes.some(isInk)) {
    // Erased areas must stay erased on both layers.
    stays.strokes = layer.strokes.filter((stroke) => !isInk(stroke) || stays.strokes.includes(stroke));
    if (target === "new") parts.strokes = layer.strokes.filter((stroke) => !isInk(stroke) || parts.strokes.includes(stroke));
  }
  const left = changedLayer(cut, layer.id, stays);
  const doc = target === "new" ? withNewLayer(left) : { ...left, active: Number(target) };
  const onto = withParts(activeLayer(doc), parts);
  return onto && { doc: withActive(doc, onto), parts };
}

/** Moves parts to the right and down by a number of pixels. @param {Parts} parts @param {number} by @param {Doc} doc @returns {Parts} */
function beside(parts, by, doc) {
  const places = (/** @type {unknown[]} */ list) => new Set(list.keys());
  const all = { strokes: places(parts.strokes), hints: places(parts.hints), areas: places(parts.areas), mask: places(parts.mask) };
  return movedParts({ ...activeLayer(doc), ...parts }, all, { scale: 1, x: by, y: by }, doc).layer;
}

export class Arranging {
  /** @param {import("../drawing/editor.js").Editor} editor @param {import("../elements/status.js").Announce} announce */
  constructor(editor, announce) {
    this.editor = editor;
    this.announce = announce;
    $("select-flip").addEventListener("click", () => this.turn(0, true));
    $("select-flip-down").addEventListener("click", () => this.turn(Math.PI, true));
    $("select-turn").addEventListener("click", () => this.turn(Math.PI / 2, false));
    $("select-copy").addEventListener("click", () => this.duplicate());
    $("select-split").addEventListener("click", () => this.toLayer("new"));
    $("select-lasso").addEventListener("click", () => editor.set({ lassoes: !editor.lassoes }));
    /** @type {HTMLSelectElement} */
    this.target = $("select-layer");
    this.target.addEventListener("change", () => this.toLayer(this.target.value));
    addEventListener("keydown", (event) => this.#nudge(event));
    for (const name of ["copy", "cut"]) addEventListener(name, (event) => this.#copy(/** @type {ClipboardEvent} */ (event), name === "cut"));
    addEventListener("paste", (event) => this.#pasted(/** @type {ClipboardEvent} */ (event)));
    for (const name of ["change", "state"]) editor.addEventListener(name, () => this.#show());
    this.#show();
  }

  #show() {
    const { editor } = this;
    const some = !isNothing(editor.selection);
    for (const id of ["select-remove", "select-flip", "select-flip-down", "select-turn"]) enable(id, some);
    const help = $("select-help");
    help.hidden = some; // there is no room for it
    const ink = hasInk(editor.selection);
    const room = editor.doc.layers.length < MOST_LAYERS;
    enable("select-copy", ink);
    enable("select-split", ink && room);
    this.target.disabled = !ink;
    $("select-lasso").setAttribute("aria-pressed", String(editor.lassoes));
    help.textContent = help.title = editor.lassoes ? text.lassoHelp : text.selectHelp;
    if (editor.tool !== "select" || editor.draft) return;
    const others = editor.doc.layers.filter((layer) => layer !== editor.layer).reverse();
    const options = [{ value: "", words: text.toLayer }, ...others.map(({ id, name }) => ({ value: String(id), words: name })), ...(room ? [{ value: "new", words: text.toNewLayer }] : [])];
    const wanted = options.map(({ value, words }) => `${value} ${words}`).join("\n");
    if (this.target.dataset.shown === wanted) return;
    this.target.dataset.shown = wanted;
    this.target.replaceChildren(...options.map(({ value, words }) => make("option", { value, text: words })));
  }

  /** Rotates or flips the selection about its centre. @param {number} angle radians, clockwise @param {boolean} flipped horizontally, before the rotation */
  turn(angle, flipped) {
    const { editor } = this;
    const box = boxOfSelection(editor.doc, editor.selection);
    if (!box) return;
    const [x, y] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
    onceCut(editor, this.announce, () => this.#move(aboutPoint({ x, y }, { scale: 1, angle, flipped })));
  }

  /** Moves the selection by an arrow key, wherever the focus is. @param {KeyboardEvent} event */
  #nudge(event) {
    const { editor } = this;
    const way = ARROWS[event.key];
    if (!way || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || !this.#isOurs(event) || fieldOf(event, "select")) return;
    if (editor.tool !== "select" || isNothing(editor.selection)) return;
    event.preventDefault();
    const [x, y] = way.map((step) => step * (event.shiftKey ? FAR : 1));
    onceCut(editor, this.announce, () => this.#move({ scale: 1, x, y }, true));
  }

  /** @param {import("../drawing/moving.js").Move} move @param {boolean} [nudged] consecutive nudges of the same selection are one step in history, however long the pauses */
  #move(move, nudged = false) {
    const { editor } = this;
    const { doc, selection } = withMoved(editor.history.state, editor.selection, move);
    editor.selection = selection;
    editor.commit(doc, nudged ? `nudged ${JSON.stringify(selection)}` : "", Infinity);
  }

  /** Adds a copy of the selected lines next to them. */
  duplicate() {
    const { editor } = this;
    if (!hasInk(editor.selection)) return;
    onceCut(editor, this.announce, () => {
      const { doc, selection } = withCuts(editor.doc, editor.selection);
      this.#put(beside(partsOf(activeLayer(doc), selection, true), BESIDE, doc));
    });
  }

  /** Moves the selected lines to another layer and makes it the active one. @param {string} target its id, or "new" */
  toLayer(target) {
    const { editor } = this;
    this.target.value = "";
    if (!hasInk(editor.selection) || !target) return undefined;
    if (target === "new" && editor.doc.layers.length >= MOST_LAYERS) return this.announce(say("tooManyOwnLayers", { most: MOST_LAYERS }), "warning");
    onceCut(editor, this.announce, () => this.#toLayer(target));
    return undefined;
  }

  /** @param {string} target */
  #toLayer(target) {
    const { editor } = this;
    const moved = brought(editor.doc, editor.selection, target);
    if (!moved) return this.announce(text.noRoom, "warning");
    editor.commit(moved.doc);
    this.#choose(moved.parts);
    return this.announce(say("broughtTo", { name: editor.layer.name }));
  }

  /**
   * Gives each figure of the only drawn layer a layer of its own; the first figure stays.
   * @param {import("../drawing/lasso.js").Lasso[]} outlines around each figure
   */
  async part(outlines) {
    const { editor } = this;
    const before = editor.doc;
    const [layer] = drawnLayers(before);
    if (!layer) return;
    this.announce(text.cutting);
    let doc = { ...before, active: layer.id };
    let added = 0;
    try {
      for (const lasso of outlines.slice(1)) {
        const { strokes, cuts } = chosenBy(activeLayer(doc), lasso);
        // One by one: each cut starts from what the previous one has left.
        // oxlint-disable-next-line no-await-in-loop
        await Promise.all(cuts.map(({ ready }) => ready));
        if (editor.doc !== before) return; // the user has gone on
        const selection = { strokes, pictures: [], cuts: cuts.filter(({ parts }) => parts?.piece.width), lasso };
        if (!hasInk(selection)) continue;
        const moved = brought(doc, selection, "new");
        if (!moved) {
          this.announce(text.noRoom, "warning");
          return;
        }
        // In front of the previous figure's.
        doc = { ...withLayerMoved(moved.doc, moved.doc.active, added), active: layer.id };
        added += 1;
      }
    } catch (error) {
      cutFailed(this.announce)(error);
      return;
    }
    if (!added) {
      this.announce(text.figuresByHand, "warning");
      return;
    }
    editor.commit(doc);
    this.announce(text.figuresParted);
  }

  /** @param {ClipboardEvent} event @param {boolean} cut */
  #copy(event, cut) {
    const { editor } = this;
    if (!this.#isOurs(event) || !hasInk(editor.selection) || editor.tool !== "select") return;
    event.preventDefault();
    const { clipboardData } = event;
    const atOnce = isCut(editor.selection);
    onceCut(editor, this.announce, () => this.#take(cut, async (words) => {
      // The event's clipboard can only be used during the event.
      if (atOnce) clipboardData?.setData("text/plain", words);
      else await navigator.clipboard.writeText(words);
    }));
  }

  /** @param {boolean} cut @param {(words: string) => Promise<void>} write puts words on the clipboard */
  async #take(cut, write) {
    const { editor } = this;
    const { width, height } = editor.doc;
    const { doc: from, selection } = withCuts(editor.doc, editor.selection);
    const layer = activeLayer(from);
    const parts = partsOf(layer, selection, true);
    const doc = { ...withActive(newDocument(width, height), parts), structures: structuresOf(from, parts.areas), settings: { name: NAME } };
    try {
      await write(JSON.stringify(doc));
    } catch (error) {
      this.announce(say("noClipboard", { reason: error instanceof Error ? error.message : String(error) }), "warning");
      return;
    }
    if (cut) {
      editor.set({ selection: { strokes: [], pictures: [] } });
      editor.commit(withActive(from, partsOf(layer, selection, false)));
    }
    this.announce(text.copiedLines);
  }

  /** @param {ClipboardEvent} event */
  async #pasted(event) {
    const words = event.clipboardData?.getData("text/plain") ?? "";
    if (!this.#isOurs(event) || event.clipboardData?.files.length || !words.startsWith("{")) return;
    /** @type {Doc} */
    let doc;
    try {
      doc = parseDocument(JSON.parse(words));
      await decodeAll(picturesOf(doc));
    } catch {
      return; // the clipboard holds something else
    }
    const { editor } = this;
    const parts = activeLayer(doc);
    const there = editor.layer.strokes.some((stroke) => JSON.stringify(stroke) === JSON.stringify(parts.strokes[0]));
    this.#put(there ? beside(parts, BESIDE, editor.doc) : parts, doc.structures);
  }

  /** Whether a clipboard event concerns the drawing instead of a text field. @param {Event} event */
  #isOurs(event) {
    return !document.querySelector("dialog[open]") && !fieldOf(event, "input, textarea");
  }

  /** Adds parts to the active layer and selects them. @param {Parts} parts @param {import("../drawing/document.js").OwnStructure[]} [structures] that they have */
  #put(parts, structures = []) {
    const { editor } = this;
    const layer = withParts(editor.layer, parts);
    const doc = withStructures(editor.doc, structures);
    if (!layer || !doc) {
      this.announce(text.noRoom, "warning");
      return;
    }
    editor.set({ tool: "select" });
    editor.commit(withActive(doc, layer));
    this.#choose(parts);
  }

  /** Selects parts, which are the last of the active layer. @param {Parts} parts */
  #choose(parts) {
    const { layer } = this.editor;
    const last = (/** @type {keyof Parts} */ list) => new Set(parts[list].map((_, i) => layer[list].length - parts[list].length + i));
    const along = { strokes: last("strokes"), hints: last("hints"), areas: last("areas"), mask: last("mask") };
    const selection = { strokes: [...along.strokes].filter((i) => layer.strokes[i].kind !== "eraser"), pictures: [] };
    keepAlong(layer, selection, along);
    this.editor.set({ selection });
  }
}
