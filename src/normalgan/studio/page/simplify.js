/** Simplify: a way with fewer points, which goes as it did. */

/** @typedef {{x: number, y: number}} Point */

/** @param {Point} a @param {Point} b */
export const apart = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);

/** How far a point is from the line between two others. @param {Point} at @param {Point} a @param {Point} b */
export function offLine(at, a, b) {
  const length = apart(a, b) || 1e-9;
  const along = Math.max(0, Math.min(1, ((at.x - a.x) * (b.x - a.x) + (at.y - a.y) * (b.y - a.y)) / length ** 2));
  return apart(at, { x: a.x + along * (b.x - a.x), y: a.y + along * (b.y - a.y) });
}

/** Returns the places of the corners in a way (Douglas and Peucker 1973), its ends among them. @param {Point[]} way @param {number} most @param {number} first @param {number} last @returns {number[]} */
export function corners(way, most, first = 0, last = way.length - 1) {
  let [farthest, off] = [-1, most];
  for (let i = first + 1; i < last; i++) {
    const away = offLine(way[i], way[first], way[last]);
    if (away > off) [farthest, off] = [i, away];
  }
  return farthest < 0 ? [first, last] : [...corners(way, most, first, farthest), ...corners(way, most, farthest, last).slice(1)];
}

/** Points of a region, a brush's stroke, a stroke of the mask or a lasso, as the server takes them. */
export const MOST_POINTS = 4000;
/** The least pixels of the drawing by which a way may go elsewhere when points are left out. */
const LEAST_OFF = 0.25;

/**
 * Makes room for more points where there are as many as can be: those are left out that change the way least.
 * @param {number[]} points x, y, x, y, …; the way in place
 */
export function makeRoom(points) {
  if (points.length < 2 * MOST_POINTS) return;
  const way = Array.from({ length: points.length / 2 }, (_, i) => ({ x: points[2 * i], y: points[2 * i + 1] }));
  let kept = way.map((_, i) => i);
  for (let off = LEAST_OFF; kept.length > MOST_POINTS / 2; off *= 2) kept = corners(way, off);
  points.splice(0, points.length, ...kept.flatMap((i) => [way[i].x, way[i].y]));
}
