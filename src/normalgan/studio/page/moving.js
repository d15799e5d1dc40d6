/** Moving: strokes, pictures and whole documents made larger or smaller and put elsewhere. */

/**
 * @typedef {import("./document.js").Doc} Doc @typedef {import("./document.js").Stroke} Stroke
 * @typedef {import("./document.js").Picture} Picture
 * @typedef {{scale: number, x: number, y: number}} Move (x, y) goes to scale · (x, y) + these
 * @typedef {{left: number, top: number, right: number, bottom: number}} Box
 */

/** @param {number[]} points x, y, then more numbers that stay @param {number} stride numbers for a point @param {Move} move */
function moved(points, stride, { scale, x, y }) {
  const offsets = [x, y];
  return points.map((value, i) => (i % stride < 2 ? value * scale + offsets[i % stride] : value));
}

/** @template {{x: number, y: number, width: number, height: number}} T @param {T} placed @param {Move} move @returns {T} */
export function movedPicture(placed, { scale, x, y }) {
  return { ...placed, x: placed.x * scale + x, y: placed.y * scale + y, width: placed.width * scale, height: placed.height * scale };
}

/** @param {Stroke} stroke @param {Move} move @returns {Stroke} */
export function movedStroke(stroke, move) {
  if (stroke.kind === "picture") return movedPicture(stroke, move);
  const mirror = stroke.mirror === undefined ? {} : { mirror: stroke.mirror * move.scale + move.x };
  return { ...stroke, points: moved(stroke.points, 3, move), size: stroke.size * move.scale, ...mirror };
}

/**
 * Returns a document on paper of another size.
 * @param {Doc} doc
 * @param {number} width
 * @param {number} height
 * @param {boolean} along whether what is drawn grows or shrinks with the paper; else it stays as large, in the middle
 * @returns {Doc}
 */
export function onPaper(doc, width, height, along) {
  const scale = along ? Math.min(width / doc.width, height / doc.height) : 1;
  const offset = (/** @type {number} */ to, /** @type {number} */ from) => (along ? (to - from * scale) / 2 : Math.round((to - from) / 2));
  const move = { scale, x: offset(width, doc.width), y: offset(height, doc.height) };
  const clamp = (/** @type {number} */ value, /** @type {number} */ side) => Math.max(0, Math.min(side - 1, Math.floor(value))) + 0.5;
  const layers = doc.layers.map((layer) => ({
    ...layer,
    strokes: layer.strokes.map((stroke) => movedStroke(stroke, move)),
    hints: layer.hints.map((hint) => ({
      ...hint, x: clamp(hint.x * scale + move.x, width), y: clamp(hint.y * scale + move.y, height),
      ...(hint.reach !== undefined && { reach: hint.reach * scale }),
    })),
    areas: layer.areas.map((area) => ({ ...area, points: moved(area.points, 2, move), ...(area.size && { size: area.size * scale }) })),
    mask: layer.mask.map((stroke) => ({ ...stroke, points: moved(stroke.points, 2, move), size: stroke.size * scale })),
  }));
  return { ...doc, width, height, layers, pictures: doc.pictures.map((picture) => movedPicture(picture, move)) };
}

/** Returns what a stroke or picture covers. @param {Stroke | Picture} item @returns {Box} */
export function extentOf(item) {
  if ("picture" in item) return { left: item.x, top: item.y, right: item.x + item.width, bottom: item.y + item.height };
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

/** Returns what several boxes cover; null for none. @param {Box[]} boxes @returns {Box | null} */
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
 * @param {number} reach how far beside it still counts
 */
export function isHit(item, { x, y }, reach) {
  const { left, top, right, bottom } = extentOf(item);
  if (x < left - reach || x > right + reach || y < top - reach || y > bottom + reach) return false;
  if ("picture" in item) return true;
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
