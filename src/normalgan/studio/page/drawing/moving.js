/** Moving: move, scale, rotate and flip strokes, pictures and whole documents. */

import { SIDES, goesAlong, hasAllLines, hasLines, middleOfPixel, possiblePeriod } from "./document.js";
import { sidesOf } from "./strokes.js";

/**
 * @typedef {import("./document.js").Doc} Doc @typedef {import("./document.js").Stroke} Stroke
 * @typedef {import("./document.js").Layer} Layer @typedef {import("./document.js").Picture} Picture
 * @typedef {{scale: number, x: number, y: number, angle?: number, flipped?: boolean}} Move flipped from left to right, then
 *   turned clockwise by the angle in radians, then made larger, then moved by x and y
 * @typedef {{left: number, top: number, right: number, bottom: number}} Box
 * @typedef {{x: number, y: number}} Point
 */

/** @param {number[]} points x, y, then more numbers that stay @param {number} stride numbers for a point @param {Move} move */
function moved(points, stride, move) {
  const place = placeBy(move);
  const all = [...points];
  for (let i = 0; i < points.length; i += stride) {
    const { x, y } = place({ x: points[i], y: points[i + 1] });
    [all[i], all[i + 1]] = [x, y];
  }
  return all;
}

/** Returns a function that applies a move to a point. @param {Move} move @returns {(point: Point) => Point} */
function placeBy({ scale, x, y, angle = 0, flipped = false }) {
  const [cos, sin] = [scale * Math.cos(angle), scale * Math.sin(angle)];
  return (point) => {
    const across = flipped ? -point.x : point.x;
    return { x: cos * across - sin * point.y + x, y: sin * across + cos * point.y + y };
  };
}

/**
 * Returns a move with a fixed point.
 * @param {Point} point @param {{scale: number, angle?: number, flipped?: boolean}} how
 * @returns {Move}
 */
export function aboutPoint({ x, y }, { scale, angle = 0, flipped = false }) {
  const [cos, sin, across] = [Math.cos(angle), Math.sin(angle), flipped ? -x : x];
  return { scale, angle, flipped, x: x - scale * (cos * across - sin * y), y: y - scale * (sin * across + cos * y) };
}

/** Returns a normal rotated with the surface. @param {import("./document.js").Normal} normal @param {Move} move @returns {import("./document.js").Normal} */
function movedNormal([x, y, z], { angle = 0, flipped = false }) {
  if (!angle && !flipped) return [x, y, z];
  const [cos, sin, across] = [Math.cos(angle), Math.sin(angle), flipped ? -x : x];
  // The normal's y points up, the paper's down.
  return [cos * across + sin * y, cos * y - sin * across, z];
}

/** @template {import("./document.js").Box} T @param {T} placed @param {Move} move @returns {T} */
export function movedPicture(placed, move) {
  const { scale, angle = 0, flipped = false } = move;
  const [width, height] = [placed.width * scale, placed.height * scale];
  const { x, y } = placeBy(move)({ x: placed.x + placed.width / 2, y: placed.y + placed.height / 2 });
  const turn = (flipped ? -1 : 1) * (placed.turn ?? 0) + angle;
  return {
    ...placed, x: x - width / 2, y: y - height / 2, width, height,
    ...((turn || placed.turn) && { turn: Math.atan2(Math.sin(turn), Math.cos(turn)) }),
    ...((flipped || placed.flipped) && { flipped: flipped !== (placed.flipped ?? false) }),
  };
}

/** A mirrored line becomes two lines if its axis is no longer vertical. @param {Stroke} stroke @param {Move} move @returns {Stroke[]} */
function movedStroke(stroke, move) {
  if (stroke.kind === "picture") return [movedPicture(stroke, move)];
  const { mirror, ...line } = stroke;
  const upright = Math.abs(Math.sin(move.angle ?? 0)) < 1e-9;
  const size = stroke.size * move.scale;
  if (mirror === undefined || !upright) return sidesOf(stroke).map(({ points }) => ({ ...line, points: moved(points, 3, move), size }));
  return [{ ...line, points: moved(stroke.points, 3, move), size, mirror: placeBy(move)({ x: mirror, y: 0 }).x }];
}

/** A point stays on the paper. @param {import("./document.js").Hint} hint @param {Move} move @param {{width: number, height: number}} paper */
const movedHint = (hint, move, paper) => ({
  ...hint, ...middleOfPixel(placeBy(move)(hint), paper), normal: movedNormal(hint.normal, move),
  ...(hint.reach !== undefined && { reach: hint.reach * move.scale }),
});

/** @param {import("./document.js").Area} area @param {Move} move @returns {import("./document.js").Area} */
const movedArea = (area, move) => ({
  ...area, points: moved(area.points, 2, move), normal: movedNormal(area.normal, move), ...(area.size && { size: area.size * move.scale }),
  ...(area.structure && { structure: movedStructure(area.structure, move) }),
});

/** The tiles stay where they are on the surface. @param {import("./document.js").Structure} structure @param {Move} move @returns {import("./document.js").Structure} */
function movedStructure(structure, move) {
  const { scale, angle = 0, flipped = false } = move;
  const { x, y } = placeBy(move)({ x: structure.x ?? 0, y: structure.y ?? 0 });
  return { ...structure, x, y, period: possiblePeriod(structure.period * scale), turn: (flipped ? -1 : 1) * (structure.turn ?? 0) + angle, flipped: flipped !== (structure.flipped ?? false) };
}

/** @param {import("./document.js").MaskStroke} stroke @param {Move} move @returns {import("./document.js").MaskStroke} */
const movedMask = (stroke, move) => ({ ...stroke, points: moved(stroke.points, 2, move), size: stroke.size * move.scale });

/**
 * @typedef {{strokes: Set<number>, hints: Set<number>, areas: Set<number>, mask: Set<number>}} Along indices, in a layer's
 *   lists, of everything that moves together
 */

/** Distance in pixels within which the edge of a fill lies on a line. */
const ON_LINE = 2;

/**
 * Returns whether more of a fill's edge lies on some lines than on others; null if none of it lies on a line.
 * @param {import("./document.js").Line} fill @param {Stroke[]} some @param {Stroke[]} others
 */
function isBoundedBy(fill, some, others) {
  const { left, top, right, bottom } = extentOf(fill);
  const [mine, theirs] = [some, others].map((list) => list.filter((each) => {
    const box = extentOf(each);
    return !goesAlong(each) && box.left <= right && box.right >= left && box.top <= bottom && box.bottom >= top;
  }));
  const isOn = (/** @type {Stroke[]} */ list, /** @type {Point} */ at) => list.some((each) => isHit(each, at, ON_LINE));
  const { points } = fill;
  let [own, other] = [0, 0];
  for (let i = 0; i < points.length; i += 3) {
    const next = (i + 3) % points.length;
    const at = { x: points[i], y: points[i + 1] };
    const length = Math.hypot(points[next] - at.x, points[next + 1] - at.y);
    if (isOn(mine, at)) own += length;
    else if (isOn(theirs, at)) other += length;
  }
  return own || other ? own > other : null;
}

/**
 * Returns everything that moves with selected strokes: erasers, fills, points, regions and mask strokes among them. If all strokes
 * of a layer are selected, everything on the layer moves. A fill that is selected alone takes nothing along. A fill goes with the
 * lines that bound it.
 * @param {Layer} layer
 * @param {number[]} chosen places of the strokes
 * @param {((point: Point) => boolean) | null} [inside] tests whether a point lies among them; by default, within their convex hull
 * @returns {Along}
 */
export function alongWith({ strokes, hints, areas, mask }, chosen, inside = null) {
  if (!hasLines(strokes, chosen)) return { strokes: new Set(chosen), hints: new Set(), areas: new Set(), mask: new Set() };
  const all = hasAllLines(strokes, chosen);
  const hull = all || inside ? [] : hullOf(chosen.flatMap((i) => cornersAbout(strokes[i])));
  /** @template T @param {T[]} list @param {(each: T) => Point | null} at @returns {Set<number>} */
  const among = (list, at) => new Set(list.flatMap((each, i) => {
    const point = at(each);
    return point && (all || (inside ? inside(point) : isInside(hull, point))) ? [i] : [];
  }));
  const [mine, theirs] = [chosen.map((i) => strokes[i]), strokes.filter((_, i) => !chosen.includes(i))];
  const marks = among(strokes, (stroke) => (stroke.kind !== "picture" && goesAlong(stroke) ? middleOf(stroke.points, 3) : null));
  const fills = new Map(strokes.flatMap((stroke, i) => (stroke.kind === "fill" && !all ? [[i, isBoundedBy(stroke, mine, theirs)]] : [])));
  const along = strokes.flatMap((_, i) => (fills.get(i) ?? marks.has(i) ? [i] : []));
  return {
    strokes: new Set([...chosen, ...along]), hints: among(hints, (hint) => hint),
    areas: among(areas, ({ points }) => middleOf(points, 2)), mask: among(mask, ({ points }) => middleOf(points, 2)),
  };
}

/**
 * Returns a layer with some of its items moved.
 * @param {Layer} layer @param {Along} along @param {Move} move @param {{width: number, height: number}} doc its paper
 * @returns {{layer: Layer, chosen: number[], along: Along}} chosen: where the moved strokes are now, but for erasers; along: with erasers
 */
export function movedParts(layer, along, move, doc) {
  /** @template T @param {T[]} list @param {Set<number>} places @param {(each: T) => T} work @returns {T[]} */
  const some = (list, places, work) => (places.size ? list.map((each, i) => (places.has(i) ? work(each) : each)) : list);
  /** @type {Stroke[]} */
  const strokes = [];
  /** @type {Set<number>} */
  const places = new Set();
  for (const [i, stroke] of layer.strokes.entries()) {
    for (const each of along.strokes.has(i) ? movedStroke(stroke, move) : [stroke]) {
      if (along.strokes.has(i)) places.add(strokes.length);
      strokes.push(each);
    }
  }
  const moved = {
    ...layer,
    strokes: along.strokes.size ? strokes : layer.strokes,
    hints: some(layer.hints, along.hints, (each) => movedHint(each, move, doc)),
    areas: some(layer.areas, along.areas, (each) => movedArea(each, move)),
    mask: some(layer.mask, along.mask, (each) => movedMask(each, move)),
  };
  return { layer: moved, chosen: [...places].filter((i) => strokes[i].kind !== "eraser"), along: { ...along, strokes: places } };
}

/** Returns the centre of the bounding box of points. @param {number[]} points @param {number} stride numbers for a point @returns {Point} */
function middleOf(points, stride) {
  const box = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };
  for (let i = 0; i < points.length; i += stride) {
    box.left = Math.min(box.left, points[i]);
    box.right = Math.max(box.right, points[i]);
    box.top = Math.min(box.top, points[i + 1]);
    box.bottom = Math.max(box.bottom, points[i + 1]);
  }
  return { x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 };
}

/** Returns the corners of a picture, which may be rotated. @param {import("./document.js").Box} placed @returns {Point[]} */
function cornersOf({ x, y, width, height, turn = 0 }) {
  const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
  return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([across, down]) => {
    const [dx, dy] = [(across * width) / 2, (down * height) / 2];
    return { x: x + width / 2 + cos * dx - sin * dy, y: y + height / 2 + sin * dx + cos * dy };
  });
}

/** Returns points around everything that a stroke covers. @param {Stroke} stroke @returns {Point[]} */
function cornersAbout(stroke) {
  if (stroke.kind === "picture") return cornersOf(stroke);
  const reach = stroke.size / 2;
  return sidesOf(stroke).flatMap(({ points }) => {
    /** @type {Point[]} */
    const around = [];
    for (let i = 0; i < points.length; i += 3) {
      for (const [dx, dy] of [[1, 1], [1, -1], [-1, 1], [-1, -1]]) around.push({ x: points[i] + dx * reach, y: points[i + 1] + dy * reach });
    }
    return around;
  });
}

/** Returns the convex hull of points, by Andrew's monotone chain. @param {Point[]} points @returns {Point[]} */
function hullOf(points) {
  const sorted = [...points].sort((a, b) => a.x - b.x || a.y - b.y);
  /** @param {Point[]} way */
  const half = (way) => {
    /** @type {Point[]} */
    const hull = [];
    for (const point of way) {
      while (hull.length > 1 && turnOf(hull[hull.length - 2], hull[hull.length - 1], point) <= 0) hull.pop();
      hull.push(point);
    }
    return hull.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/** Positive if the path from a via b to c turns clockwise on the screen. @param {Point} a @param {Point} b @param {Point} c */
const turnOf = (a, b, c) => (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);

/** @param {Point[]} hull @param {Point} point */
const isInside = (hull, point) => hull.length > 2 && hull.every((from, i) => turnOf(from, hull[(i + 1) % hull.length], point) >= 0);

/**
 * Returns a document on paper of another size.
 * @param {Doc} doc
 * @param {number} width
 * @param {number} height
 * @param {boolean} along whether the drawing is scaled with the paper; otherwise it keeps its size, centred
 * @returns {Doc}
 */
export function onPaper(doc, width, height, along) {
  const scale = along ? Math.min(width / doc.width, height / doc.height) : 1;
  const offset = (/** @type {number} */ to, /** @type {number} */ from) => (along ? (to - from * scale) / 2 : Math.round((to - from) / 2));
  return movedOnto(doc, width, height, { scale, x: offset(width, doc.width), y: offset(height, doc.height) });
}

/**
 * Returns a document on paper that is as large as a box of it, or a little larger where that would be too small.
 * @param {Doc} doc
 * @param {Box} box in whole pixels
 * @returns {Doc}
 */
export function trimmedTo(doc, { left, top, right, bottom }) {
  const [width, height] = [right - left, bottom - top].map((side) => Math.max(SIDES.least, side));
  /** @param {number} paper @param {number} first @param {number} end */
  const offset = (paper, first, end) => Math.floor((paper - (end - first)) / 2) - first;
  return movedOnto(doc, width, height, { scale: 1, x: offset(width, left, right), y: offset(height, top, bottom) });
}

/** Moves the whole content of a document to paper of another size. @param {Doc} doc @param {number} width @param {number} height @param {Move} move @returns {Doc} */
function movedOnto(doc, width, height, move) {
  const places = (/** @type {unknown[]} */ list) => new Set(list.keys());
  const layers = doc.layers.map((layer) => {
    const all = { strokes: places(layer.strokes), hints: places(layer.hints), areas: places(layer.areas), mask: places(layer.mask) };
    return movedParts(layer, all, move, { width, height }).layer;
  });
  return { ...doc, width, height, layers, pictures: doc.pictures.map((picture) => movedPicture(picture, move)) };
}

/** Returns the bounding box of a stroke or picture. @param {Stroke | Picture} item @returns {Box} */
export function extentOf(item) {
  if ("picture" in item) {
    const corners = cornersOf(item);
    const [xs, ys] = [corners.map(({ x }) => x), corners.map(({ y }) => y)];
    return { left: Math.min(...xs), top: Math.min(...ys), right: Math.max(...xs), bottom: Math.max(...ys) };
  }
  const reach = item.size / 2;
  const box = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };
  for (let i = 0; i < item.points.length; i += 3) {
    const [x, y] = [item.points[i], item.points[i + 1]];
    for (const each of item.mirror === undefined ? [x] : [x, 2 * item.mirror - x]) {
      box.left = Math.min(box.left, each - reach);
      box.right = Math.max(box.right, each + reach);
    }
    box.top = Math.min(box.top, y - reach);
    box.bottom = Math.max(box.bottom, y + reach);
  }
  return box;
}

/** Returns the union of boxes; null for none. @param {Box[]} boxes @returns {Box | null} */
export function unitedBox(boxes) {
  if (!boxes.length) return null;
  return {
    left: Math.min(...boxes.map((each) => each.left)), top: Math.min(...boxes.map((each) => each.top)),
    right: Math.max(...boxes.map((each) => each.right)), bottom: Math.max(...boxes.map((each) => each.bottom)),
  };
}

/**
 * Returns whether a point lies on a stroke or a picture.
 * @param {Stroke | Picture} item
 * @param {{x: number, y: number}} at
 * @param {number} reach the distance up to which a near miss counts
 */
export function isHit(item, { x, y }, reach) {
  const { left, top, right, bottom } = extentOf(item);
  if (x < left - reach || x > right + reach || y < top - reach || y > bottom + reach) return false;
  if ("picture" in item) return isInside(cornersOf(item), { x, y });
  const near = item.size / 2 + reach;
  const on = (/** @type {number} */ px) => {
    const { points } = item;
    for (let i = 0; i < points.length; i += 3) {
      const from = Math.max(0, i - 3);
      const [ax, ay, bx, by] = [points[from], points[from + 1], points[i], points[i + 1]];
      const length = (bx - ax) ** 2 + (by - ay) ** 2;
      const t = length ? Math.max(0, Math.min(1, ((px - ax) * (bx - ax) + (y - ay) * (by - ay)) / length)) : 0;
      if (Math.hypot(px - ax - t * (bx - ax), y - ay - t * (by - ay)) <= near) return true;
    }
    return false;
  };
  return on(x) || (item.mirror !== undefined && on(2 * item.mirror - x));
}
