/** Gallery: tiles of projects or of drawings in a folder, drawn when they become visible. */

import { context2d } from "../drawing/canvas.js";
import { parseDocument, picturesOf } from "../drawing/document.js";
import { linesAt } from "../drawing/ink.js";
import { decodeAll, free } from "../drawing/pictures.js";
import { label, make } from "../elements/dom.js";
import { icon } from "../elements/icons.js";
import { reasonOf } from "../elements/status.js";
import { Away } from "../server/api.js";

export const SIDE = 192;

/**
 * @typedef {object} Tile
 * @property {string} name
 * @property {string} [note] below the name
 * @property {string} key changes when the picture does
 * @property {(canvas: HTMLCanvasElement, note: (words: string) => void) => Promise<void>} draw may write below the name
 * @property {() => void} open
 * @property {{icon: Parameters<typeof icon>[0], words: string, act: () => void}[]} [ways] buttons on its picture
 */

/** @type {Map<string, {canvas: HTMLCanvasElement, words: string}>} drawn pictures and their notes, by the keys of the tiles */
const drawn = new Map();
/** Tiles are drawn one after the other, because a folder may hold hundreds. */
let queue = Promise.resolve();

/** Shows tiles in a list. @param {HTMLElement} list @param {Tile[]} tiles */
export function showTiles(list, tiles) {
  const seen = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      const tile = tiles[[...list.children].indexOf(target)];
      const [canvas, below] = [target.querySelector("canvas"), target.querySelector("span")];
      if (!tile || !canvas || !below) continue;
      queue = queue.then(async () => {
        if (!target.isConnected) return;
        // Nothing is drawn in a closed dialog until it is visible again.
        if (!list.closest("dialog[open]")) { seen.observe(target); return; }
        const before = below.textContent;
        /** @param {string} words */
        const note = (words) => { below.textContent = below.title = words; };
        await tile.draw(canvas, note).then(
          () => drawn.set(tile.key, { canvas, words: below.textContent }),
          (error) => note(error instanceof Away ? before : reasonOf(error)), // that the server is away is reported only once
        );
      });
    }
  });
  list.replaceChildren(...tiles.map(({ name, note, key, open, ways = [] }) => {
    const before = drawn.get(key);
    const canvas = before?.canvas ?? make("canvas", { width: SIDE, height: SIDE, "aria-hidden": "true" });
    const below = make("span", { text: note ?? before?.words ?? "" });
    const button = make("button", { type: "button", class: "project", title: name }, canvas, make("strong", { text: name }), below);
    button.addEventListener("click", open);
    const item = make("li", {}, button);
    if (ways.length) item.append(make("div", { class: "group" }, ...ways.map((way) => {
      const small = make("button", { type: "button" }, icon(way.icon));
      label(small, way.words);
      small.addEventListener("click", way.act);
      return small;
    })));
    if (!before) seen.observe(item);
    return item;
  }));
}

/** Draws a picture scaled to fit. @param {HTMLCanvasElement} canvas @param {HTMLCanvasElement | HTMLImageElement | ImageBitmap} picture */
export function drawFitted(canvas, picture) {
  const { width, height } = canvas;
  const scale = Math.min(width / picture.width, height / picture.height);
  const [wide, high] = [picture.width * scale, picture.height * scale];
  context2d(canvas).drawImage(picture, (width - wide) / 2, (height - high) / 2, wide, high);
}

/**
 * Draws a document, which may be damaged, without keeping its pictures.
 * @param {HTMLCanvasElement} canvas @param {unknown} value
 */
export async function drawDocument(canvas, value) {
  const doc = parseDocument(value);
  const fresh = await decodeAll(picturesOf(doc));
  drawFitted(canvas, linesAt(doc, SIDE, true));
  // A document that is being opened may need them.
  if (canvas.closest("dialog[open]")) free(fresh);
}
