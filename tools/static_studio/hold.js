/** Hold: a painted map held to what a hand says of it, as normalgan.inference.edits does it in Python. */

import { feathered, giveForm } from "./bevel.js";
import { components, where } from "./raster.js";

/** @typedef {import("./document.js").Hint} Hint @typedef {import("./document.js").Area} Area */
/** @typedef {{normals: Float32Array, mask: Uint8Array, width: number, height: number}} Painted */

/** @typedef {{points: number[], size: number, adds: boolean, fills?: boolean}} MaskStroke fills: a click, for all of the area about it */

/** How dark a line is at least that parts one area from another. */
const INKED = 0.35;
const REACH = 0.05;
const SOFT = 0.01;
/** The share of its depth in which a region fades out that has no form and says nothing else. */
const FADES = 0.5;

/**
 * Holds a map to its form, to areas, in their order, then to pins, exactly; in place.
 * @param {Painted} map @param {Hint[]} hints @param {Area[]} areas @param {import("./document.js").Form | null} form
 * @param {number} scale pixels of the map for one of the drawing
 */
export function hold(map, hints, areas, form, scale) {
  if (form) giveForm(map, Float32Array.from(map.mask), form);
  for (const area of areas) turnArea(map, area, scale);
  holdPins(map, hints, scale);
}

/**
 * Returns 1 where strokes have added to a mask, -1 where they have cut, 0 elsewhere; null if there are none.
 * @param {MaskStroke[]} strokes @param {number} width @param {number} height @param {number} scale
 * @param {Float32Array} ink the lines, which part one area from another
 */
export function byHand(strokes, width, height, scale, ink) {
  if (!strokes.length) return null;
  const out = new Int8Array(width * height);
  /** @type {Int32Array | null} */
  let areas = null;
  for (const { points, size, adds, fills } of strokes) {
    if (fills) {
      areas ??= components(where(ink, (value) => value <= INKED), width, height, 4).labels;
      const [column, row] = [Math.floor(points[0] * scale), Math.floor(points[1] * scale)];
      const area = areas[Math.max(0, Math.min(height - 1, row)) * width + Math.max(0, Math.min(width - 1, column))];
      if (area) for (let i = 0; i < out.length; i++) if (areas[i] === area) out[i] = adds ? 1 : -1;
      continue;
    }
    const cover = covered(points.map((value) => value * scale), (size * scale) / 0.7, width, height, 0);
    for (let i = 0; i < out.length; i++) if (cover[i] > 0.5) out[i] = adds ? 1 : -1;
  }
  return out;
}

/** @param {Painted} map @param {Area} area @param {number} scale */
function turnArea(map, { points, normal, size, form = null, soft = form ? 0 : FADES }, scale) {
  const { normals, mask, width, height } = map;
  /** @type {Float32Array} */
  let cover = covered(points.map((value) => value * scale), size && size * scale, width, height);
  if (!size && soft) cover = feathered(cover, width, height, soft);
  if (!size && form) giveForm(map, cover, form);
  const mean = [0, 0, 0];
  cover.forEach((value, i) => {
    if (value > 0.5 && mask[i]) for (let c = 0; c < 3; c++) mean[c] += normals[3 * i + c];
  });
  const length = Math.hypot(...mean);
  if (!size && !length) return;
  const whole = turnBetween(mean.map((value) => value / (length || 1)), normal);
  for (let i = 0; i < cover.length; i++) {
    if (cover[i] <= 1e-3) continue;
    const own = [...normals.subarray(3 * i, 3 * i + 3)];
    const turn = size ? turnBetween(own, normal) : whole;
    normals.set(turned(own, turn.map((value) => value * cover[i])), 3 * i);
  }
}

/**
 * Returns how much each pixel belongs to a polygon, or to a brush's stroke.
 * @param {number[]} points @param {number | undefined} size @param {number} width @param {number} height
 * @param {number} [soft] width of its edge
 */
function covered(points, size, width, height, soft = size ? 0.3 * size : SOFT * Math.max(width, height)) {
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(width, height).getContext("2d"));
  if (soft) context.filter = `blur(${soft / 2}px)`;
  context.beginPath();
  for (let i = 0; i < points.length; i += 2) context.lineTo(points[i], points[i + 1]);
  if (size) {
    if (points.length === 2) context.lineTo(points[0] + 0.01, points[1]);
    [context.lineWidth, context.lineCap, context.lineJoin] = [Math.max(0.7 * size, 1), "round", "round"];
    context.stroke();
  } else context.fill();
  const { data } = context.getImageData(0, 0, width, height);
  return Float32Array.from({ length: width * height }, (_, i) => data[4 * i + 3] / 255);
}

/** Interpolates the turns at pins by radial basis functions (Wendland 1995). @param {Painted} map @param {Hint[]} hints @param {number} scale */
function holdPins({ normals, width, height }, hints, scale) {
  /** @type {Map<number, {x: number, y: number, reach: number, normal: number[]}>} of pins in one pixel the last counts */
  const places = new Map();
  for (const hint of hints) {
    const x = Math.min(width - 1, Math.max(0, Math.floor(hint.x * scale)));
    const y = Math.min(height - 1, Math.max(0, Math.floor(hint.y * scale)));
    const reach = Math.max(2, hint.reach === undefined ? REACH * Math.max(width, height) : hint.reach * scale);
    places.set(y * width + x, { x, y, reach, normal: hint.normal });
  }
  const pins = [...places.values()];
  if (!pins.length) return;
  const turns = pins.map(({ x, y, normal }) => turnBetween([...normals.subarray(3 * (y * width + x), 3 * (y * width + x) + 3)], normal));
  const basis = pins.map((own) => pins.map((pin) => wendland(Math.hypot(own.x - pin.x, own.y - pin.y) / pin.reach)));
  const shares = solved(basis, turns);
  const field = new Float32Array(normals.length);
  pins.forEach(({ x, y, reach }, k) => {
    for (let row = Math.max(0, y - Math.floor(reach)); row <= Math.min(height - 1, y + reach); row++) {
      for (let column = Math.max(0, x - Math.floor(reach)); column <= Math.min(width - 1, x + reach); column++) {
        const share = wendland(Math.hypot(column - x, row - y) / reach);
        for (let c = 0; c < 3; c++) field[3 * (row * width + column) + c] += share * shares[k][c];
      }
    }
  });
  for (let i = 0; i < field.length; i += 3) {
    const turn = [field[i], field[i + 1], field[i + 2]];
    if (Math.hypot(...turn) > 1e-6) normals.set(turned([normals[i], normals[i + 1], normals[i + 2]], turn), i);
  }
}

/** @param {number} distance */
const wendland = (distance) => (distance < 1 ? (1 - distance) ** 4 * (4 * distance + 1) : 0);

/** Solves linear equations by elimination. @param {number[][]} matrix @param {number[][]} wanted */
function solved(matrix, wanted) {
  const rows = matrix.map((row, i) => [...row, ...wanted[i]]);
  const count = rows.length;
  for (let k = 0; k < count; k++) {
    let best = k;
    for (let i = k + 1; i < count; i++) if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    [rows[k], rows[best]] = [rows[best], rows[k]];
    if (Math.abs(rows[k][k]) < 1e-12) continue;
    for (let i = 0; i < count; i++) {
      const share = i === k ? 0 : rows[i][k] / rows[k][k];
      if (share) for (let j = k; j < rows[i].length; j++) rows[i][j] -= share * rows[k][j];
    }
  }
  return rows.map((row, k) => row.slice(count).map((value) => (Math.abs(row[k]) < 1e-12 ? 0 : value / row[k])));
}

/** @param {number[]} a @param {number[]} b */
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Returns the turn between unit vectors: an axis, as long as the angle. @param {number[]} before @param {number[]} after */
function turnBetween(before, after) {
  let axis = cross(before, after);
  const sine = Math.hypot(...axis);
  const angle = Math.atan2(sine, before[0] * after[0] + before[1] * after[1] + before[2] * after[2]);
  // Opposite vectors have no axis: any that is square to them does.
  if (sine <= 1e-6) axis = cross(before, Math.abs(before[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]);
  const length = Math.max(Math.hypot(...axis), 1e-12);
  return axis.map((value) => (value / length) * angle);
}

/** Returns a vector turned by an axis as long as the angle, facing the viewer. @param {number[]} vector @param {number[]} turn */
function turned(vector, turn) {
  const angle = Math.hypot(...turn);
  const axis = turn.map((value) => value / Math.max(angle, 1e-12));
  const along = axis[0] * vector[0] + axis[1] * vector[1] + axis[2] * vector[2];
  const beside = cross(axis, vector);
  const out = vector.map((value, c) => value * Math.cos(angle) + beside[c] * Math.sin(angle) + along * axis[c] * (1 - Math.cos(angle)));
  out[2] = Math.max(out[2], 0);
  const length = Math.max(Math.hypot(...out), 1e-8);
  return out.map((value) => value / length);
}
