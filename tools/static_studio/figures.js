/** Figures: finds the separate figures of a page, like normalgan.inference.composites.figures in Python, and the outline of each. */

import { DRAWINGS, FIGURES, REGIONS } from "./constants.js";
import { components, distance, resized, where } from "./raster.js";

/** @typedef {import("./result/findings.js").Finding} Finding */
/** @typedef {import("./drawing/lasso.js").Lasso} Outline */
/** @typedef {{left: number, top: number, right: number, bottom: number}} Box */
/** @typedef {{owner: Int32Array, boxes: Box[], width: number, height: number}} Cells owner: of each pixel, the number of its figure; boxes: of the figures */

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
  const cells = inRows(cellsOf(owner, body, count, wide, high, scale));
  const places = cells.map(({ box }) => /** @type {[number, number]} */ ([((box.left + box.right) / 2) * scale, ((box.top + box.bottom) / 2) * scale]));
  const outlines = cells.map(({ box, number }) => outlinesOf(owner, number, wide, box).map((line) => line.map((each) => each * scale)));
  return [{ code: "figures", places, count: cells.length, outlines }];
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

/** @param {Int32Array} owner @param {Uint8Array} drawn lines and bodies @param {number} count @param {number} wide @param {number} high @param {number} scale */
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
    return { number, box: { left: Math.max(left - room, 0), top: Math.max(top - room, 0), right: Math.min(right + room, wide), bottom: Math.min(bottom + room, high) } };
  }).filter(({ box }) => Math.min(box.right - box.left, box.bottom - box.top) * scale >= DRAWINGS.SMALLEST);
}

/** Returns cells in reading order. @template {{box: Box}} T @param {T[]} cells */
function inRows(cells) {
  /** @type {T[][]} */
  const rows = [];
  for (const cell of cells.toSorted((one, other) => one.box.top - other.box.top)) {
    const last = rows.at(-1);
    if (last && (cell.box.top + cell.box.bottom) / 2 < Math.max(...last.map(({ box }) => box.bottom))) last.push(cell);
    else rows.push([cell]);
  }
  return rows.flatMap((row) => row.toSorted((one, other) => one.box.left - other.box.left));
}

/**
 * Returns the lines around a figure's part of the page, a point for each pixel; holes in it have none.
 * @param {Int32Array} owner @param {number} number of the figure @param {number} wide @param {Box} box
 * @returns {Outline}
 */
function outlinesOf(owner, number, wide, { left, top, right, bottom }) {
  /** @param {number} x @param {number} y */
  const isOwn = (x, y) => x >= left && x < right && y >= top && y < bottom && owner[y * wide + x] === number;
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
      if (!isEdge(x, y, 0) || seen.has(y * (wide + 1) + x)) continue;
      const line = [];
      let [column, row, way, area] = [x, y, 0, 0];
      do {
        if (way === 0) seen.add(row * (wide + 1) + column);
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
