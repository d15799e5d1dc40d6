/** Hold: makes a predicted map follow the user's form, areas and pins, like normalgan.inference.edits in Python. */

import { feathered, giveForm } from "./bevel.js";
import { EDITS, REGIONS } from "./constants.js";
import { slopesAt } from "./drawing/structures.js";
import { blurred, boxOf, components, part, where } from "./raster.js";
import { unrolled } from "./unrolling.js";

const { AVERAGED, BRUSH_FADES, FADES, LEAST_REACH, REACH, SOFT } = EDITS;
const { INKED } = REGIONS;

/** @typedef {import("./drawing/document.js").Hint} Hint @typedef {import("./drawing/carving.js").Asked} Area */
/** @typedef {{normals: Float32Array, mask: Uint8Array, width: number, height: number}} Painted */

/** @typedef {{points: number[], size: number, adds: boolean, fills?: boolean}} MaskStroke fills: a click that marks the whole area around it */

/**
 * Applies the form, then the areas in their order, then the pins exactly, in place.
 * @param {Painted} map @param {Hint[]} hints @param {Area[]} areas @param {import("./drawing/document.js").Form | null} form
 * @param {number} scale pixels of the map per pixel of the drawing
 * @param {Map<string, import("./drawing/structures.js").Tile>} tiles of structures, by picture or kind
 */
export function hold(map, hints, areas, form, scale, tiles) {
  if (form) giveForm(map, Float32Array.from(map.mask), form);
  /** @type {ReturnType<typeof unrolled> | null} */
  let surface = null;
  for (let i = 0; i < areas.length; i++) {
    const { structure } = areas[i];
    if (!structure) {
      turnArea(map, areas[i], scale);
      continue;
    }
    // Consecutive strokes of one structure count as one, so that it is no steeper where they cross.
    const cover = strokeOf(map, areas[i], scale);
    while (i + 1 < areas.length && isSame(areas[i + 1].structure, structure)) {
      i += 1;
      strokeOf(map, areas[i], scale).forEach((value, at) => { cover[at] = Math.max(cover[at], value); });
    }
    const tile = tiles.get(structure.picture ?? structure.kind);
    if (!tile) throw new Error("a structure is missing");
    surface ??= unrolled(map); // only once: no structure lies on another's bumps
    impress(map, cover, slopesAt(tile, structure, scale), surface);
  }
  holdPins(map, hints, scale);
}

/** @typedef {import("./drawing/document.js").Structure} Structure */
/** @param {Structure | undefined} one @param {Structure} other */
const isSame = (one, other) => one !== undefined && ["kind", "picture", "period"].every((key) => one[/** @type {"kind"} */ (key)] === other[/** @type {"kind"} */ (key)]) &&
  /** @type {const} */ (["turn", "x", "y", "flipped"]).every((key) => Number(one[key] ?? 0) === Number(other[key] ?? 0));

/** Returns how much of each pixel a stroke covers, times its strength. @param {Painted} map @param {Area} area @param {number} scale */
const strokeOf = ({ width, height }, { points, size = 1, strength = 1, soft = BRUSH_FADES }, scale) =>
  brushed(points.map((value) => value * scale), width, height, size * scale, soft).map((value) => value * strength);

/**
 * Adds a structure to the object's surface, with a steepness in proportion to its coverage.
 * @param {Painted} map @param {Float32Array} cover @param {(x: number, y: number, out: number[]) => void} slopes
 * @param {(x: number, y: number, out: number[]) => void} surface how far its points move when it is unrolled
 */
function impress({ normals, mask, width }, cover, slopes, surface) {
  const [slope, moved] = [[0, 0], [0, 0]];
  for (let i = 0; i < cover.length; i++) {
    if (cover[i] <= 1e-3 || !mask[i]) continue;
    const [x, y] = [(i % width) + 0.5, Math.floor(i / width) + 0.5];
    surface(x, y, moved);
    slopes(x + moved[0], y + moved[1], slope);
    normals.set(reoriented(normals.subarray(3 * i, 3 * i + 3), [-slope[0] * cover[i], slope[1] * cover[i], 1]), 3 * i);
  }
}

/**
 * Returns 1 where strokes added to a mask, -1 where they removed from it, 0 elsewhere; null without strokes.
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
    const cover = covered(points.map((value) => value * scale), width, height, 0, Math.max(size * scale, 1));
    for (let i = 0; i < out.length; i++) if (cover[i] > 0.5) out[i] = adds ? 1 : -1;
  }
  return out;
}

/** @param {Painted} map @param {Area} area @param {number} scale */
function turnArea(map, area, scale) {
  const { normal, size, form = null, smooths, soft = form ? 0 : FADES } = area;
  const { normals, mask, width, height } = map;
  const points = area.points.map((value) => value * scale);
  if (size && area.height !== undefined) {
    const { widths = Array.from({ length: points.length / 2 }, () => size) } = area;
    carve(map, points, widths.map((value) => value * scale), area.height);
    return;
  }
  /** @type {Float32Array} */
  let cover = size ? strokeOf(map, area, scale) : covered(points, width, height, SOFT * Math.max(width, height));
  if (size && smooths) {
    smooth(map, cover, size * scale);
    return;
  }
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

/** Averages the normals of the object under a brush. @param {Painted} map @param {Float32Array} cover @param {number} size of the brush */
function smooth({ normals, mask, width, height }, cover, size) {
  const around = boxOf(cover, width, height, 1e-3);
  if (!around) return;
  const sigma = AVERAGED * size;
  const reach = Math.ceil(4 * sigma) + 1; // the reach of the Gaussian
  const [left, top, right, bottom] = around;
  /** @type {[number, number, number, number]} */
  const box = [Math.max(left - reach, 0), Math.max(top - reach, 0), Math.min(right + reach, width), Math.min(bottom + reach, height)];
  const [wide, high] = [box[2] - box[0], box[3] - box[1]];
  const own = part(normals, width, height, box, 3);
  const object = part(mask, width, height, box);
  const means = [0, 1, 2].map((c) => blurred(object.map((value, i) => value && own[3 * i + c]), wide, high, sigma));
  for (let i = 0; i < object.length; i++) {
    const at = (box[1] + Math.floor(i / wide)) * width + box[0] + (i % wide);
    if (!object[i] || cover[at] <= 1e-3) continue;
    const mean = means.map((plane) => plane[i]);
    const length = Math.hypot(...mean);
    const mixed = mean.map((value, c) => own[3 * i + c] + cover[at] * (value / length - own[3 * i + c]));
    normals.set(facing(mixed), 3 * at);
  }
}

/**
 * Turns a line into a round ridge or groove of the line's width.
 * @param {Painted} map @param {number[]} points @param {number[]} widths at each point
 * @param {number} steep height of the ridge as a share of half the width; below 0, depth of a groove
 */
function carve({ normals, mask, width, height }, points, widths, steep) {
  const radii = widths.map((each) => Math.max(each / 2, 1));
  const reach = Math.max(...radii);
  const [xs, ys] = [0, 1].map((side) => points.filter((_, i) => i % 2 === side));
  const [left, top] = [Math.max(0, Math.floor(Math.min(...xs) - reach - 1)), Math.max(0, Math.floor(Math.min(...ys) - reach - 1))];
  const [right, bottom] = [Math.min(width, Math.ceil(Math.max(...xs) + reach + 1)), Math.min(height, Math.ceil(Math.max(...ys) + reach + 1))];
  const [wide, high] = [right - left, bottom - top];
  if (Math.min(wide, high) < 2) return; // off the map
  const raised = new Float32Array(wide * high);
  alongLine(points.map((value, i) => value - (i % 2 ? top : left)), wide, high, reach, (at, k, along, found) => {
    const radius = radii[k] + along * ((radii[k + 1] ?? radii[k]) - radii[k]);
    raised[at] = Math.max(raised[at], radius * Math.max(0, 1 - (found / radius) ** 2) ** 2);
  });
  for (let y = 0; y < high; y++) {
    const [above, below] = [Math.max(y - 1, 0), Math.min(y + 1, high - 1)];
    for (let x = 0; x < wide; x++) {
      const at = (y + top) * width + x + left;
      const [before, after] = [Math.max(x - 1, 0), Math.min(x + 1, wide - 1)];
      const across = (raised[y * wide + after] - raised[y * wide + before]) / (after - before);
      const down = (raised[below * wide + x] - raised[above * wide + x]) / (below - above);
      if (mask[at] && (across || down)) normals.set(reoriented(normals.subarray(3 * at, 3 * at + 3), [-steep * across, steep * down, 1]), 3 * at);
    }
  }
}

/** Returns a detail applied to a surface normal (Barré-Brisebois, Hill 2012). @param {Float32Array} base @param {number[]} detail of any length */
function reoriented([x, y, z], detail) {
  const length = Math.hypot(...detail);
  const [right, up, front] = [-detail[0] / length, -detail[1] / length, detail[2] / length];
  const share = (x * right + y * up + (z + 1) * front) / Math.max(z + 1, 1e-4);
  return facing([x * share - right, y * share - up, (z + 1) * share - front]);
}

/**
 * Visits the pixels within reach of each segment of a line; its last point counts as a segment.
 * @param {number[]} points @param {number} width @param {number} height @param {number} reach
 * @param {(at: number, piece: number, along: number, away: number) => void} visit
 */
function alongLine(points, width, height, reach, visit) {
  for (let k = 0; k < points.length; k += 2) {
    const [fromX, fromY] = [points[k], points[k + 1]];
    const [toX, toY] = [points[k + 2] ?? fromX, points[k + 3] ?? fromY];
    const [wayX, wayY] = [toX - fromX, toY - fromY];
    const length = Math.max(wayX * wayX + wayY * wayY, 1e-12);
    const [right, bottom] = [Math.min(width, Math.ceil(Math.max(fromX, toX) + reach)), Math.min(height, Math.ceil(Math.max(fromY, toY) + reach))];
    for (let y = Math.max(0, Math.floor(Math.min(fromY, toY) - reach)); y < bottom; y++) {
      for (let x = Math.max(0, Math.floor(Math.min(fromX, toX) - reach)); x < right; x++) {
        const [beside, below] = [x + 0.5 - fromX, y + 0.5 - fromY];
        const along = Math.max(0, Math.min(1, (beside * wayX + below * wayY) / length));
        visit(y * width + x, k / 2, along, Math.hypot(beside - along * wayX, below - along * wayY));
      }
    }
  }
}

/**
 * Returns how much a brush stroke covers each pixel.
 * @param {number[]} points @param {number} width @param {number} height @param {number} size
 * @param {number} soft the share of its radius over which it fades out; at least a pixel
 */
function brushed(points, width, height, size, soft) {
  const radius = Math.max(size / 2, 1);
  const away = new Float32Array(width * height).fill(radius);
  alongLine(points, width, height, radius, (at, _, __, found) => {
    if (found < away[at]) away[at] = found;
  });
  const edge = Math.max(soft * radius, 1);
  return away.map((value) => {
    const share = Math.max(0, Math.min(1, (radius - value) / edge));
    return share * share * (3 - 2 * share);
  });
}

/**
 * Returns how much each pixel belongs to a polygon or a line.
 * @param {number[]} points @param {number} width @param {number} height @param {number} soft width of its edge
 * @param {number} [size] of the line
 */
function covered(points, width, height, soft, size) {
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(width, height).getContext("2d"));
  if (soft) context.filter = `blur(${soft / 2}px)`;
  context.beginPath();
  for (let i = 0; i < points.length; i += 2) context.lineTo(points[i], points[i + 1]);
  if (size) {
    if (points.length === 2) context.lineTo(points[0] + 0.01, points[1]);
    [context.lineWidth, context.lineCap, context.lineJoin] = [size, "round", "round"];
    context.stroke();
  } else context.fill();
  const { data } = context.getImageData(0, 0, width, height);
  return Float32Array.from({ length: width * height }, (_, i) => data[4 * i + 3] / 255);
}

/** Interpolates the rotations at pins with radial basis functions (Wendland 1995). @param {Painted} map @param {Hint[]} hints @param {number} scale */
function holdPins({ normals, width, height }, hints, scale) {
  /** @type {Map<number, {x: number, y: number, reach: number, normal: number[]}>} the last pin in a pixel counts */
  const places = new Map();
  for (const hint of hints) {
    const x = Math.min(width - 1, Math.max(0, Math.floor(hint.x * scale)));
    const y = Math.min(height - 1, Math.max(0, Math.floor(hint.y * scale)));
    const reach = Math.max(LEAST_REACH, hint.reach === undefined ? REACH * Math.max(width, height) : hint.reach * scale);
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

/** Returns the rotation between unit vectors: an axis with the angle as its length. @param {number[]} before @param {number[]} after */
function turnBetween(before, after) {
  let axis = cross(before, after);
  const sine = Math.hypot(...axis);
  const angle = Math.atan2(sine, before[0] * after[0] + before[1] * after[1] + before[2] * after[2]);
  // Opposite vectors define no axis: any perpendicular one will do.
  if (sine <= 1e-6) axis = cross(before, Math.abs(before[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]);
  const length = Math.max(Math.hypot(...axis), 1e-12);
  return axis.map((value) => (value / length) * angle);
}

/** Returns a vector rotated about an axis whose length is the angle, made to face the viewer. @param {number[]} vector @param {number[]} turn */
function turned(vector, turn) {
  const angle = Math.hypot(...turn);
  const axis = turn.map((value) => value / Math.max(angle, 1e-12));
  const along = axis[0] * vector[0] + axis[1] * vector[1] + axis[2] * vector[2];
  const beside = cross(axis, vector);
  const out = vector.map((value, c) => value * Math.cos(angle) + beside[c] * Math.sin(angle) + along * axis[c] * (1 - Math.cos(angle)));
  return facing(out);
}

/** Returns a unit vector turned so that it does not face away from the viewer. @param {number[]} vector */
function facing([x, y, z]) {
  const front = Math.max(z, 0);
  const length = Math.max(Math.hypot(x, y, front), 1e-8);
  return [x / length, y / length, front / length];
}
