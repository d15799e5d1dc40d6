/** What is drawn, as values that never change: each edit makes a new document, so that undo is a list. */

import { text } from "./text.js";

/**
 * @typedef {{kind: "pen" | "eraser", size: number, points: number[], colour?: string, mirror?: number}} Line x, y,
 *   pressure, x, y, pressure, …; colour: "#rrggbb", black if there is none; mirror: x of the upright line at which it is
 *   mirrored, and drawn twice
 * @typedef {{kind: "picture", picture: string, x: number, y: number, width: number, height: number}} Placed
 * @typedef {Line | Placed} Stroke what the ink is made of, in order; `picture` is a data URL
 * @typedef {[number, number, number]} Normal camera space: x right, y up, z to the viewer
 * @typedef {{x: number, y: number, normal: Normal, reach?: number}} Hint in pixels of the drawing, x right, y down;
 *   reach: how far it has an effect
 * @typedef {{points: number[], normal: Normal, size?: number}} Area x, y, x, y, … of a polygon that is turned as a
 *   whole, or of a stroke of that width that is brushed with a direction
 * @typedef {{adds: boolean, size: number, points: number[]}} MaskStroke x, y, x, y, … where the object is added to or
 *   cut from
 * @typedef {Omit<Placed, "kind"> & {opacity: number, visible: boolean}} Layer
 * @typedef {{source: null | "outline" | "model", name: string}} Settings
 * @typedef {{format: string, version: number, width: number, height: number, strokes: Stroke[],
 *   hints: Hint[], areas: Area[], mask: MaskStroke[], layers: Layer[], settings: Settings}} Doc
 */

export const FORMAT = "normalgan-studio";
export const VERSION = 3;
export const SIDES = { least: 16, most: 2048 };
const MOST_STROKES = 20000;
export const MOST_AREAS = 200;
export const MOST_MASK_STROKES = 500;
export const MOST_LAYERS = 8;

/**
 * Returns an empty drawing.
 * @param {number} width
 * @param {number} height
 * @returns {Doc}
 */
export function newDocument(width, height) {
  const settings = { source: null, name: "" };
  return { format: FORMAT, version: VERSION, width, height, strokes: [], hints: [], areas: [], mask: [], layers: [], settings };
}

/** @param {Doc} doc @returns {boolean} */
export const isEmpty = (doc) => !doc.strokes.length && !doc.hints.length && !doc.layers.length;

/** @param {Doc} doc @param {Stroke} stroke @returns {Doc} */
export const withStroke = (doc, stroke) => ({ ...doc, strokes: [...doc.strokes, stroke] });

/** @param {Doc} doc @param {Hint} hint @returns {Doc} */
export const withHint = (doc, hint) => ({ ...doc, hints: [...doc.hints, hint] });

/** @param {Doc} doc @param {number} index @param {Partial<Hint>} change @returns {Doc} */
export function changedHint(doc, index, change) {
  return { ...doc, hints: doc.hints.map((hint, i) => (i === index ? { ...hint, ...change } : hint)) };
}

/** @param {Doc} doc @param {number} index @returns {Doc} */
export const withoutHint = (doc, index) => ({ ...doc, hints: doc.hints.filter((_, i) => i !== index) });

/** @param {Doc} doc @param {Area} area @returns {Doc} */
export const withArea = (doc, area) => ({ ...doc, areas: [...doc.areas, area] });

/** @param {Doc} doc @param {number} index @param {Partial<Area>} change @returns {Doc} */
export function changedArea(doc, index, change) {
  return { ...doc, areas: doc.areas.map((area, i) => (i === index ? { ...area, ...change } : area)) };
}

/** @param {Doc} doc @param {number} index @returns {Doc} */
export const withoutArea = (doc, index) => ({ ...doc, areas: doc.areas.filter((_, i) => i !== index) });

/** @param {Doc} doc @param {MaskStroke} stroke @returns {Doc} */
export const withMaskStroke = (doc, stroke) => ({ ...doc, mask: [...doc.mask, stroke] });

/** Where the mark of an area is. @param {Area} area @returns {{x: number, y: number}} */
export function anchorOf({ points, size }) {
  const count = points.length / 2;
  if (size) return { x: points[2 * (count >> 1)], y: points[2 * (count >> 1) + 1] };
  /** @param {number} offset */
  const mean = (offset) => points.reduce((sum, value, i) => (i % 2 === offset ? sum + value : sum), 0) / count;
  return { x: mean(0), y: mean(1) };
}

/** @param {Doc} doc @param {Layer[]} layers @returns {Doc} */
export const withLayers = (doc, layers) => ({ ...doc, layers });

/** @param {Doc} doc @param {Partial<Settings>} settings @returns {Doc} */
export const withSettings = (doc, settings) => ({ ...doc, settings: { ...doc.settings, ...settings } });

/** Whether two documents are painted alike. @param {Doc} a @param {Doc} b @returns {boolean} */
export function paintsAlike(a, b) {
  const alike = a.width === b.width && a.height === b.height && a.settings.source === b.settings.source;
  return alike && a.strokes === b.strokes && a.hints === b.hints && a.areas === b.areas && a.mask === b.mask;
}

/** All pictures of a document, which must be decoded before it is shown. @param {Doc} doc @returns {string[]} */
export function picturesOf(doc) {
  return [...doc.strokes, ...doc.layers].flatMap((each) => ("picture" in each ? [each.picture] : []));
}

// What a file holds may be anything.
/** @typedef {(value: any) => boolean} Check */
/** @type {Check} */
const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
/** @type {Check} */
const isSide = (value) => Number.isInteger(value) && value >= SIDES.least && value <= SIDES.most;
/** @type {Check} */
const isPlaced = (value) =>
  [value.x, value.y, value.width, value.height].every(isNumber) && String(value.picture).startsWith("data:image/png;base64,");
/** @type {Check} */
const isLine = (value) =>
  ["pen", "eraser"].includes(value.kind) && isNumber(value.size) && value.size > 0 && Array.isArray(value.points) &&
  value.points.length >= 3 && value.points.length % 3 === 0 && value.points.every(isNumber) &&
  (value.colour === undefined || /^#[0-9a-f]{6}$/.test(value.colour)) && (value.mirror === undefined || isNumber(value.mirror));
/** @param {any} value */
const isNormal = (value) =>
  Array.isArray(value) && value.length === 3 && value.every(isNumber) && Math.abs(Math.hypot(...value) - 1) < 0.05;
/** @type {Check} */
const isHint = (value) =>
  isNumber(value.x) && isNumber(value.y) && isNormal(value.normal) && (value.reach === undefined || isNumber(value.reach));
/** @type {Check} */
const isArea = (value) =>
  Array.isArray(value.points) && value.points.length >= (value.size === undefined ? 6 : 2) &&
  value.points.length % 2 === 0 && value.points.every(isNumber) && isNormal(value.normal) &&
  (value.size === undefined || (isNumber(value.size) && value.size > 0));
/** @type {Check} */
const isMaskStroke = (value) =>
  typeof value.adds === "boolean" && isNumber(value.size) && value.size > 0 && Array.isArray(value.points) &&
  value.points.length >= 2 && value.points.length % 2 === 0 && value.points.every(isNumber);
/** @type {Check} */
const isLayer = (value) => isPlaced(value) && isNumber(value.opacity) && typeof value.visible === "boolean";
/** @param {unknown} list @param {Check} check @param {number} most */
const isList = (list, check, most) => Array.isArray(list) && list.length <= most && list.every((each) => each && check(each));

/**
 * Returns a document read from a file or the server.
 * @param {unknown} value what its JSON holds
 * @returns {Doc}
 * @throws {Error} with a sentence if it is no project.
 */
export function parseDocument(value) {
  const doc = /** @type {Doc} */ (value);
  if (!doc || doc.format !== FORMAT) throw new Error(text.notProject);
  if (doc.version > VERSION) throw new Error(text.newerProject);
  const whole = isSide(doc.width) && isSide(doc.height) && isList(doc.hints, isHint, 200) &&
    isList(doc.areas ?? [], isArea, MOST_AREAS) && isList(doc.mask ?? [], isMaskStroke, MOST_MASK_STROKES) && isList(doc.layers, isLayer, MOST_LAYERS) &&
    isList(doc.strokes, (stroke) => (stroke.kind === "picture" ? isPlaced(stroke) : isLine(stroke)), MOST_STROKES);
  if (!whole) throw new Error(text.notProject);
  const source = ["outline", "model"].includes(String(doc.settings?.source)) ? doc.settings.source : null;
  const { width, height, strokes, hints, layers } = doc;
  const settings = { source, name: String(doc.settings?.name ?? "") };
  return { format: FORMAT, version: VERSION, width, height, strokes, hints, areas: doc.areas ?? [], mask: doc.mask ?? [], layers, settings };
}
