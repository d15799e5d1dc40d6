/** Raster: operations on pictures as arrays, row by row, as in OpenCV: sizes, distances, connected components. */

/** @typedef {Uint8Array | Float32Array | Uint8ClampedArray} Plane */
/** @typedef {[number, number, number, number]} Box left, top, right, bottom */
/** @typedef {"lines" | "curves" | "points"} Way how a picture is enlarged: between two pixels, or four; "points" also samples between two pixels when it reduces, the others average */

const FAR = 1e6;
/** Lengths of a straight, a diagonal and a knight's step (Borgefors 1986), rounded to 1/65536 as in OpenCV. */
const [SIDE, CORNER, KNIGHT] = [1, 1.4, 2.1969].map((length) => Math.round(length * 65536) / 65536);
/** Lengths for 3 × 3, which has no knight's step. */
const [SIDE3, CORNER3] = [0.955, 1.3693].map((length) => Math.round(length * 65536) / 65536);

/** Rounds halves to even, as NumPy does. @param {number} value */
export function rint(value) {
  const rounded = Math.round(value);
  return Math.abs(value % 1) === 0.5 && rounded % 2 ? rounded - 1 : rounded;
}

/**
 * Returns the distance of each pixel to the nearest 0, by the 5 × 5 or 3 × 3 chamfer.
 * @param {Plane} marked @param {number} width @param {number} height
 * @param {boolean} [bounded] whether pixels beyond the picture are 0 @param {5 | 3} [mask]
 */
export function distance(marked, width, height, bounded = false, mask = 5) {
  const stride = width + 4;
  const away = new Float32Array(stride * (height + 4)).fill(bounded ? 0 : FAR);
  const [side, corner] = mask === 5 ? [SIDE, CORNER] : [SIDE3, CORNER3];
  const knight = mask === 5 ? KNIGHT : FAR;
  const [above, twice] = [stride, 2 * stride];
  // One loop for each direction without a function per step, since most of a drawing's time is spent here.
  for (let y = 0; y < height; y++) {
    for (let x = 0, at = (y + 2) * stride + 2, from = y * width; x < width; x++, at++, from++) {
      if (!marked[from]) { away[at] = 0; continue; }
      const beside = Math.min(away[at - 1], away[at - above]) + side;
      const across = Math.min(away[at - above - 1], away[at - above + 1]) + corner;
      const jump = Math.min(Math.min(away[at - above - 2], away[at - above + 2]), Math.min(away[at - twice - 1], away[at - twice + 1])) + knight;
      away[at] = Math.min(Math.min(beside, across), jump);
    }
  }
  const out = new Float32Array(width * height);
  for (let y = height - 1; y >= 0; y--) {
    for (let x = width - 1, at = (y + 2) * stride + 2 + x, to = y * width + x; x >= 0; x--, at--, to--) {
      const found = away[at];
      if (found > side) {
        const beside = Math.min(away[at + 1], away[at + above]) + side;
        const across = Math.min(away[at + above + 1], away[at + above - 1]) + corner;
        const jump = Math.min(Math.min(away[at + above + 2], away[at + above - 2]), Math.min(away[at + twice + 1], away[at + twice - 1])) + knight;
        away[at] = Math.min(found, Math.min(Math.min(beside, across), jump));
      }
      out[to] = away[at];
    }
  }
  return out;
}

/** Returns 1 where a condition holds, and 0 elsewhere. @param {Plane | Int32Array} values @param {(value: number, at: number) => boolean} holds */
export function where(values, holds) {
  const out = new Uint8Array(values.length);
  for (let i = 0; i < out.length; i++) out[i] = holds(values[i], i) ? 1 : 0;
  return out;
}

// Plain loops: a function call per pixel would take ten times as long.

/** Returns 1 where values are above a limit, and 0 elsewhere. @param {Plane} values @param {number} limit */
export function above(values, limit) {
  const out = new Uint8Array(values.length);
  for (let i = 0; i < out.length; i++) if (values[i] > limit) out[i] = 1;
  return out;
}

/** Returns where either mask is marked. @param {Uint8Array} one @param {Uint8Array} other */
export function either(one, other) {
  const out = new Uint8Array(one.length);
  for (let i = 0; i < out.length; i++) out[i] = one[i] | other[i];
  return out;
}

/** Returns where both masks are marked. @param {Uint8Array} one @param {Uint8Array} other */
export function both(one, other) {
  const out = new Uint8Array(one.length);
  for (let i = 0; i < out.length; i++) out[i] = one[i] & other[i];
  return out;
}

/** Returns where the first mask is marked and the other is not. @param {Uint8Array} one @param {Uint8Array} other */
export function without(one, other) {
  const out = new Uint8Array(one.length);
  for (let i = 0; i < out.length; i++) out[i] = one[i] & (other[i] ^ 1);
  return out;
}

/** Returns the pixels in parts that are kept. @param {Int32Array} labels @param {ArrayLike<boolean | number>} kept by its label */
export function labelled(labels, kept) {
  const table = Uint8Array.from(kept, Number);
  const out = new Uint8Array(labels.length);
  for (let i = 0; i < out.length; i++) out[i] = table[labels[i]];
  return out;
}

/** Returns the number of marked pixels. @param {Uint8Array} marked */
export function sumOf(marked) {
  let sum = 0;
  for (let i = 0; i < marked.length; i++) sum += marked[i];
  return sum;
}

/** Returns values a x + b, held to 0 to 1. @param {Float32Array} values @param {number} factor @param {number} more */
export function stretched(values, factor, more) {
  const out = new Float32Array(values.length);
  for (let i = 0; i < out.length; i++) {
    const value = factor * values[i] + more;
    out[i] = value < 0 ? 0 : value > 1 ? 1 : value;
  }
  return out;
}

export const CROSS = [0, 1, 0];
export const SQUARE = [1, 1, 1];
export const WIDE = [2, 2, 2, 2, 2];

/**
 * Returns the mask dilated by a window, which is given by the half widths of its rows.
 * @param {Uint8Array} marked @param {number} width @param {number} height @param {number[]} halves
 */
export function dilated(marked, width, height, halves) {
  const out = marked.slice();
  const rows = halves.length >> 1;
  for (let y = 0, i = 0; y < height; y++) {
    const [first, last] = [Math.max(y - rows, 0), Math.min(y + rows, height - 1)];
    for (let x = 0; x < width; x++, i++) {
      if (!marked[i]) continue;
      // Whatever a pixel with four marked neighbours reaches, one of these reaches too.
      if (x > 0 && x < width - 1 && y > 0 && y < height - 1 && marked[i - 1] && marked[i + 1] && marked[i - width] && marked[i + width]) continue;
      for (let row = first; row <= last; row++) {
        const half = halves[row - y + rows];
        const end = row * width + Math.min(x + half, width - 1);
        for (let at = row * width + Math.max(x - half, 0); at <= end; at++) out[at] = 1;
      }
    }
  }
  return out;
}

/**
 * Returns the mask dilated by a reach, measured as in `distance`.
 * @param {Uint8Array} marked @param {number} width @param {number} height @param {number} reach @param {5 | 3} [mask]
 */
export function near(marked, width, height, reach, mask = 5) {
  const rows = Math.floor(reach / 0.95); // a straight step of 3 × 3 is shorter than a pixel
  const side = 2 * rows + 1;
  const away = distance(new Uint8Array(side * side).fill(1).fill(0, rows * side + rows, rows * side + rows + 1), side, side, false, mask);
  const halves = Array.from({ length: side }, (_, y) => {
    const row = away.subarray(y * side + rows, (y + 1) * side);
    return row.findLastIndex((value) => value <= reach);
  });
  const first = halves.findIndex((half) => half >= 0);
  return dilated(marked, width, height, halves.slice(first, side - first));
}

/** Returns the mask eroded by a window. @param {Uint8Array} marked @param {number} width @param {number} height @param {number[]} halves as for `dilated` */
export const eroded = (marked, width, height, halves) => opposite(dilated(opposite(marked), width, height, halves));

/** Returns 1 where nothing is marked. @param {Plane} marked */
export function opposite(marked) {
  const out = new Uint8Array(marked.length);
  for (let i = 0; i < out.length; i++) out[i] = marked[i] ? 0 : 1;
  return out;
}

/**
 * Returns the connected components, numbered from 1, and their number including the background, 0.
 * @param {Uint8Array} marked @param {number} width @param {number} height @param {4 | 8} ways
 */
export function components(marked, width, height, ways) {
  /** @type {number[][]} */
  const [starts, ends, owners] = [[], [], []];
  /** @param {number} run */
  const root = (run) => {
    while (owners[run] !== run) run = owners[run] = owners[owners[run]];
    return run;
  };
  const corner = ways === 8 ? 1 : 0;
  let before = 0; // the first run of the row above
  for (let y = 0, first = 0; y < height; y++, before = first, first = starts.length) {
    let above = before;
    for (let i = y * width, last = i + width; i < last; i++) {
      if (!marked[i]) continue;
      const start = i;
      while (i < last && marked[i]) i++;
      const run = starts.push(start) - 1;
      ends.push(i);
      owners.push(run);
      while (above < first && ends[above] + width + corner <= start) above++;
      for (let other = above; other < first && starts[other] + width < i + corner; other++) {
        const [one, two] = [root(other), root(run)];
        if (one !== two) owners[Math.max(one, two)] = Math.min(one, two);
      }
    }
  }
  const labels = new Int32Array(marked.length);
  const boxes = [{ area: 0, left: 0, top: 0, right: 0, bottom: 0 }];
  const names = new Int32Array(starts.length);
  for (let run = 0; run < starts.length; run++) {
    const own = root(run);
    if (own === run) names[run] = boxes.push({ area: 0, left: width, top: height, right: 0, bottom: 0 }) - 1;
    names[run] = names[own];
    const [y, box] = [Math.floor(starts[run] / width), boxes[names[run]]];
    labels.fill(names[run], starts[run], ends[run]);
    box.area += ends[run] - starts[run];
    box.left = Math.min(box.left, starts[run] - y * width);
    box.right = Math.max(box.right, ends[run] - y * width);
    box.top = Math.min(box.top, y);
    box.bottom = Math.max(box.bottom, y + 1);
  }
  return { labels, boxes };
}

/** Returns a barrier and all pixels that it cuts off from the picture's edge. @param {Uint8Array} barrier @param {number} width @param {number} height */
export function enclosedBy(barrier, width, height) {
  const { labels, boxes } = components(opposite(barrier), width, height, 4);
  const outside = boxes.map((box, label) => label > 0 && (!box.left || !box.top || box.right === width || box.bottom === height));
  const inside = new Uint8Array(barrier.length);
  for (let i = 0; i < inside.length; i++) inside[i] = outside[labels[i]] ? 0 : 1;
  return inside;
}

/**
 * Returns the maximum (way 1) or minimum (way -1) in a square around each pixel.
 * @param {Plane} values @param {number} width @param {number} height @param {number} radius @param {1 | -1} way
 */
export function extreme(values, width, height, radius, way) {
  const size = 2 * radius + 1;
  const [wide, high] = [width + 2 * radius, height + 2 * radius];
  const from = new Float32Array(wide * high).fill(-way * FAR);
  for (let y = 0; y < height; y++) from.set(values.subarray(y * width, (y + 1) * width), (y + radius) * wide + radius);
  for (const step of [1, wide]) {
    // Two windows make one of twice the size, until the size is reached.
    for (let done = 1; done < size;) {
      const more = Math.min(done, size - done);
      const ahead = more * step;
      const last = from.length - ahead;
      if (way > 0) for (let i = 0; i < last; i++) { if (from[i] < from[i + ahead]) from[i] = from[i + ahead]; }
      else for (let i = 0; i < last; i++) { if (from[i] > from[i + ahead]) from[i] = from[i + ahead]; }
      done += more;
    }
  }
  const out = new Float32Array(width * height);
  for (let y = 0; y < height; y++) out.set(from.subarray(y * wide, y * wide + width), y * width);
  return out;
}

/** Returns where marked pixels are at least as deep as all their neighbours. @param {Float32Array} depth @param {Uint8Array} marked @param {number} width @param {number} height */
export function ridge(depth, marked, width, height) {
  const out = new Uint8Array(marked.length);
  for (let y = 0, i = 0; y < height; y++) {
    const [first, last] = [Math.max(y - 1, 0), Math.min(y + 1, height - 1)];
    for (let x = 0; x < width; x++, i++) {
      if (!marked[i]) continue;
      const [left, right] = [Math.max(x - 1, 0), Math.min(x + 1, width - 1)];
      let highest = 0;
      for (let row = first; row <= last; row++) {
        for (let at = row * width + left, end = row * width + right; at <= end; at++) if (depth[at] > highest) highest = depth[at];
      }
      if (depth[i] >= highest - 1e-4) out[i] = 1;
    }
  }
  return out;
}

/** Returns a picture blurred by a Gaussian. @param {Plane} values @param {number} width @param {number} height @param {number} sigma */
export function blurred(values, width, height, sigma) {
  const radius = rint(8 * sigma + 1) >> 1;
  const kernel = Array.from({ length: 2 * radius + 1 }, (_, i) => Math.exp(-((i - radius) ** 2) / (2 * sigma * sigma)));
  const total = kernel.reduce((sum, value) => sum + value, 0);
  return filtered(values, width, height, kernel.map((value) => value / total));
}

/**
 * Returns a picture convolved along rows and columns, mirrored beyond its edge.
 * @param {Plane} values @param {number} width @param {number} height @param {number[]} kernel an odd number of weights
 */
export function filtered(values, width, height, kernel) {
  const radius = kernel.length >> 1;
  const weights = Float64Array.from(kernel);
  /** @param {number} place @param {number} length */
  const mirrored = (place, length) => (Math.abs(place) < length ? Math.abs(place) : Math.max(0, 2 * length - 2 - Math.abs(place)));
  const rows = new Float32Array(values.length);
  const line = new Float32Array(width + 2 * radius);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) line[x + radius] = values[y * width + x];
    for (let k = 1; k <= radius; k++) {
      line[radius - k] = values[y * width + mirrored(-k, width)];
      line[radius + width - 1 + k] = values[y * width + mirrored(width - 1 + k, width)];
    }
    for (let x = 0, at = y * width; x < width; x++, at++) {
      let sum = 0;
      for (let j = 0; j < weights.length; j++) sum += weights[j] * line[x + j];
      rows[at] = sum;
    }
  }
  // This pass also runs along the rows, since the pixels of a column are far apart in memory.
  const out = new Float32Array(values.length);
  const sums = new Float64Array(width);
  for (let y = 0; y < height; y++) {
    sums.fill(0);
    for (let j = 0; j < weights.length; j++) {
      const weight = weights[j];
      for (let x = 0, at = mirrored(y + j - radius, height) * width; x < width; x++, at++) sums[x] += weight * rows[at];
    }
    out.set(sums, y * width);
  }
  return out;
}

/**
 * Returns for each of `to` places along a line its sources among `from` places: the first one and the weights.
 * @param {number} from @param {number} to @param {Way} way @returns {[number, number[]][]}
 */
function mixture(from, to, way) {
  const scale = from / to;
  if (way === "curves" && scale < 1) return curve(from, to);
  return Array.from({ length: to }, (_, i) => {
    if (scale > 1 && way !== "points") { // mean over an area
      const [start, end] = [i * scale, Math.min((i + 1) * scale, from)];
      const first = Math.floor(start + 1e-6);
      const count = Math.min(Math.ceil(end - 1e-6), from) - first;
      const weights = Array.from({ length: count }, (_, k) =>
        (Math.min(end, first + k + 1) - Math.max(start, first + k)) / (end - start));
      return [first, weights];
    }
    const at = Math.min(Math.max((i + 0.5) * scale - 0.5, 0), from - 1);
    const first = Math.min(Math.floor(at), Math.max(from - 2, 0));
    return from < 2 ? [0, [1]] : [first, [1 - (at - first), at - first]];
  });
}

/**
 * Returns the equivalent of `mixture` for four sources (Keys 1981), with OpenCV's slope.
 * @param {number} from @param {number} to @returns {[number, number[]][]}
 */
function curve(from, to) {
  const count = Math.min(4, from);
  return Array.from({ length: to }, (_, i) => {
    const at = ((i + 0.5) * from) / to - 0.5;
    const before = Math.floor(at) - 1;
    const first = Math.min(Math.max(before, 0), from - count);
    const weights = Array.from({ length: count }, () => 0);
    for (let k = 0; k < 4; k++) {
      const away = Math.abs(at - before - k);
      const weight = away < 1 ? (1.25 * away - 2.25) * away * away + 1 : ((-0.75 * away + 3.75) * away - 6) * away + 3;
      weights[Math.min(Math.max(before + k, 0), from - 1) - first] += weight; // the edge is repeated
    }
    return [first, weights];
  });
}

/**
 * Returns a picture resized by averages over areas, or by interpolation.
 * @param {Plane} values @param {number} width @param {number} height
 * @param {number} wide @param {number} high @param {number} [channels] @param {Way} [way]
 */
export function resized(values, width, height, wide, high, channels = 1, way = "lines") {
  const across = mixture(width, wide, way);
  const down = mixture(height, high, way);
  const rows = new Float32Array(wide * height * channels);
  // Flat arrays: a list per pixel would take several times as long.
  const [starts, ends] = [new Int32Array(wide), new Int32Array(wide)];
  const shares = new Float64Array(across.reduce((sum, [, weights]) => sum + weights.length, 0));
  for (let x = 0, used = 0; x < wide; x++) {
    starts[x] = across[x][0];
    shares.set(across[x][1], used);
    ends[x] = used += across[x][1].length;
  }
  const plane = values instanceof Float32Array ? values : new Float32Array(values); // loops over a single kind of array are faster
  for (let y = 0, to = 0; y < height; y++) {
    for (let x = 0; x < wide; x++) {
      const begin = x ? ends[x - 1] : 0;
      for (let c = 0; c < channels; c++, to++) {
        let sum = 0;
        for (let k = begin, from = (y * width + starts[x]) * channels + c; k < ends[x]; k++, from += channels) sum += shares[k] * plane[from];
        rows[to] = sum;
      }
    }
  }
  const out = new Float32Array(wide * high * channels);
  const line = wide * channels;
  for (let y = 0; y < high; y++) {
    const [first, weights] = down[y];
    for (let k = 0; k < weights.length; k++) {
      const from = (first + k) * line;
      for (let x = 0; x < line; x++) out[y * line + x] += weights[k] * rows[from + x];
    }
  }
  return out;
}

/** Returns a picture resized like in normalgan.inference: by means over areas, or by curves through four pixels. @param {Plane} values @param {number} width @param {number} height @param {number} wide @param {number} high */
export const refitted = (values, width, height, wide, high) => resized(values, width, height, wide, high, 1, "curves");

/** Returns the quantile of values, the median without a share; NaN if there are none. @param {number[] | Float32Array} values @param {number} [share] */
export function quantile(values, share = 0.5) {
  const count = values.length;
  if (!count) return NaN;
  const rank = Math.min(count - 1, Math.max(0, Math.ceil(share * count) - 1));
  if (count < 4096) return new Float32Array(values).sort()[rank];
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < count; i++) {
    if (values[i] < low) low = values[i];
    if (values[i] > high) high = values[i];
  }
  // To 1/4096 of the range, as in Python: sorting would take longer than everything else.
  const step = Math.max(high - low, 1e-12) / 4096;
  const counts = new Uint32Array(4097);
  for (let i = 0; i < count; i++) counts[Math.round((values[i] - low) / step)]++;
  let sum = 0;
  for (let bin = 0; bin < counts.length; bin++) {
    sum += counts[bin];
    if (sum > rank) return low + bin * step;
  }
  return high;
}

/** Returns the median of values. @param {number[] | Float32Array} values one at least */
export function median(values) {
  const sorted = new Float32Array(values).sort();
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : Math.fround((sorted[middle - 1] + sorted[middle]) / 2);
}

/** Returns the bounding box of the marked pixels, or null if there are none. @param {Plane} values @param {number} width @param {number} height @param {number} [above] @returns {Box | null} */
export function boxOf(values, width, height, above = 0) {
  let [left, top, right, bottom] = [width, height, 0, 0];
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      if (!(values[y * width + x] > above)) continue;
      if (x < left) left = x;
      if (x >= right) right = x + 1;
      if (y < top) top = y;
      bottom = y + 1;
    }
  }
  return right ? [left, top, right, bottom] : null;
}

/** Returns a crop of a picture, with 0 beyond its edge. @param {Plane} values @param {number} width @param {number} height @param {Box} box @param {number} [channels] */
export function part(values, width, height, [left, top, right, bottom], channels = 1) {
  const wide = right - left;
  const out = new Float32Array(wide * (bottom - top) * channels);
  const [x0, x1] = [Math.max(left, 0), Math.min(right, width)];
  for (let y = Math.max(top, 0); y < Math.min(bottom, height); y++) {
    if (x1 > x0) out.set(values.subarray((y * width + x0) * channels, (y * width + x1) * channels), ((y - top) * wide + x0 - left) * channels);
  }
  return out;
}

/** Steps (right, down) to the neighbours of a pixel, clockwise from above. */
const AROUND = [[0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1]];

/** Returns lines one pixel wide (Zhang and Suen 1984, with the corners of scikit-image). @param {Uint8Array} inked @param {number} width @param {number} height */
export function thinned(inked, width, height) {
  const stride = width + 2;
  const grid = new Uint8Array(stride * (height + 2));
  /** @type {number[]} */
  let left = [];
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      if (!inked[y * width + x]) continue;
      grid[(y + 1) * stride + x + 1] = 1;
      left.push((y + 1) * stride + x + 1);
    }
  }
  const steps = AROUND.map(([right, down]) => down * stride + right);
  for (let removed = true; removed;) {
    removed = false;
    for (const half of [0, 1]) {
      /** @type {number[]} */
      const gone = [];
      for (const at of left) {
        let code = 0;
        for (let k = 0; k < 8; k++) code |= grid[at + steps[k]] << k;
        if (GOES[half][code]) gone.push(at);
      }
      for (const at of gone) grid[at] = 0;
      if (gone.length) left = left.filter((at) => grid[at]);
      removed ||= gone.length > 0;
    }
  }
  const out = new Uint8Array(inked.length);
  for (const at of left) out[(Math.floor(at / stride) - 1) * width + (at % stride) - 1] = 1;
  return out;
}

/**
 * Neighbourhoods, as bits, in which scikit-image deviates from the paper: it removes a pixel on a corner, and keeps one side
 * of a line two pixels wide. The lists: those that stay, and those that go in the first half of a round, in the second, in both.
 */
const OTHERWISE = new Map([[24, 192], [3, 6, 7, 67, 97, 99, 129, 133, 193, 208], [12, 13, 28, 48, 52, 54, 88, 96, 112], [5, 20, 65, 80]]
  .flatMap((codes, halves) => codes.map((code) => /** @type {[number, number]} */ ([code, halves]))));

/** Whether a pixel is removed in either half of a round, by the bits of its neighbours. */
const GOES = [0, 1].map((half) => Uint8Array.from({ length: 256 }, (_, code) => {
  const other = OTHERWISE.get(code);
  if (other !== undefined) return (other >> half) & 1;
  const near = AROUND.map((_step, k) => (code >> k) & 1);
  const sum = near.reduce((total, value) => total + value, 0);
  const begun = near.filter((value, k) => value < near[(k + 1) % 8]).length;
  if (sum < 2 || sum > 6 || begun !== 1) return 0;
  const [above, , right, , below, , beside] = near;
  const stays = half ? above && beside && (right || below) : right && below && (above || beside);
  return stays ? 0 : 1;
}));
