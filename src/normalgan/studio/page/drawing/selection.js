/** Selection: the selected strokes, pictures and parts of pictures, and how they are cut and moved. */

import { say, text } from "../text/text.js";
import { activeLayer, withActive } from "./document.js";
import { insideOf, takeParts } from "./lasso.js";
import { alongWith, extentOf, movedParts, movedPicture, unitedBox } from "./moving.js";

/** @typedef {import("./editor.js").Selection} Selection */

/** @param {Selection} selection */
export const isNothing = (selection) => !hasInk(selection) && !selection.pictures.length;

/** Whether anything on the layer is selected. @param {Selection} selection */
export const hasInk = ({ strokes, cuts }) => strokes.length > 0 || Boolean(cuts?.length);

/** Returns a function that tests which points, regions and mask strokes move with the selection; null uses its convex hull. @param {Selection} selection */
export const insideOfSelection = ({ lasso }) => (lasso ? insideOf(lasso) : null);

/** @typedef {import("./moving.js").Along} Along */
/** What belongs to the strokes selected in a layer; it stays theirs, whatever they are moved over. @type {WeakMap<import("./document.js").Layer, {selected: string, along: Along}>} */
const belonging = new WeakMap();

/** Notes what belongs to selected strokes. @param {import("./document.js").Layer} layer @param {Selection} selection @param {Along} along */
export function keepAlong(layer, { strokes, lasso = [] }, along) {
  belonging.set(layer, { selected: JSON.stringify([strokes, lasso]), along });
}

/** Returns everything that moves with the selected strokes of a layer. @param {import("./document.js").Layer} layer @param {Selection} selection @returns {Along} */
export function alongOf(layer, selection) {
  const { strokes, lasso = [] } = selection;
  const kept = belonging.get(layer);
  if (kept?.selected === JSON.stringify([strokes, lasso])) return kept.along;
  const along = alongWith(layer, strokes, insideOfSelection(selection));
  keepAlong(layer, selection, along);
  return along;
}

/** Returns the selected items. @param {import("./document.js").Doc} doc @param {Selection} selection */
const itemsOf = (doc, { strokes, pictures }) =>
  [...strokes.map((i) => activeLayer(doc).strokes[i]), ...pictures.map((i) => doc.pictures[i])];

/** Returns the bounding box of the selection. @param {import("./document.js").Doc} doc @param {Selection} selection */
export const boxOfSelection = (doc, selection) =>
  unitedBox([...itemsOf(doc, selection).map(extentOf), ...(selection.cuts ?? []).map(({ box }) => box)]);

/** Whether all cuts, which a worker makes, are finished. @param {Selection} selection */
export const isCut = ({ cuts }) => !cuts?.some(({ parts }) => !parts);

/** Returns a handler that announces why a picture could not be cut. @param {import("../elements/status.js").Announce} announce @returns {(error: unknown) => void} */
export const cutFailed = (announce) => (error) =>
  announce(say("broken", { reason: error instanceof Error ? error.message : String(error) }), "warning");

/**
 * Calls a function once all cuts are finished, unless the selection has changed by then.
 * @param {import("./editor.js").Editor} editor @param {import("../elements/status.js").Announce} announce @param {() => void} act
 */
export function onceCut(editor, announce, act) {
  const { selection } = editor;
  if (isCut(selection)) {
    act();
    return;
  }
  announce(text.cutting);
  Promise.all((selection.cuts ?? []).map(({ ready }) => ready)).then(() => {
    if (editor.selection !== selection) return;
    announce("");
    act();
  }).catch(cutFailed(announce));
}

/**
 * Cuts pictures of which only a part is selected, and selects that part.
 * @param {import("./document.js").Doc} doc @param {Selection} selection
 * @returns {{doc: import("./document.js").Doc, selection: Selection}} the same if there is none
 */
export function withCuts(doc, selection) {
  const { strokes: whole, pictures, cuts, lasso } = selection;
  if (!cuts?.length) return { doc, selection };
  /** @type {import("./document.js").Stroke[]} */
  const strokes = [];
  /** @type {number[]} */
  const chosen = [];
  for (const [i, stroke] of activeLayer(doc).strokes.entries()) {
    const cut = cuts.find(({ index }) => index === i);
    const parts = cut && takeParts(cut);
    strokes.push(...(parts ? [parts.rest, parts.piece] : [stroke]));
    if (parts || whole.includes(i)) chosen.push(strokes.length - 1);
  }
  return { doc: withActive(doc, { strokes }), selection: { strokes: chosen, pictures, lasso } };
}

/** Whether a hit item is selected. @param {Selection} selection @param {Selection} hit */
export const isIn = ({ strokes, pictures }, hit) => strokes.includes(hit.strokes[0]) || pictures.includes(hit.pictures[0]);

/** @param {Selection} a @param {Selection} b @returns {Selection} */
export function together(a, b) {
  const both = (/** @type {number[]} */ x, /** @type {number[]} */ y) => [...new Set([...x, ...y])].sort((p, q) => p - q);
  return { strokes: both(a.strokes, b.strokes), pictures: both(a.pictures, b.pictures) };
}

/** @param {Selection} a @param {Selection} b @returns {Selection} */
export function without(a, b) {
  return { strokes: a.strokes.filter((i) => !b.strokes.includes(i)), pictures: a.pictures.filter((i) => !b.pictures.includes(i)) };
}

/**
 * @param {import("./document.js").Doc} before @param {Selection} given @param {import("./moving.js").Move} move
 * @returns {{doc: import("./document.js").Doc, selection: Selection}} selection: of the same in the new document
 */
export function withMoved(before, given, move) {
  const { doc, selection } = withCuts(before, given);
  const { strokes, pictures } = selection;
  const placed = pictures.length ? { ...doc, pictures: doc.pictures.map((each, i) => (pictures.includes(i) ? movedPicture(each, move) : each)) } : doc;
  if (!strokes.length) return { doc: placed, selection: { strokes, pictures } };
  const layer = activeLayer(doc);
  const { layer: moved, chosen, along } = movedParts(layer, alongOf(layer, selection), move, doc);
  const drawn = withActive(placed, moved);
  const now = { strokes: chosen, pictures };
  keepAlong(activeLayer(drawn), now, along);
  return { doc: drawn, selection: now };
}
