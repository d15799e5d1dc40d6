/** Layers: the panel of layers in depth order; each is predicted among the others, and front layers hide those behind. */

import { context2d } from "../drawing/canvas.js";
import { LONGEST_NAME, MOST_LAYERS, changedLayer, withLayerMoved, withNewLayer, withoutLayer } from "../drawing/document.js";
import { isPictured } from "../drawing/ink.js";
import { $, enable, label, make } from "../elements/dom.js";
import { icon } from "../elements/icons.js";
import { recalled, remember } from "../elements/settings.js";
import { letSort } from "../elements/sorting.js";
import { say, text } from "../text/text.js";

/** Side of the thumbnails in CSS pixels. */
const SMALL = 36;
const KEY = "normalgan-layers";

/** Thumbnails of layers, only updated when the ink has changed, because that is slow for large drawings. */
class Thumbnails {
  /** @type {Map<number, {strokes: object, width: number, height: number, picture: HTMLCanvasElement}>} by the layer's id */
  #known = new Map();

  /** @param {import("../drawing/ink.js").Inks} inks */
  constructor(inks) {
    this.inks = inks;
  }

  /** @param {HTMLCanvasElement} canvas @param {import("../drawing/document.js").Layer} layer */
  draw(canvas, layer) {
    context2d(canvas).drawImage(this.#pictureOf(layer, canvas.width), 0, 0);
  }

  /** Forgets deleted layers. @param {import("../drawing/document.js").Layer[]} layers */
  keepOnly(layers) {
    const ids = new Set(layers.map(({ id }) => id));
    for (const id of this.#known.keys()) if (!ids.has(id)) this.#known.delete(id);
  }

  /** @param {import("../drawing/document.js").Layer} layer @param {number} side */
  #pictureOf(layer, side) {
    const { canvas: lines } = this.inks.of(layer);
    const { width, height } = lines;
    const before = this.#known.get(layer.id);
    if (before && before.strokes === layer.strokes && before.width === width && before.height === height && before.picture.width === side) return before.picture;
    const picture = make("canvas", { width: side, height: side });
    const context = context2d(picture);
    const scale = side / Math.max(width, height);
    context.imageSmoothingQuality = "high";
    const fills = this.inks.underLines(layer);
    for (const each of fills ? [fills, lines] : [lines]) {
      context.globalCompositeOperation = isPictured(layer.strokes) ? "multiply" : "source-over";
      context.drawImage(each, (side - width * scale) / 2, (side - height * scale) / 2, width * scale, height * scale);
    }
    this.#known.set(layer.id, { strokes: layer.strokes, width, height, picture });
    return picture;
  }
}

/** The panel of layers. */
export class Layers {
  /** @type {number | null} id of the layer being renamed */
  #naming = null;

  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("../drawing/ink.js").Inks} inks
   * @param {(words: string) => void} announce
   */
  constructor(editor, inks, announce) {
    this.editor = editor;
    this.announce = announce;
    this.list = $("layer-list");
    this.pictures = new Thumbnails(inks);
    $("layers-toggle").addEventListener("click", () => this.#show(/** @type {boolean} */ ($("layers").hidden)));
    $("layers-close").addEventListener("click", () => {
      this.#show(false);
      $("layers-toggle").focus();
    });
    $("layer-add").addEventListener("click", () => this.#add());
    $("layer-remove").addEventListener("click", () => this.#remove());
    $("layer-name").addEventListener("click", () => this.#beginNaming(editor.layer.id));
    for (const [way, step] of /** @type {[string, number][]} */ ([["front", 1], ["back", -1]])) {
      $(`layer-${way}`).addEventListener("click", () => editor.commit(withLayerMoved(editor.doc, editor.layer.id, step)));
    }
    editor.addEventListener("change", (event) => {
      // Rotating a point does not change the panel.
      if (!/** @type {CustomEvent} */ (event).detail.live) this.#fill();
    });
    this.#show(recalled(KEY) === true);
  }

  /** Activates another layer. @param {number} step 1: the next one in front, -1: the next one behind */
  step(step) {
    const { editor } = this;
    const next = editor.doc.layers[this.#place + step];
    if (!next) return;
    editor.work(next.id);
    this.announce(say("layerWorked", { name: next.name }));
  }

  /** Index of the active layer, from the back. */
  get #place() {
    return this.editor.doc.layers.indexOf(this.editor.layer);
  }

  /** @param {boolean} open */
  #show(open) {
    $("layers").hidden = !open;
    $("layers-toggle").setAttribute("aria-expanded", String(open));
    $("layers-toggle").setAttribute("aria-pressed", String(open));
    remember(KEY, open);
    this.#fill();
  }

  #fill() {
    const { list, editor: { doc: { layers } } } = this;
    const at = this.#place;
    enable("layer-add", layers.length < MOST_LAYERS);
    enable("layer-remove", layers.length > 1);
    enable("layer-front", at < layers.length - 1);
    enable("layer-back", at > 0);
    if ($("layers").hidden) return;
    const focused = /** @type {HTMLElement | null} */ (document.activeElement);
    const place = focused && list.contains(focused) ? [...list.querySelectorAll("button, input")].indexOf(focused) : -1;
    // Front layer on top.
    list.replaceChildren(...[...layers].reverse().map((layer) => this.#row(layer)));
    this.pictures.keepOnly(layers);
    if (place >= 0) /** @type {HTMLElement[]} */ ([...list.querySelectorAll("button, input")])[place]?.focus();
  }

  /** @param {import("../drawing/document.js").Layer} layer */
  #row(layer) {
    const { editor } = this;
    const { id, name, visible } = layer;
    const eye = make("button", { type: "button", class: "eye", "aria-pressed": String(visible) }, icon(visible ? "eye" : "eyeOff"));
    label(eye, say(visible ? "layerHide" : "layerShow", { name }));
    eye.addEventListener("click", () => editor.commit(changedLayer(editor.doc, id, { visible: !visible })));
    const side = Math.round(SMALL * devicePixelRatio);
    const picture = make("canvas", { class: "small", width: side, height: side, "aria-hidden": "true" });
    picture.addEventListener("click", () => editor.work(id));
    this.pictures.draw(picture, layer);
    const grip = make("button", { type: "button", class: "grip" }, icon("grip"));
    label(grip, say("layerDrag", { name }));
    grip.addEventListener("keydown", (event) => {
      const step = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      this.#move(id, step);
    });
    const item = make("li", { "data-layer": id }, eye, picture, this.#nameOf(layer), grip);
    // The list has the front one on top.
    for (const handle of [grip, picture]) letSort(handle, item, (down) => this.#move(id, -down));
    item.classList.toggle("unseen", !visible);
    if (id === editor.layer.id) item.setAttribute("aria-current", "true");
    return item;
  }

  /** Returns the name of a layer, or the field for renaming it. @param {import("../drawing/document.js").Layer} layer @returns {HTMLElement} */
  #nameOf({ id, name }) {
    if (this.#naming !== id) {
      const button = make("button", { type: "button", class: "name", text: name });
      button.addEventListener("click", () => this.editor.work(id));
      button.addEventListener("dblclick", () => this.#beginNaming(id));
      return button;
    }
    const input = make("input", { type: "text", value: name, maxLength: LONGEST_NAME, "aria-label": text.layerName });
    input.addEventListener("keydown", (event) => {
      event.stopPropagation(); // letters are not shortcuts here
      if (event.key === "Enter") this.#rename(id, input.value);
      else if (event.key === "Escape") this.#rename(id, name);
    });
    input.addEventListener("blur", () => this.#naming === id && this.#rename(id, input.value));
    return input;
  }

  /** Starts renaming a layer. @param {number} id */
  #beginNaming(id) {
    this.#naming = id;
    this.#fill();
    const input = this.list.querySelector("input");
    input?.focus();
    input?.select();
  }

  /** @param {number} id @param {string} name */
  #rename(id, name) {
    const { editor } = this;
    this.#naming = null;
    const layer = editor.doc.layers.find((each) => each.id === id);
    const given = name.trim().slice(0, LONGEST_NAME);
    if (layer && given && given !== layer.name) editor.commit(changedLayer(editor.doc, id, { name: given }));
    else this.#fill();
  }

  /** Moves a layer towards the front. @param {number} id @param {number} step below 0: towards the back */
  #move(id, step) {
    const before = this.editor.doc;
    const after = withLayerMoved(before, id, step);
    if (after === before) return;
    this.editor.commit(after);
    const place = after.layers.findIndex((layer) => layer.id === id);
    this.announce(say("layerMoved", { name: after.layers[place].name, place: after.layers.length - place, count: after.layers.length }));
    /** @type {HTMLElement | null} */ (this.list.querySelector(`[data-layer="${id}"] .grip`))?.focus();
  }

  #add() {
    const { editor } = this;
    editor.commit(withNewLayer(editor.doc));
    this.announce(say("layerAdded", { name: editor.layer.name }));
  }

  #remove() {
    const { editor } = this;
    const { name, id } = editor.layer;
    editor.commit(withoutLayer(editor.doc, id));
    this.announce(say("layerRemoved", { name }));
  }
}
