/** Quick shape: find the line, polygon, circle or ellipse that a stroke resembles. */

import { apart, corners, offLine } from "./simplify.js";

/** @typedef {{x: number, y: number}} Point */

/** Maximum distance between the ends of a closed stroke, as a fraction of its length. */
const CLOSED = 0.15;
/** Maximum deviation from a straight line, as a fraction of the line's length. */
const STRAIGHT = 0.12;
/** Minimum distance of a corner from the side that it interrupts, as a fraction of the stroke's size. */
const CORNER = 0.08;
/** Maximum mean distance from a shape, as a fraction of the stroke's size. */
const FITS = 0.06;
/** The same for an open polyline; it is stricter, because a curve has no straight sides. */
const SIDED = 0.02;
/** Factor by which a polygon must fit better to be chosen instead of an ellipse. */
const BETTER = 0.6;
const MOST_CORNERS = 8;
/** Maximum aspect ratio of an ellipse that becomes a circle. */
const ROUND = 1.2;
/** Maximum deviation in radians of a quadrilateral's corners from right angles to become a rectangle, and of an axis from the paper's. */
const [RIGHT, LEVEL] = [0.3, 0.12];
/** Number of points of an ellipse. */
const STEPS = 96;

/** Returns evenly spaced points along a path. @param {Point[]} way @param {number} count */
function spaced(way, count) {
  const ends = [0];
  for (let i = 1; i < way.length; i++) ends.push(ends[i - 1] + apart(way[i], way[i - 1]));
  const whole = ends[ends.length - 1];
  let i = 0;
  return Array.from({ length: count }, (_, k) => {
    const at = (whole * k) / (count - 1);
    while (i < way.length - 2 && ends[i + 1] < at) i++;
    const share = (at - ends[i]) / Math.max(ends[i + 1] - ends[i], 1e-9);
    return { x: way[i].x + share * (way[i + 1].x - way[i].x), y: way[i].y + share * (way[i + 1].y - way[i].y) };
  });
}

/** Returns the line through points: a point of it, and its angle. @param {Point[]} points */
function lineThrough(points) {
  const middle = mean(points);
  let [xx, xy, yy] = [0, 0, 0];
  for (const { x, y } of points) {
    xx += (x - middle.x) ** 2;
    xy += (x - middle.x) * (y - middle.y);
    yy += (y - middle.y) ** 2;
  }
  return { ...middle, angle: Math.atan2(2 * xy, xx - yy) / 2 };
}

/** @param {Point[]} points @returns {Point} */
const mean = (points) => ({
  x: points.reduce((sum, { x }) => sum + x, 0) / points.length,
  y: points.reduce((sum, { y }) => sum + y, 0) / points.length,
});

/** @typedef {ReturnType<typeof lineThrough>} Side */

/** Returns the intersection of two lines; null if they are nearly parallel. @param {Side} a @param {Side} b @returns {Point | null} */
function meeting(a, b) {
  const across = Math.sin(b.angle - a.angle);
  if (Math.abs(across) < 0.2) return null;
  const along = ((b.x - a.x) * Math.sin(b.angle) - (b.y - a.y) * Math.cos(b.angle)) / across;
  return { x: a.x + along * Math.cos(a.angle), y: a.y + along * Math.sin(a.angle) };
}

/** Returns the corners of a closed path, or null if it has too few or too many. @param {Point[]} way evenly spaced, its end where it began @param {number} size */
function polygonOf(way, size) {
  // The farthest point is a corner, so the path starts there.
  const middle = mean(way);
  const start = way.reduce((most, at, i) => (apart(at, middle) > apart(way[most], middle) ? i : most), 0);
  const round = [...way.slice(start), ...way.slice(1, start + 1)];
  const places = corners(round, CORNER * size);
  const count = places.length - 1;
  if (count < 3 || count > MOST_CORNERS) return null;
  let sides = places.slice(1).map((end, k) => {
    const rim = Math.round((end - places[k]) * 0.15); // corners are drawn round
    return lineThrough(round.slice(places[k] + rim, end - rim + 1));
  });
  if (count === 4) sides = squared(sides);
  return sides.map((side, k) => meeting(sides[(k + count - 1) % count], side) ?? round[places[k]]);
}

/** Turns four sides into a rectangle if they are close to one. @param {Side[]} sides */
function squared(sides) {
  /** @param {number} angle */
  const quarter = (angle) => Math.atan2(Math.sin(4 * angle), Math.cos(4 * angle)) / 4;
  const angles = sides.map(({ angle }, k) => quarter(angle - sides[0].angle) + sides[0].angle + (k % 2 ? Math.PI / 2 : 0));
  const usual = sides[0].angle + angles.reduce((sum, angle, k) => sum + angle - sides[0].angle - (k % 2 ? Math.PI / 2 : 0), 0) / 4;
  const right = sides.every(({ angle }, k) => Math.abs(Math.sin(angle - usual - (k % 2 ? Math.PI / 2 : 0))) < Math.sin(RIGHT));
  if (!right) return sides;
  const level = Math.abs(quarter(usual)) < LEVEL ? usual - quarter(usual) : usual;
  return sides.map((side, k) => ({ ...side, angle: level + (k % 2 ? Math.PI / 2 : 0) }));
}

/** Returns the ellipse with the area's moments. @param {Point[]} way closed */
function ellipseOf(way) {
  let [area, cx, cy] = [0, 0, 0];
  const from = way[0];
  /** @type {[Point, Point, number][]} */
  const slices = way.slice(1).map((b, i) => {
    const [a, c] = [{ x: way[i].x - from.x, y: way[i].y - from.y }, { x: b.x - from.x, y: b.y - from.y }];
    return [a, c, a.x * c.y - c.x * a.y];
  });
  for (const [a, b, twice] of slices) {
    area += twice / 2;
    cx += ((a.x + b.x) * twice) / 6;
    cy += ((a.y + b.y) * twice) / 6;
  }
  if (Math.abs(area) < 1e-6) return null;
  [cx, cy] = [cx / area, cy / area];
  let [xx, xy, yy] = [-cx * cx, -cx * cy, -cy * cy];
  for (const [a, b, twice] of slices) {
    xx += ((a.x * a.x + a.x * b.x + b.x * b.x) * twice) / 12 / area;
    yy += ((a.y * a.y + a.y * b.y + b.y * b.y) * twice) / 12 / area;
    xy += ((a.x * b.y + 2 * a.x * a.y + 2 * b.x * b.y + b.x * a.y) * twice) / 24 / area;
  }
  const [half, spread] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
  let [long, short] = [2 * Math.sqrt(Math.max(half + spread, 0)), 2 * Math.sqrt(Math.max(half - spread, 0))];
  let angle = Math.atan2(2 * xy, xx - yy) / 2;
  if (short <= 0) return null;
  if (long < ROUND * short) long = short = Math.sqrt(long * short);
  const upright = Math.round(angle / (Math.PI / 2)) * (Math.PI / 2);
  if (Math.abs(angle - upright) < LEVEL) angle = upright;
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return Array.from({ length: STEPS + 1 }, (_, k) => {
    const [u, v] = [long * Math.cos((2 * Math.PI * k) / STEPS), short * Math.sin((2 * Math.PI * k) / STEPS)];
    return { x: from.x + cx + u * cos - v * sin, y: from.y + cy + u * sin + v * cos };
  });
}

/** Returns the mean distance of points from a shape. @param {Point[]} way @param {Point[]} shape */
const off = (way, shape) =>
  way.reduce((sum, at) => sum + Math.min(...shape.slice(1).map((b, i) => offLine(at, shape[i], b))), 0) / way.length;

/**
 * Returns the corners of the shape that a stroke resembles, or the points of a circle or an ellipse; null if there is none.
 * @param {Point[]} drawn
 * @returns {{points: Point[], sharp: boolean} | null} sharp: whether they are corners
 */
export function quickShape(drawn) {
  if (drawn.length < 2) return null;
  const [first, last] = [drawn[0], drawn[drawn.length - 1]];
  const way = spaced(drawn, 160);
  const length = drawn.slice(1).reduce((sum, at, i) => sum + apart(at, drawn[i]), 0);
  const [xs, ys] = [way.map(({ x }) => x), way.map(({ y }) => y)];
  const size = Math.hypot(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
  if (apart(first, last) > CLOSED * length) {
    const strays = Math.max(...way.map((at) => offLine(at, first, last)));
    if (strays < STRAIGHT * apart(first, last)) return { points: [first, last], sharp: true };
    const bends = corners(way, CORNER * size).map((i) => way[i]);
    return bends.length <= MOST_CORNERS && off(way, bends) < SIDED * size ? { points: bends, sharp: true } : null;
  }
  const closed = spaced([...drawn, first], 160);
  const [ellipse, polygon] = [ellipseOf(closed), polygonOf(closed, size)];
  const [round, sided] = [ellipse ? off(closed, ellipse) : Infinity, polygon ? off(closed, [...polygon, polygon[0]]) : Infinity];
  if (Math.min(round, sided) > FITS * size) return null;
  if (polygon && sided < BETTER * round) return { points: [...polygon, polygon[0]], sharp: true };
  return ellipse && { points: ellipse, sharp: false };
}
