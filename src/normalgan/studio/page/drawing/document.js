/** Document: the drawing as an immutable value. Each edit returns a new document, so undo is a list of documents. */

import { say, text } from "../text/text.js";
import { LIMITS } from "./limits.js";

/**
 * @typedef {{kind: "pen" | "eraser" | "fill", size: number, points: number[], colour?: string, mirror?: number, carve?: number}} Line x, y,
 *   pressure, x, y, pressure, …; fill: the area inside the points, under all lines of its layer; only the page shows it, since a
 *   map depends on lines alone; colour: "#rrggbb", black if there is none; mirror: x of the upright line at which it is
 *   mirrored, and drawn twice; carve: height as a fraction of half its width, negative if engraved
 * @typedef {{x: number, y: number, width: number, height: number, turn?: number, flipped?: boolean}} Box left, top and size
 *   before it is turned; turn: clockwise rotation about its centre, in radians; flipped: mirrored horizontally before that
 * @typedef {{kind: "picture", picture: string, paper?: boolean} & Box} Placed `picture` is a data URL; paper: whether it was
 *   extracted from white paper, in which case its opacity says nothing about the object
 * @typedef {Line | Placed} Stroke an element of the ink, in order
 * @typedef {[number, number, number]} Normal camera space: x right, y up, z to the viewer
 * @typedef {{x: number, y: number, normal: Normal, reach?: number}} Hint in pixels of the drawing, x right, y down;
 *   reach: radius of its effect
 * @typedef {{kind: "round" | "flat" | "hollow", bevel: number, strength: number}} Form bevel: width of the curve or
 *   the bevel, as a fraction of the part's depth; strength: weight against the prediction; both at most 1
 * @typedef {{kind: string, period: number, turn?: number, x?: number, y?: number, flipped?: boolean, picture?: string}} Structure
 *   kind: a built-in one, or "own"; period: side of its tiles; turn: their clockwise rotation about x, y in radians; flipped: mirrored
 *   horizontally before that; picture: id of one of the document's structures
 * @typedef {{points: number[], normal: Normal, size?: number, form?: Form | null, soft?: number, strength?: number,
 *   smooths?: boolean, structure?: Structure}} Area x, y, x, y, … of a polygon that is turned as a whole, or of a stroke with
 *   that width, which brushes a direction, smooths, or adds a structure; only polygons have a form, and only strokes a
 *   strength; soft: width of the fade, as a fraction of a polygon's depth or a brush's radius
 * @typedef {{id: string, picture: string}} OwnStructure a grey tile as a data URL, white is high; id: a hash of it
 * @typedef {{adds: boolean, size: number, points: number[], fills?: boolean}} MaskStroke x, y, x, y, … where the object is
 *   added to or cut from; fills: a click, which fills the enclosed area
 * @typedef {{id: number, name: string, visible: boolean, strokes: Stroke[], hints: Hint[], areas: Area[],
 *   mask: MaskStroke[], source: Source, form: Form | null}} Layer a part of the drawing
 * @typedef {null | "outline" | "model"} Source source of a layer's mask: automatic, the outline, or the model
 * @typedef {Omit<Placed, "kind"> & {opacity: number, visible: boolean}} Picture a reference picture
 * @typedef {{name: string, file: string}} Settings name: the project's, or ""; file: the name of the file that it began with, without its ending, or ""
 * @typedef {{format: string, version: number, width: number, height: number, layers: Layer[], active: number,
 *   pictures: Picture[], structures: OwnStructure[], settings: Settings}} Doc layers: from back to front, at least one; active: id of the one that is
 *   worked on
 */

export const FORMAT = "normalgan-studio";
export const VERSION = 5;
export const { sides: SIDES, strokes: MOST_STROKES, hints: MOST_HINTS, areas: MOST_AREAS, maskStrokes: MOST_MASK_STROKES, layers: MOST_LAYERS, pictures: MOST_PICTURES, name: LONGEST_NAME } = LIMITS;
/** Kind of a structure that is the user's picture. */
export const OWN = "own";
/** First versions in which a drawing has layers, and in which each layer has its own source. */
const [LAYERED, SOURCED] = [4, 5];

/** @param {number} id @param {string} name @returns {Layer} */
const newLayer = (id, name) => ({ id, name, visible: true, strokes: [], hints: [], areas: [], mask: [], source: null, form: null });

/** Returns the default name of a layer. @param {number} number */
const usualName = (number) => say("layerNumber", { number });

/**
 * Returns an empty drawing.
 * @param {number} width
 * @param {number} height
 * @returns {Doc}
 */
export function newDocument(width, height) {
  const settings = { name: "", file: "" };
  return { format: FORMAT, version: VERSION, width, height, layers: [newLayer(1, usualName(1))], active: 1, pictures: [], structures: [], settings };
}

/** @param {Doc} doc @returns {boolean} */
export const isEmpty = (doc) =>
  !doc.pictures.length && doc.layers.every(({ strokes, hints }) => !strokes.length && !hints.length);

/** Returns the active layer. @param {Doc} doc @returns {Layer} */
export const activeLayer = (doc) => doc.layers.find(({ id }) => id === doc.active) ?? doc.layers[doc.layers.length - 1];

/** @param {Doc} doc @param {number} id @param {Partial<Layer>} change @returns {Doc} */
export function changedLayer(doc, id, change) {
  return { ...doc, layers: doc.layers.map((layer) => (layer.id === id ? { ...layer, ...change } : layer)) };
}

/** Changes the active layer. @param {Doc} doc @param {Partial<Layer>} change @returns {Doc} */
export const withActive = (doc, change) => changedLayer(doc, activeLayer(doc).id, change);

/**
 * Adds an empty layer in front of the active one and makes it active.
 * @param {Doc} doc @param {string} [name]
 * @returns {Doc}
 */
export function withNewLayer(doc, name) {
  const ids = doc.layers.map((layer) => layer.id);
  const id = Math.max(...ids) + 1;
  const taken = new Set(doc.layers.map((layer) => layer.name));
  let number = doc.layers.length + 1;
  while (taken.has(usualName(number))) number += 1;
  const layers = [...doc.layers];
  layers.splice(ids.indexOf(activeLayer(doc).id) + 1, 0, newLayer(id, name ?? usualName(number)));
  return { ...doc, layers, active: id };
}

/**
 * Adds layers in front of the others, or instead of them, and makes the front one active.
 * @param {Doc} doc @param {{name: string, visible: boolean, strokes: Stroke[]}[]} layers from back to front; a name may be empty
 * @param {boolean} instead
 * @returns {Doc}
 */
export function withLayers(doc, layers, instead) {
  const before = instead ? [] : doc.layers;
  const first = Math.max(...doc.layers.map(({ id }) => id)) + 1;
  const added = layers.map(({ name, ...more }, i) => ({ ...newLayer(first + i, name || usualName(before.length + i + 1)), ...more }));
  return { ...doc, layers: [...before, ...added], active: first + added.length - 1 };
}

/** Removes a layer, unless it is the only one. @param {Doc} doc @param {number} id @returns {Doc} */
export function withoutLayer(doc, id) {
  const at = doc.layers.findIndex((layer) => layer.id === id);
  if (at < 0 || doc.layers.length === 1) return doc;
  const layers = doc.layers.filter((layer) => layer.id !== id);
  const active = doc.active === id ? layers[Math.max(0, at - 1)].id : doc.active;
  return { ...doc, layers, active };
}

/** Moves a layer towards the front or the back. @param {Doc} doc @param {number} id @param {number} step @returns {Doc} */
export function withLayerMoved(doc, id, step) {
  const from = doc.layers.findIndex((layer) => layer.id === id);
  const to = from + step;
  if (from < 0 || to < 0 || to >= doc.layers.length) return doc;
  const layers = [...doc.layers];
  layers.splice(to, 0, ...layers.splice(from, 1));
  return { ...doc, layers };
}

const MOST = { strokes: MOST_STROKES, hints: MOST_HINTS, areas: MOST_AREAS, mask: MOST_MASK_STROKES };
/** Names of a layer's lists, each of which has a maximum length. */
export const LISTS = /** @type {(keyof typeof MOST)[]} */ (Object.keys(MOST));

/** Whether a layer is within the limits of a project; a larger one could not be opened again. @param {Pick<Layer, keyof typeof MOST>} layer */
export const hasRoom = (layer) => LISTS.every((list) => layer[list].length <= MOST[list]);

/** @param {Doc} doc @param {Stroke} stroke @returns {Doc} */
export const withStroke = (doc, stroke) => withActive(doc, { strokes: [...activeLayer(doc).strokes, stroke] });

/** @param {Doc} doc @param {Hint} hint @returns {Doc} */
export const withHint = (doc, hint) => withActive(doc, { hints: [...activeLayer(doc).hints, hint] });

/** @param {Doc} doc @param {number} index @param {Partial<Hint>} change @returns {Doc} */
export function changedHint(doc, index, change) {
  return withActive(doc, { hints: activeLayer(doc).hints.map((hint, i) => (i === index ? { ...hint, ...change } : hint)) });
}

/** @param {Doc} doc @param {number} index @returns {Doc} */
export const withoutHint = (doc, index) => withActive(doc, { hints: activeLayer(doc).hints.filter((_, i) => i !== index) });

/** @param {Doc} doc @param {Area} area @returns {Doc} */
export const withArea = (doc, area) => withActive(doc, { areas: [...activeLayer(doc).areas, area] });

/**
 * Adds pictures that serve as structures; if there are too many, unused ones are dropped.
 * @param {Doc} doc @param {OwnStructure[]} more
 * @returns {Doc | null} null: there is no room
 */
export function withStructures(doc, more) {
  const fresh = more.filter(({ id }) => !doc.structures.some((each) => each.id === id));
  if (!fresh.length) return doc;
  const all = [...doc.structures, ...fresh];
  if (all.length <= LIMITS.structures) return { ...doc, structures: all };
  const used = new Set(doc.layers.flatMap(({ areas }) => areas.map(({ structure }) => structure?.picture)));
  const structures = all.filter((each) => used.has(each.id) || fresh.includes(each));
  return structures.length <= LIMITS.structures ? { ...doc, structures } : null;
}

/** Returns the pictures that areas use as structures. @param {Doc} doc @param {Area[]} areas */
export function structuresOf({ structures }, areas) {
  const used = new Set(areas.map(({ structure }) => structure?.picture));
  return structures.filter(({ id }) => used.has(id));
}

/** @param {Doc} doc @param {number} index @param {Partial<Area>} change @returns {Doc} */
export function changedArea(doc, index, change) {
  return withActive(doc, { areas: activeLayer(doc).areas.map((area, i) => (i === index ? { ...area, ...change } : area)) });
}

/** @param {Doc} doc @param {number} index @returns {Doc} */
export const withoutArea = (doc, index) => withActive(doc, { areas: activeLayer(doc).areas.filter((_, i) => i !== index) });

/** @param {Doc} doc @param {MaskStroke} stroke @returns {Doc} */
export const withMaskStroke = (doc, stroke) => withActive(doc, { mask: [...activeLayer(doc).mask, stroke] });

/**
 * Returns the centre of the pixel of a point, or of the nearest pixel on the paper, where the server would put the hint.
 * @param {{x: number, y: number}} at @param {{width: number, height: number}} paper
 */
export function middleOfPixel({ x, y }, { width, height }) {
  /** @param {number} value @param {number} side */
  const clamp = (value, side) => Math.max(0, Math.min(side - 1, Math.floor(value))) + 0.5;
  return { x: clamp(x, width), y: clamp(y, height) };
}

/** Returns the position of an area's mark. @param {Area} area @returns {{x: number, y: number}} */
export function anchorOf({ points, size }) {
  const count = points.length / 2;
  if (size) return { x: points[2 * (count >> 1)], y: points[2 * (count >> 1) + 1] };
  /** @param {number} offset */
  const mean = (offset) => points.reduce((sum, value, i) => (i % 2 === offset ? sum + value : sum), 0) / count;
  return { x: mean(0), y: mean(1) };
}

/** @param {Doc} doc @param {Picture[]} pictures @returns {Doc} */
export const withPictures = (doc, pictures) => ({ ...doc, pictures });

/** Returns a length clamped to the range of a structure's periods. @param {number} period */
export const possiblePeriod = (period) => Math.max(LIMITS.periods.least, Math.min(LIMITS.periods.most, period));

/** @param {Doc} doc @param {Partial<Settings>} settings @returns {Doc} */
export const withSettings = (doc, settings) => ({ ...doc, settings: { ...doc.settings, ...settings } });

/** Returns all strokes but fills, which no map depends on. @param {Stroke[]} strokes */
export const linesOf = (strokes) => strokes.filter(({ kind }) => kind !== "fill");

/** Returns the visible layers that are not empty. @param {Doc} doc @returns {Layer[]} */
export const drawnLayers = (doc) => doc.layers.filter(({ visible, strokes }) => visible && linesOf(strokes).length > 0);

/** Whether a stroke goes along with the lines around it. @param {Stroke} stroke */
export const goesAlong = ({ kind }) => kind === "eraser" || kind === "fill";

/** Whether chosen strokes have lines or pictures, to which points, regions and mask strokes belong. @param {Stroke[]} strokes @param {number[]} chosen their places */
export const hasLines = (strokes, chosen) => chosen.some((i) => !goesAlong(strokes[i]));

/** Whether all lines and pictures are chosen. @param {Stroke[]} strokes @param {number[]} chosen their places */
export const hasAllLines = (strokes, chosen) => hasLines(strokes, chosen) && strokes.every((stroke, i) => goesAlong(stroke) || chosen.includes(i));

/** @param {Stroke[]} a @param {Stroke[]} b */
function drawsAlike(a, b) {
  if (a === b) return true;
  const [from, to] = [linesOf(a), linesOf(b)];
  return from.length === to.length && from.every((stroke, i) => stroke === to[i]);
}

/** Whether two documents give the same map. @param {Doc} a @param {Doc} b @returns {boolean} */
export function paintsAlike(a, b) {
  if (a.width !== b.width || a.height !== b.height) return false;
  if (a.layers === b.layers) return true;
  const [from, to] = [drawnLayers(a), drawnLayers(b)];
  return from.length === to.length && from.every((layer, i) => drawsAlike(layer.strokes, to[i].strokes) &&
    /** @type {const} */ (["id", "hints", "areas", "mask", "source", "form"]).every((part) => layer[part] === to[i][part]));
}

/** Returns all pictures of a document, which must be decoded before it is shown. @param {Doc} doc @returns {string[]} */
export function picturesOf(doc) {
  return [...doc.layers.flatMap(({ strokes }) => strokes), ...doc.pictures].flatMap((each) => ("picture" in each ? [each.picture] : []));
}

// The content of a file may be anything.
/** @typedef {(value: any) => boolean} Check */
/** @type {Check} */
const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
/** @type {Check} */
const isSide = (value) => Number.isInteger(value) && value >= SIDES.least && value <= SIDES.most;
/** @type {Check} */
const isPlaced = (value) =>
  [value.x, value.y, value.width, value.height, value.turn ?? 0].every(isNumber) && [undefined, true, false].includes(value.flipped) && [undefined, true].includes(value.paper) && String(value.picture).startsWith("data:image/png;base64,");
/** @type {Check} */
const isLine = (value) =>
  ["pen", "eraser", "fill"].includes(value.kind) && isNumber(value.size) && value.size > 0 && Array.isArray(value.points) &&
  value.points.length >= 3 && value.points.length % 3 === 0 && value.points.every(isNumber) &&
  (value.colour === undefined || /^#[0-9a-f]{6}$/.test(value.colour)) && (value.mirror === undefined || isNumber(value.mirror)) &&
  (value.carve === undefined || (isNumber(value.carve) && Math.abs(value.carve) <= 1));
/** @param {any} value */
const isNormal = (value) =>
  Array.isArray(value) && value.length === 3 && value.every(isNumber) && Math.abs(Math.hypot(...value) - 1) < 0.05 && value[2] >= LIMITS.leastZ;
/** @type {Check} */
const isHint = (value) =>
  isNumber(value.x) && isNumber(value.y) && isNormal(value.normal) && (value.reach === undefined || isNumber(value.reach));
/** @type {Check} */
const isShare = (value) => isNumber(value) && value >= 0 && value <= 1;
/** @type {Check} */
const isForm = (value) =>
  value === null || value === undefined ||
  (Object.hasOwn(LIMITS.forms, value.kind) && isShare(value.bevel) && value.bevel > 0 && isShare(value.strength));
/** @type {Check} */
const isStructure = (value) =>
  value === undefined ||
  ((value?.kind === OWN ? typeof value.picture === "string" : LIMITS.kinds.includes(value?.kind) && value.picture === undefined) &&
    isNumber(value.period) && value.period >= LIMITS.periods.least && value.period <= LIMITS.periods.most && [value.turn ?? 0, value.x ?? 0, value.y ?? 0].every(isNumber) && [undefined, true, false].includes(value.flipped));
/** @type {Check} */
const isOwnStructure = (value) => typeof value.id === "string" && String(value.picture).startsWith("data:image/png;base64,");
/** @type {Check} */
const isArea = (value) =>
  Array.isArray(value.points) && value.points.length >= (value.size === undefined ? 6 : 2) &&
  value.points.length % 2 === 0 && value.points.every(isNumber) && isNormal(value.normal) &&
  (value.size === undefined || (isNumber(value.size) && value.size > 0)) && isForm(value.form) && [value.soft, value.strength].every((each) => each === undefined || isShare(each)) && [undefined, true, false].includes(value.smooths) && isStructure(value.structure);
/** @type {Check} */
const isMaskStroke = (value) =>
  typeof value.adds === "boolean" && [undefined, true].includes(value.fills) && isNumber(value.size) && value.size > 0 && Array.isArray(value.points) &&
  value.points.length >= 2 && value.points.length % 2 === 0 && value.points.every(isNumber);
/** @type {Check} */
const isPicture = (value) => isPlaced(value) && isNumber(value.opacity) && typeof value.visible === "boolean";
/** @param {unknown} list @param {Check} check @param {number} most */
const isList = (list, check, most) => Array.isArray(list) && list.length <= most && list.every((each) => each && check(each));

/** @type {Check} */
const isLayer = (value) =>
  Number.isInteger(value.id) && value.id >= 0 && typeof value.name === "string" && value.name.length > 0 &&
  value.name.length <= LONGEST_NAME && typeof value.visible === "boolean" && [null, "outline", "model"].includes(value.source) && isForm(value.form) &&
  isList(value.strokes, (stroke) => (stroke.kind === "picture" ? isPlaced(stroke) : isLine(stroke)), MOST_STROKES) &&
  isList(value.hints, isHint, MOST_HINTS) && isList(value.areas, isArea, MOST_AREAS) && isList(value.mask, isMaskStroke, MOST_MASK_STROKES);

/**
 * Converts a document of an older version to the current one. Earlier versions had one source for all layers; the first
 * versions had a single layer, and called reference pictures layers.
 * @param {any} doc
 */
function upgraded(doc) {
  if (!(doc.version < SOURCED)) return doc;
  const source = ["outline", "model"].includes(doc.settings?.source) ? doc.settings.source : null;
  /** @param {any} layer */
  const sourced = (layer) => ({ ...layer, source });
  if (doc.version >= LAYERED) return { ...doc, layers: Array.isArray(doc.layers) ? doc.layers.map(sourced) : doc.layers };
  const { strokes, hints, areas = [], mask = [], layers: pictures } = doc;
  return { ...doc, layers: [sourced({ ...newLayer(1, usualName(1)), strokes, hints, areas, mask })], active: 1, pictures };
}

/**
 * Returns a message about the first point or area with an invalid normal; empty if there is none.
 * @param {any} layers
 */
function wrongNormal(layers) {
  for (const { name, hints, areas } of Array.isArray(layers) ? layers.filter(Boolean) : []) {
    for (const [key, list] of /** @type {const} */ ([["wrongPoint", hints], ["wrongArea", areas]])) {
      const at = Array.isArray(list) ? list.findIndex((each) => each && !isNormal(each.normal)) : -1;
      if (at >= 0) return say(key, { number: at + 1, layer: String(name), normal: JSON.stringify(list[at].normal) });
    }
  }
  return "";
}

/**
 * Returns a document read from a file or the server.
 * @param {unknown} value the parsed JSON
 * @returns {Doc}
 * @throws {Error} with a message if it is not a project.
 */
export function parseDocument(value) {
  const given = /** @type {any} */ (value);
  if (!given || given.format !== FORMAT) throw new Error(text.notProject);
  if (given.version > VERSION) throw new Error(text.newerProject);
  const doc = /** @type {Doc} */ (upgraded(given));
  const { width, height, layers, active, pictures, structures = [] } = doc; // older versions have no structures
  const whole = isSide(width) && isSide(height) && isList(layers, isLayer, MOST_LAYERS) && isList(pictures, isPicture, MOST_PICTURES) && isList(structures, isOwnStructure, LIMITS.structures) &&
    layers.every(({ areas }) => areas.every(({ structure }) => structure?.picture === undefined || structures.some(({ id }) => id === structure.picture))) &&
    new Set(layers.map(({ id }) => id)).size === layers.length && layers.some(({ id }) => id === active);
  if (!whole) throw new Error(wrongNormal(layers) || text.notProject);
  const settings = { name: String(doc.settings?.name ?? ""), file: String(doc.settings?.file ?? "") };
  // Older versions have no forms.
  const formed = layers.map((layer) => (layer.form === undefined ? { ...layer, form: null } : layer));
  return { format: FORMAT, version: VERSION, width, height, layers: formed, active, pictures, structures, settings };
}

/** Minimum distance in pane pixels between a point and its ring's knob, so that the point itself can be dragged too. */
const NEAREST_KNOB = 30;
/** @typedef {{width: number, height: number}} Size */
/** Maximum reach of a point, as a fraction of the drawing's longer side. */
const MOST_REACH = 0.4;

/** @param {Size} doc @returns {number} pixels */
export const mostReach = ({ width, height }) => MOST_REACH * Math.max(width, height);

/** Returns the reach of a point in pixels. @param {{reach?: number}} hint @param {Size} doc */
export const reachOf = ({ reach }, { width, height }) => reach ?? LIMITS.reach * Math.max(width, height);

/**
 * Returns the position of the knob on the ring that shows a point's reach.
 * @param {{x: number, y: number, reach?: number}} hint @param {Size} doc @param {number} scale pixels of the pane for one of the drawing
 */
export function knobOf(hint, doc, scale) {
  const aside = Math.max(reachOf(hint, doc), NEAREST_KNOB / scale) * Math.SQRT1_2;
  return { x: hint.x - aside, y: hint.y + aside };
}
