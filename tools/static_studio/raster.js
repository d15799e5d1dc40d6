/** Raster: pictures as arrays, row by row: sizes, distances, what hangs together. As OpenCV has them. */

/** @typedef {Uint8Array | Float32Array | Uint8ClampedArray} Plane */
/** @typedef {[number, number, number, number]} Box left, top, right, bottom */

const FAR = 1e6;
/** Lengths of steps to the side, across a corner, and of a knight (Borgefors 1986), to the 65536th to which OpenCV has them. */
const FIVE = /** @type {[number, number, number]} */ ([1, 1.4, 2.1969].map((length) => Math.round(length * 65536) / 65536));

/** Rounds halves to even, as NumPy does. @param {number} value */
export function rint(value) {
  const rounded = Math.round(value);
  return Math.abs(value % 1) === 0.5 && rounded % 2 ? rounded - 1 : rounded;
}

/**
 * Returns how far each pixel is from the nearest one that is 0, by chamfers, of 5 × 5 unless other lengths are given.
 * @param {Plane} marked @param {number} width @param {number} height
 * @param {boolean} [bounded] whether what lies beyond the picture is 0 too
 * @param {[number, number, number]} [lengths] of steps to the side, across a corner, and of a knight
 */
export function distance(marked, width, height, bounded = false, lengths = FIVE) {
  const stride = width + 4;
  const away = new Float32Array(stride * (height + 4)).fill(bounded ? 0 : FAR);
  for (let y = 0; y < height; y++) {
    for (let x = 0, at = (y + 2) * stride + 2, from = y * width; x < width; x++, at++, from++) {
      away[at] = marked[from] ? nearer(away, at, stride, 1, lengths) : 0;
    }
  }
  const out = new Float32Array(width * height);
  for (let y = height - 1; y >= 0; y--) {
    for (let x = width - 1, at = (y + 2) * stride + 2 + x, to = y * width + x; x >= 0; x--, at--, to--) {
      const found = away[at];
      if (found > 0) away[at] = Math.min(found, nearer(away, at, stride, -1, lengths));
      out[to] = away[at];
    }
  }
  return out;
}

/** Returns the least way to a pixel past those before it, or after it. @param {Float32Array} away @param {number} at @param {number} stride @param {1 | -1} way @param {[number, number, number]} lengths */
function nearer(away, at, stride, way, [side, corner, knight]) {
  const [line, two, one] = [way * stride, way * 2, way];
  const beside = Math.min(away[at - one], away[at - line]) + side;
  const across = Math.min(away[at - line - one], away[at - line + one]) + corner;
  const jump = Math.min(away[at - line - two], away[at - line + two], away[at - 2 * line - one], away[at - 2 * line + one]) + knight;
  return Math.min(beside, across, jump);
}

/** Returns where a condition holds, 1 and 0. @param {Plane | Int32Array} values @param {(value: number, at: number) => boolean} holds */
export function where(values, holds) {
  const out = new Uint8Array(values.length);
  for (let i = 0; i < out.length; i++) out[i] = holds(values[i], i) ? 1 : 0;
  return out;
}

/** Returns what is marked and all within a reach of it. @param {Uint8Array} marked @param {number} width @param {number} height @param {number} reach */
export function thicker(marked, width, height, reach) {
  if (reach < 1) return marked;
  const away = distance(opposite(marked), width, height);
  const out = new Uint8Array(marked.length);
  for (let i = 0; i < out.length; i++) out[i] = away[i] <= reach ? 1 : 0;
  return out;
}

/** Returns 1 where nothing is marked. @param {Plane} marked */
export function opposite(marked) {
  const out = new Uint8Array(marked.length);
  for (let i = 0; i < out.length; i++) out[i] = marked[i] ? 0 : 1;
  return out;
}

/**
 * Returns the pictures' parts that hang together, from 1 on, and how many there are with the rest, 0.
 * @param {Uint8Array} marked @param {number} width @param {number} height @param {4 | 8} ways
 */
export function components(marked, width, height, ways) {
  const labels = new Int32Array(marked.length);
  /** @type {{area: number, left: number, top: number, right: number, bottom: number}[]} */
  const boxes = [{ area: 0, left: 0, top: 0, right: 0, bottom: 0 }];
  const stack = [];
  for (let first = 0; first < marked.length; first++) {
    if (!marked[first] || labels[first]) continue;
    const label = boxes.length;
    const box = { area: 0, left: width, top: height, right: 0, bottom: 0 };
    boxes.push(box);
    labels[first] = label;
    stack.push(first);
    while (stack.length) {
      const at = /** @type {number} */ (stack.pop());
      const [x, y] = [at % width, Math.floor(at / width)];
      box.area++;
      box.left = Math.min(box.left, x);
      box.right = Math.max(box.right, x + 1);
      box.top = Math.min(box.top, y);
      box.bottom = Math.max(box.bottom, y + 1);
      for (let dy = -1; dy <= 1; dy++) {
        for (let dx = -1; dx <= 1; dx++) {
          if ((ways === 4 && dx && dy) || x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) continue;
          const next = at + dy * width + dx;
          if (!marked[next] || labels[next]) continue;
          labels[next] = label;
          stack.push(next);
        }
      }
    }
  }
  return { labels, boxes };
}

/** Returns a barrier and all that cannot be reached past it from the picture's edge. @param {Uint8Array} barrier @param {number} width @param {number} height */
export function enclosedBy(barrier, width, height) {
  const inside = new Uint8Array(barrier.length).fill(1);
  /** @type {number[]} */
  const stack = [];
  /** @param {number} at */
  const reach = (at) => {
    if (barrier[at] || !inside[at]) return;
    inside[at] = 0;
    stack.push(at);
  };
  for (let x = 0; x < width; x++) [x, (height - 1) * width + x].forEach(reach);
  for (let y = 0; y < height; y++) [y * width, y * width + width - 1].forEach(reach);
  while (stack.length) {
    const at = /** @type {number} */ (stack.pop());
    const x = at % width;
    if (x > 0) reach(at - 1);
    if (x < width - 1) reach(at + 1);
    if (at >= width) reach(at - width);
    if (at < barrier.length - width) reach(at + width);
  }
  return inside;
}

/**
 * Returns the greatest (way 1) or least (way -1) value in a square about each pixel.
 * @param {Plane} values @param {number} width @param {number} height @param {number} radius @param {1 | -1} way
 */
export function extreme(values, width, height, radius, way) {
  const from = new Float32Array(values);
  const size = 2 * radius + 1;
  const longest = Math.max(width, height) + 2 * radius + size;
  const [line, ahead, back] = [new Float32Array(longest), new Float32Array(longest), new Float32Array(longest)];
  for (const [count, length, step, stride] of [[height, width, 1, width], [width, height, width, 1]]) {
    const padded = Math.ceil((length + 2 * radius) / size) * size;
    for (let i = 0; i < count; i++) {
      // In blocks of the window's size, the best from either end: two of them make any window (van Herk 1992).
      line.fill(-way * FAR, 0, padded);
      for (let k = 0, at = i * stride; k < length; k++, at += step) line[k + radius] = from[at];
      for (let k = 0; k < padded; k++) {
        const before = k % size ? ahead[k - 1] : line[k];
        ahead[k] = way > 0 ? Math.max(before, line[k]) : Math.min(before, line[k]);
      }
      for (let k = padded - 1; k >= 0; k--) {
        const after = (k + 1) % size ? back[k + 1] : line[k];
        back[k] = way > 0 ? Math.max(after, line[k]) : Math.min(after, line[k]);
      }
      for (let k = 0, at = i * stride; k < length; k++, at += step) {
        const [one, other] = [back[k], ahead[k + size - 1]];
        from[at] = way > 0 ? Math.max(one, other) : Math.min(one, other);
      }
    }
  }
  return from;
}

/** Returns a picture blurred by a Gaussian. @param {Plane} values @param {number} width @param {number} height @param {number} sigma */
export function blurred(values, width, height, sigma) {
  const radius = rint(8 * sigma + 1) >> 1;
  const kernel = Array.from({ length: 2 * radius + 1 }, (_, i) => Math.exp(-((i - radius) ** 2) / (2 * sigma * sigma)));
  const total = kernel.reduce((sum, value) => sum + value, 0);
  return filtered(values, width, height, kernel.map((value) => value / total));
}

/**
 * Returns a picture convolved along its rows and its columns; beyond its edge it is mirrored.
 * @param {Plane} values @param {number} width @param {number} height @param {number[]} kernel an odd number of weights
 */
export function filtered(values, width, height, kernel) {
  const radius = kernel.length >> 1;
  const from = new Float32Array(values);
  const line = new Float32Array(Math.max(width, height) + 2 * radius);
  for (const [count, length, step, stride] of [[height, width, 1, width], [width, height, width, 1]]) {
    for (let i = 0; i < count; i++) {
      for (let k = -radius; k < length + radius; k++) {
        let other = Math.abs(k);
        if (other >= length) other = Math.max(0, 2 * length - 2 - other);
        line[k + radius] = from[i * stride + other * step];
      }
      for (let k = 0, at = i * stride; k < length; k++, at += step) {
        let sum = 0;
        for (let j = 0; j < kernel.length; j++) sum += kernel[j] * line[k + j];
        from[at] = sum;
      }
    }
  }
  return from;
}

/**
 * Returns what each of `to` places along a line is made of, of `from`: first place and weights.
 * @param {number} from @param {number} to @param {boolean} cubic @returns {[number, number[]][]}
 */
function mixture(from, to, cubic) {
  const scale = from / to;
  if (cubic && scale < 1) return curve(from, to);
  return Array.from({ length: to }, (_, i) => {
    if (scale > 1) { // the mean over an area
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
 * Returns what `mixture` returns where four places count (Keys 1981), with the slope of OpenCV's.
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
      weights[Math.min(Math.max(before + k, 0), from - 1) - first] += weight; // beyond the edge it goes on as it is
    }
    return [first, weights];
  });
}

/**
 * Returns a picture of another size: averaged over areas, or interpolated.
 * @param {Plane} values @param {number} width @param {number} height
 * @param {number} wide @param {number} high @param {number} [channels] @param {boolean} [cubic] whether by cubic curves, not lines
 */
export function resized(values, width, height, wide, high, channels = 1, cubic = false) {
  const across = mixture(width, wide, cubic);
  const down = mixture(height, high, cubic);
  const rows = new Float32Array(wide * height * channels);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < wide; x++) {
      const [first, weights] = across[x];
      for (let c = 0; c < channels; c++) {
        let sum = 0;
        for (let k = 0; k < weights.length; k++) sum += weights[k] * values[(y * width + first + k) * channels + c];
        rows[(y * wide + x) * channels + c] = sum;
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

/** Returns the value that a share of the values do not exceed; NaN if there are none. @param {number[] | Float32Array} values @param {number} [share] */
export function quantile(values, share = 0.5) {
  const count = values.length;
  if (!count) return NaN;
  const rank = Math.min(count - 1, Math.max(0, Math.ceil(share * count) - 1));
  if (count < 4096) return new Float32Array(values).sort()[rank];
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < count; i++) {
    low = Math.min(low, values[i]);
    high = Math.max(high, values[i]);
  }
  // To a 4096th of the range, as in Python: sorting takes longer than all else.
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

/** Returns the middle one of values, or the mean of the two in the middle. @param {number[] | Float32Array} values one at least */
export function median(values) {
  const sorted = new Float32Array(values).sort();
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : Math.fround((sorted[middle - 1] + sorted[middle]) / 2);
}

/** Returns the box of what is marked, or null if nothing is. @param {Plane} values @param {number} width @param {number} height @param {number} [above] @returns {Box | null} */
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

/** Returns a part of a picture; what lies beyond it is 0. @param {Plane} values @param {number} width @param {number} height @param {Box} box @param {number} [channels] */
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
 * Neighbourhoods, as bits, of which scikit-image thinks otherwise than the paper: a pixel on a corner goes, and of a line two
 * pixels wide one side stays. Those that stay, go in the first half of a round, in the second, in both.
 */
const OTHERWISE = new Map([[24, 192], [3, 6, 7, 67, 97, 99, 129, 133, 193, 208], [12, 13, 28, 48, 52, 54, 88, 96, 112], [5, 20, 65, 80]]
  .flatMap((codes, halves) => codes.map((code) => /** @type {[number, number]} */ ([code, halves]))));

/** Whether a pixel goes in either half of a round, by the bits of its neighbours. */
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
