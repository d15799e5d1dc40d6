/** Figures: finds the separate figures of a page, like normalgan.inference.composites.figures and islands in Python, and the outline of each. */

import { DRAWINGS, FIGURES, ISLANDS, REGIONS, SHEETS } from "./constants.js";
import { components, distance, resized, where } from "./raster.js";

/** @typedef {import("./result/findings.js").Finding} Finding */
/** @typedef {import("./drawing/lasso.js").Lasso} Outline */
/** @typedef {{left: number, top: number, right: number, bottom: number}} Box */
/** @typedef {{box: Box, isOwn: (x: number, y: number) => boolean}} Cell a figure's part of the page; isOwn: of the pixels in its box */

const { ALIKE, LEAST, OWN_MIDDLE, ROOM } = FIGURES;

/**
 * Returns the finding that a page shows separate figures, if it does. Areas that a line connects are one figure; the reader
 * predicts the middle of each pixel's object, and an area far from its middle is a part of another.
 * @param {Float32Array} ink @param {Float32Array} presence @param {number} wide @param {number} high at the size of the vote
 * @param {import("./reader.js").Reading} reading @param {number} scale pixels of the drawing for one of these
 * @returns {Finding[]}
 */
export function severalFigures(ink, presence, wide, high, reading, scale) {
  const body = where(presence, (value, i) => value > 0.5 || ink[i] > REGIONS.INKED);
  const { labels, boxes } = components(body, wide, high, 8);
  const sums = new Float64Array(boxes.length);
  presence.forEach((value, i) => { sums[labels[i]] += value; });
  const most = boxes.reduce((area, box, k) => (k ? Math.max(area, box.area) : area), 0);
  const large = boxes.map((_, k) => k).filter((k) => k && boxes[k].area > ALIKE * most && sums[k] / boxes[k].area > LEAST);
  if (large.length < 2) return [];
  const numbers = new Int32Array(boxes.length).fill(-1);
  large.forEach((k, number) => { numbers[k] = number; });
  const areas = labels.map((label) => numbers[label]);
  const middles = middlesOf(areas, large.length, reading, wide, high);
  const [groups, count] = grouped(large.map((k) => boxes[k]), middles);
  if (count < 2) return [];
  const owner = nearest(areas.map((area) => (area < 0 ? -1 : groups[area])), count, wide, high);
  return finding(cellsOf(owner, body, count, wide, high, scale), scale);
}

/**
 * Returns the finding that the opaque parts of a transparent page are separate figures, if at least two are of similar size.
 * @param {{pixels: Uint8Array, width: number, height: number}} plane with opacity @param {number} scale pixels of the finding for one of these
 * @returns {Finding[]}
 */
export function severalIslands({ pixels, width, height }, scale) {
  const opaque = Uint8Array.from({ length: width * height }, (_, i) => Number(pixels[4 * i + 3] > ISLANDS.FAINT));
  const { labels, boxes } = components(opaque, width, height, 8);
  const owners = ownersOf(boxes.slice(1));
  const whole = owners.flatMap((owner, part) => (owner === part ? [part] : []));
  if (whole.length < 2 || whole.length > SHEETS.MOST_CELLS) return [];
  const cells = whole.map((island) => {
    const parts = boxes.slice(1).filter((_, part) => owners[part] === island);
    const box = {
      left: Math.min(...parts.map(({ left }) => left)), top: Math.min(...parts.map(({ top }) => top)),
      right: Math.max(...parts.map(({ right }) => right)), bottom: Math.max(...parts.map(({ bottom }) => bottom)),
    };
    return { box, isOwn: (/** @type {number} */ x, /** @type {number} */ y) => !labels[y * width + x] || owners[labels[y * width + x] - 1] === island };
  }).filter(({ box }) => Math.min(box.right - box.left, box.bottom - box.top) >= DRAWINGS.SMALLEST);
  const areas = cells.map(areaOf);
  return areas.filter((area) => area > ALIKE * Math.max(...areas)).length > 1 ? finding(cells, scale) : [];
}

/**
 * Returns the part that each part belongs to: a small one, such as an eye or a spark, to the large one next to it, and one inside
 * the box of another to that.
 * @param {Box[]} boxes
 */
function ownersOf(boxes) {
  const spans = boxes.map(({ left, top, right, bottom }) => Math.max(right - left, bottom - top));
  const least = ISLANDS.SMALL * Math.max(...spans);
  const owners = boxes.map((_, part) => part);
  const large = owners.filter((part) => spans[part] >= least);
  boxes.forEach((box, part) => {
    if (spans[part] >= least) return;
    const away = large.map((other) => apart(box, boxes[other]));
    const nearby = away.indexOf(Math.min(...away));
    if (away[nearby] <= ISLANDS.BESIDE * spans[large[nearby]] || spans[part] < DRAWINGS.SMALLEST) owners[part] = large[nearby];
  });
  for (const part of large) {
    const around = large.find((other) => spans[other] > spans[part] && holds(boxes[other], boxes[part]));
    if (around !== undefined) owners.forEach((owner, each) => { if (owner === part) owners[each] = owners[around]; });
  }
  return owners;
}

/** Returns the distance between two boxes. @param {Box} one @param {Box} other */
const apart = (one, other) => Math.hypot(
  Math.max(other.left - one.right, one.left - other.right, 0), Math.max(other.top - one.bottom, one.top - other.bottom, 0));

/** Whether a box lies within another. @param {Box} outer @param {Box} inner */
const holds = (outer, inner) => outer.left <= inner.left && outer.top <= inner.top && outer.right >= inner.right && outer.bottom >= inner.bottom;

/** Returns the number of pixels of a cell. @param {Cell} cell */
function areaOf({ box: { left, top, right, bottom }, isOwn }) {
  let area = 0;
  for (let y = top; y < bottom; y++) for (let x = left; x < right; x++) area += Number(isOwn(x, y));
  return area;
}

/** Returns the finding about the cells of figures. @param {Cell[]} cells @param {number} scale pixels of the drawing for one of theirs @returns {Finding[]} */
function finding(cells, scale) {
  const ordered = inRows(cells);
  const places = ordered.map(({ box }) => /** @type {[number, number]} */ ([((box.left + box.right) / 2) * scale, ((box.top + box.bottom) / 2) * scale]));
  const outlines = ordered.map((cell) => outlinesOf(cell).map((line) => line.map((each) => each * scale)));
  return [{ code: "figures", places, count: ordered.length, outlines }];
}

/** Returns the mean of the middles that the reader predicts in each area. @param {Int32Array} areas @param {number} count @param {import("./reader.js").Reading} reading @param {number} wide @param {number} high */
function middlesOf(areas, count, { middle, width, height }, wide, high) {
  const seen = middle.map((each) => resized(each, width, height, wide, high, 1, "points"));
  const [sums, counts] = [Array.from({ length: count }, () => [0, 0]), new Float64Array(count)];
  areas.forEach((area, i) => {
    if (area < 0) return;
    sums[area][0] += seen[0][i] * wide;
    sums[area][1] += seen[1][i] * high;
    counts[area] += 1;
  });
  return sums.map(([x, y], area) => [x / counts[area], y / counts[area]]);
}

/** Returns the figure of each area, and their number: an area joins the one nearest to its middle, if that is not its own. @param {Box[]} boxes @param {number[][]} middles @returns {[number[], number]} */
function grouped(boxes, middles) {
  const groups = boxes.map((_, area) => area);
  boxes.forEach(({ left, top, right, bottom }, area) => {
    const [x, y] = middles[area];
    const off = Math.hypot(x - (left + right) / 2, y - (top + bottom) / 2) / Math.max(right - left, bottom - top);
    if (off <= OWN_MIDDLE) return;
    const away = boxes.map((box, other) => (other === area ? Infinity : Math.max(box.left - x, x - box.right, box.top - y, y - box.bottom)));
    const [from, to] = [groups[area], groups[away.indexOf(Math.min(...away))]];
    groups.forEach((group, each) => { if (group === from) groups[each] = to; });
  });
  const names = [...new Set(groups)];
  return [groups.map((group) => names.indexOf(group)), names.length];
}

/** Returns the nearest figure of each pixel. @param {Int32Array} figure -1 for none @param {number} count @param {number} wide @param {number} high */
function nearest(figure, count, wide, high) {
  const owner = new Int32Array(figure.length);
  const least = new Float32Array(figure.length).fill(Infinity);
  for (let number = 0; number < count; number++) {
    const away = distance(where(figure, (each) => each !== number), wide, high);
    for (let i = 0; i < owner.length; i++) if (away[i] < least[i]) [owner[i], least[i]] = [number, away[i]];
  }
  return owner;
}

/** @param {Int32Array} owner @param {Uint8Array} drawn lines and bodies @param {number} count @param {number} wide @param {number} high @param {number} scale @returns {Cell[]} */
function cellsOf(owner, drawn, count, wide, high, scale) {
  const boxes = Array.from({ length: count }, () => ({ left: wide, top: high, right: 0, bottom: 0 }));
  drawn.forEach((on, i) => {
    if (!on) return;
    const [x, y, box] = [i % wide, Math.floor(i / wide), boxes[owner[i]]];
    [box.left, box.right] = [Math.min(box.left, x), Math.max(box.right, x + 1)];
    [box.top, box.bottom] = [Math.min(box.top, y), Math.max(box.bottom, y + 1)];
  });
  return boxes.map(({ left, top, right, bottom }, number) => {
    const room = Math.round(ROOM * Math.max(right - left, bottom - top) + 2 / scale);
    return { isOwn: (/** @type {number} */ x, /** @type {number} */ y) => owner[y * wide + x] === number, box: { left: Math.max(left - room, 0), top: Math.max(top - room, 0), right: Math.min(right + room, wide), bottom: Math.min(bottom + room, high) } };
  }).filter(({ box }) => Math.min(box.right - box.left, box.bottom - box.top) * scale >= DRAWINGS.SMALLEST);
}

/** Returns cells in reading order. @param {Cell[]} cells */
function inRows(cells) {
  /** @type {Cell[][]} */
  const rows = [];
  for (const cell of cells.toSorted((one, other) => one.box.top - other.box.top)) {
    const last = rows.at(-1);
    if (last && (cell.box.top + cell.box.bottom) / 2 < Math.max(...last.map(({ box }) => box.bottom))) last.push(cell);
    else rows.push([cell]);
  }
  return rows.flatMap((row) => row.toSorted((one, other) => one.box.left - other.box.left));
}

/** Returns the lines around a figure's part of the page, a point for each pixel; holes in it have none. @param {Cell} cell @returns {Outline} */
function outlinesOf({ box: { left, top, right, bottom }, isOwn: isOwnInside }) {
  /** @param {number} x @param {number} y */
  const isOwn = (x, y) => x >= left && x < right && y >= top && y < bottom && isOwnInside(x, y);
  // Each edge has the figure on its right; `ways` are right, down, left and up.
  const ways = [[1, 0], [0, 1], [-1, 0], [0, -1]];
  /** @param {number} x @param {number} y @param {number} way of an edge that begins at a corner */
  const isEdge = (x, y, way) => {
    const beside = [[[0, 0], [0, -1]], [[-1, 0], [0, 0]], [[-1, -1], [-1, 0]], [[0, -1], [-1, -1]]][way];
    return isOwn(x + beside[0][0], y + beside[0][1]) && !isOwn(x + beside[1][0], y + beside[1][1]);
  };
  const seen = new Set();
  const outlines = [];
  for (let y = top; y < bottom; y++) {
    for (let x = left; x < right; x++) {
      if (!isEdge(x, y, 0) || seen.has(`${x} ${y}`)) continue;
      const line = [];
      let [column, row, way, area] = [x, y, 0, 0];
      do {
        if (way === 0) seen.add(`${column} ${row}`);
        line.push(column, row);
        area += column * ways[way][1] - row * ways[way][0];
        [column, row] = [column + ways[way][0], row + ways[way][1]];
        // Left turns first, so that parts that touch at a corner are one.
        way = [3, 0, 1].map((turn) => (way + turn) % 4).find((each) => isEdge(column, row, each)) ?? way;
      } while (column !== x || row !== y || way !== 0);
      if (area > 0) outlines.push(line);
    }
  }
  return outlines;
}
