/** Layers: the parts of the drawing, in their order of depth; each is painted for itself, what is in front hides the rest. */

import { context2d } from "./canvas.js";
import { LONGEST_NAME, MOST_LAYERS, changedLayer, withLayerMoved, withNewLayer, withoutLayer } from "./document.js";
import { $, enable, label, make } from "./dom.js";
import { icon } from "./icons.js";
import { recalled, remember } from "./settings.js";
import { say, text } from "./text.js";

/** Side of the small pictures in pixels of the page. */
const SMALL = 36;
const KEY = "normalgan-layers";

/** Draws a layer as large as fits. @param {HTMLCanvasElement} canvas @param {import("./ink.js").Ink} ink */
function draw(canvas, ink) {
  const context = context2d(canvas);
  const { canvas: lines } = ink;
  const scale = canvas.width / Math.max(lines.width, lines.height);
  const [width, height] = [lines.width * scale, lines.height * scale];
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.imageSmoothingQuality = "high";
  context.drawImage(lines, (canvas.width - width) / 2, (canvas.height - height) / 2, width, height);
}

/**
 * Wires the panel of layers.
 * @param {import("./editor.js").Editor} editor
 * @param {import("./ink.js").Inks} inks
 * @param {(words: string) => void} announce
 * @returns {(step: number) => void} goes to the layer that is so many farther to the front
 */
export function followLayers(editor, inks, announce) {
  const list = $("layer-list");
  /** @type {number | null} id of the layer that is being named */
  let naming = null;
  const placeOf = () => editor.doc.layers.indexOf(editor.layer);

  /** @param {boolean} open */
  const show = (open) => {
    $("layers").hidden = !open;
    $("layers-toggle").setAttribute("aria-expanded", String(open));
    $("layers-toggle").setAttribute("aria-pressed", String(open));
    remember(KEY, open);
    fill();
  };

  /** @param {number} id @param {string} name */
  const rename = (id, name) => {
    naming = null;
    const layer = editor.doc.layers.find((each) => each.id === id);
    const given = name.trim().slice(0, LONGEST_NAME);
    if (layer && given && given !== layer.name) editor.commit(changedLayer(editor.doc, id, { name: given }));
    else fill();
  };

  /** @param {import("./document.js").Layer} layer @returns {HTMLElement} */
  const nameOf = ({ id, name }) => {
    if (naming !== id) {
      const button = make("button", { type: "button", class: "name", text: name });
      button.addEventListener("click", () => editor.work(id));
      button.addEventListener("dblclick", () => begin(id));
      return button;
    }
    const input = make("input", { type: "text", value: name, maxLength: LONGEST_NAME, "aria-label": text.layerName });
    input.addEventListener("keydown", (event) => {
      event.stopPropagation(); // letters are no shortcuts here
      if (event.key === "Enter") rename(id, input.value);
      else if (event.key === "Escape") rename(id, name);
    });
    input.addEventListener("blur", () => naming === id && rename(id, input.value));
    return input;
  };

  /** Lets a layer be named. @param {number} id */
  const begin = (id) => {
    naming = id;
    fill();
    const input = list.querySelector("input");
    input?.focus();
    input?.select();
  };

  /** @param {import("./document.js").Layer} layer @returns {HTMLElement} */
  const row = (layer) => {
    const { id, name, visible } = layer;
    const eye = make("button", { type: "button", class: "eye", "aria-pressed": String(visible) }, icon(visible ? "eye" : "eyeOff"));
    label(eye, say(visible ? "layerHide" : "layerShow", { name }));
    eye.addEventListener("click", () => editor.commit(changedLayer(editor.doc, id, { visible: !visible })));
    const side = Math.round(SMALL * devicePixelRatio);
    const picture = make("canvas", { class: "small", width: side, height: side, "aria-hidden": "true" });
    picture.addEventListener("click", () => editor.work(id));
    draw(picture, inks.of(layer));
    const item = make("li", {}, eye, picture, nameOf(layer));
    item.classList.toggle("unseen", !visible);
    if (id === editor.layer.id) item.setAttribute("aria-current", "true");
    return item;
  };

  const fill = () => {
    const { layers } = editor.doc;
    const at = placeOf();
    enable("layer-add", layers.length < MOST_LAYERS);
    enable("layer-remove", layers.length > 1);
    enable("layer-front", at < layers.length - 1);
    enable("layer-back", at > 0);
    if ($("layers").hidden) return;
    const focused = /** @type {HTMLElement | null} */ (document.activeElement);
    const place = focused && list.contains(focused) ? [...list.querySelectorAll("button, input")].indexOf(focused) : -1;
    // As they lie: the front one on top.
    list.replaceChildren(...[...layers].reverse().map(row));
    if (place >= 0) /** @type {HTMLElement[]} */ ([...list.querySelectorAll("button, input")])[place]?.focus();
  };

  $("layers-toggle").addEventListener("click", () => show(/** @type {boolean} */ ($("layers").hidden)));
  $("layers-close").addEventListener("click", () => {
    show(false);
    $("layers-toggle").focus();
  });
  $("layer-add").addEventListener("click", () => {
    editor.commit(withNewLayer(editor.doc));
    announce(say("layerAdded", { name: editor.layer.name }));
  });
  $("layer-remove").addEventListener("click", () => {
    const { name, id } = editor.layer;
    editor.commit(withoutLayer(editor.doc, id));
    announce(say("layerRemoved", { name }));
  });
  $("layer-name").addEventListener("click", () => begin(editor.layer.id));
  for (const [way, step] of /** @type {[string, number][]} */ ([["front", 1], ["back", -1]])) {
    $(`layer-${way}`).addEventListener("click", () => editor.commit(withLayerMoved(editor.doc, editor.layer.id, step)));
  }
  editor.addEventListener("change", (event) => {
    // A point that is turned leaves the panel as it is.
    if (!/** @type {CustomEvent} */ (event).detail.live) fill();
  });
  show(recalled(KEY) === true);
  return (step) => {
    const next = editor.doc.layers[placeOf() + step];
    if (!next) return;
    editor.work(next.id);
    announce(say("layerWorked", { name: next.name }));
  };
}
