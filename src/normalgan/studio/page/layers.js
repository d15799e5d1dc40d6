/** Layers: the parts of the drawing, in their order of depth; each is painted among the others, what is in front hides the rest. */

import { context2d } from "./canvas.js";
import { LONGEST_NAME, MOST_LAYERS, changedLayer, withLayerMoved, withNewLayer, withoutLayer } from "./document.js";
import { $, enable, label, make } from "./dom.js";
import { icon } from "./icons.js";
import { recalled, remember } from "./settings.js";
import { say, text } from "./text.js";

/** Side of the small pictures in pixels of the page. */
const SMALL = 36;
const KEY = "normalgan-layers";
/** Pixels that a press moves before it drags: less is a click. */
const STIRRED = 4;
/** Pixels at the ends of the list in which dragging scrolls it, and by how many at a time. */
const [EDGE, SCROLLED] = [24, 8];

/**
 * Returns what draws a layer as large as fits, from its ink only when that has changed: of a large drawing that is dear.
 * @param {import("./ink.js").Inks} inks
 */
function thumbnails(inks) {
  /** @type {Map<number, {strokes: object, width: number, height: number, picture: HTMLCanvasElement}>} by the layer's id */
  const known = new Map();
  /** @param {import("./document.js").Layer} layer @param {number} side */
  const pictureOf = (layer, side) => {
    const { canvas: lines } = inks.of(layer);
    const { width, height } = lines;
    const before = known.get(layer.id);
    if (before && before.strokes === layer.strokes && before.width === width && before.height === height && before.picture.width === side) return before.picture;
    const picture = make("canvas", { width: side, height: side });
    const context = context2d(picture);
    const scale = side / Math.max(width, height);
    context.imageSmoothingQuality = "high";
    context.drawImage(lines, (side - width * scale) / 2, (side - height * scale) / 2, width * scale, height * scale);
    known.set(layer.id, { strokes: layer.strokes, width, height, picture });
    return picture;
  };
  return {
    /** @param {HTMLCanvasElement} canvas @param {import("./document.js").Layer} layer */
    draw: (canvas, layer) => context2d(canvas).drawImage(pictureOf(layer, canvas.width), 0, 0),
    /** Forgets layers that are no more. @param {import("./document.js").Layer[]} layers */
    keepOnly: (layers) => {
      const ids = new Set(layers.map(({ id }) => id));
      for (const id of known.keys()) if (!ids.has(id)) known.delete(id);
    },
  };
}

/**
 * Lets a row be dragged to another place in its list.
 * @param {HTMLElement} handle of the row, which is pressed
 * @param {HTMLElement} item the row
 * @param {(step: number) => void} moved by so many rows downwards
 */
function drag(handle, item, moved) {
  handle.addEventListener("pointerdown", (event) => {
    const list = item.parentElement;
    if (event.button !== 0 || !list) return;
    const rows = /** @type {HTMLElement[]} */ ([...list.children]);
    const from = rows.indexOf(item);
    // Where the rows lie in the list, whatever part of it is on show.
    const middles = rows.map((row) => row.offsetTop + row.offsetHeight / 2);
    const pitch = rows.length > 1 ? rows[1].offsetTop - rows[0].offsetTop : item.offsetHeight;
    const [start, scrolled] = [event.clientY, list.scrollTop];
    let [to, begun, at, frame] = [from, false, start, 0];
    const show = () => {
      const by = at - start + list.scrollTop - scrolled;
      to = middles.reduce((nearest, middle, i) =>
        Math.abs(middle - middles[from] - by) < Math.abs(middles[nearest] - middles[from] - by) ? i : nearest, from);
      rows.forEach((row, i) => {
        const shift = i === from ? by : i > from && i <= to ? -pitch : i < from && i >= to ? pitch : 0;
        row.style.transform = shift ? `translateY(${shift}px)` : "";
      });
    };
    const scroll = () => {
      const { top, bottom } = list.getBoundingClientRect();
      const by = at < top + EDGE ? -SCROLLED : at > bottom - EDGE ? SCROLLED : 0;
      const before = list.scrollTop;
      list.scrollTop = Math.max(0, Math.min(list.scrollHeight - list.clientHeight, before + by));
      if (list.scrollTop !== before) show();
      frame = requestAnimationFrame(scroll);
    };
    const listening = new AbortController();
    const { signal } = listening;
    /** @param {boolean} kept whether the row stays where it was dragged to */
    const end = (kept) => {
      listening.abort();
      cancelAnimationFrame(frame);
      for (const row of rows) row.style.transform = "";
      item.classList.remove("dragged");
      list.classList.remove("sorting");
      // What was pressed to be dragged was not clicked.
      if (begun) addEventListener("click", (click) => click.stopPropagation(), { capture: true, once: true, signal: AbortSignal.timeout(50) });
      if (kept && to !== from && item.isConnected) moved(to - from);
    };
    handle.setPointerCapture(event.pointerId);
    handle.addEventListener("pointermove", (move) => {
      at = move.clientY;
      if (!begun && Math.abs(at - start) < STIRRED) return;
      if (!begun) {
        begun = true;
        item.classList.add("dragged");
        list.classList.add("sorting");
        frame = requestAnimationFrame(scroll);
      }
      show();
    }, { signal });
    handle.addEventListener("pointerup", () => end(true), { signal });
    handle.addEventListener("pointercancel", () => end(false), { signal });
    addEventListener("keydown", (key) => {
      if (key.key !== "Escape") return;
      key.stopPropagation();
      end(false);
    }, { capture: true, signal });
  });
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
  const pictures = thumbnails(inks);
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

  /** Moves a layer so many steps to the front. @param {number} id @param {number} step */
  const move = (id, step) => {
    const before = editor.doc;
    const after = withLayerMoved(before, id, step);
    if (after === before) return;
    editor.commit(after);
    const place = after.layers.findIndex((layer) => layer.id === id);
    announce(say("layerMoved", { name: after.layers[place].name, place: after.layers.length - place, count: after.layers.length }));
    /** @type {HTMLElement | null} */ (list.querySelector(`[data-layer="${id}"] .grip`))?.focus();
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
    pictures.draw(picture, layer);
    const grip = make("button", { type: "button", class: "grip" }, icon("grip"));
    label(grip, say("layerDrag", { name }));
    grip.addEventListener("keydown", (event) => {
      const step = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      move(id, step);
    });
    const item = make("li", { "data-layer": id }, eye, picture, nameOf(layer), grip);
    // The list has the front one on top.
    for (const handle of [grip, picture]) drag(handle, item, (down) => move(id, -down));
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
    pictures.keepOnly(layers);
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
