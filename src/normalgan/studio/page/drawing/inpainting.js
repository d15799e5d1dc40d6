/** Inpainting: reconstruct the paper under ink, which may be photographed, toned or grainy. */

/** Side in pixels of the blocks whose means give the paper's tone; lines are narrower, and shadows are wider. */
const BLOCK = 8;
/** Number of relaxations at each scale. */
const SWEEPS = 6;
/** Maximum difference of paper from its main colour, in levels; more is certainly ink. */
const WIDE = 64;
/** Minimum and maximum threshold between ink and paper in levels, and its ratio to the paper's grain. */
const [LEAST, MOST, GRAIN] = [6, 48, 6];
/** Margin in pixels that counts as ink, because the edge of ink is fainter than the paper's grain. */
const EDGE = 2;
/** Distances in pixels from which grain is copied. */
const AWAY = [12, 24, 48, 96];

/**
 * Fills unknown pixels smoothly: solves Laplace's equation between the known ones, from coarse to fine.
 * @param {Float32Array} values red, green, blue of each pixel; in place
 * @param {Uint8Array} known @param {number} width @param {number} height
 */
function fillSmoothly(values, known, width, height) {
  if (known.every(Boolean)) return;
  const [wide, high] = [(width + 1) >> 1, (height + 1) >> 1];
  const coarse = new Float32Array(3 * wide * high);
  const counts = new Uint8Array(wide * high);
  for (let i = 0; i < known.length; i++) {
    if (!known[i]) continue;
    const to = ((i / width) >> 1) * wide + ((i % width) >> 1);
    counts[to] += 1;
    for (let c = 0; c < 3; c++) coarse[3 * to + c] += (values[3 * i + c] - coarse[3 * to + c]) / counts[to];
  }
  if (wide < width || high < height) fillSmoothly(coarse, counts, wide, high);
  for (let i = 0; i < known.length; i++) {
    if (!known[i]) for (let c = 0; c < 3; c++) values[3 * i + c] = between(coarse, wide, high, ((i % width) - 0.5) / 2, (Math.floor(i / width) - 0.5) / 2, c);
  }
  for (let sweep = 0; sweep < SWEEPS; sweep++) {
    for (let i = 0; i < known.length; i++) {
      if (known[i]) continue;
      const x = i % width;
      const [left, right] = [x ? i - 1 : i, x < width - 1 ? i + 1 : i];
      const [above, below] = [i >= width ? i - width : i, i < known.length - width ? i + width : i];
      for (let c = 0; c < 3; c++) values[3 * i + c] = (values[3 * left + c] + values[3 * right + c] + values[3 * above + c] + values[3 * below + c]) / 4;
    }
  }
}

/** Returns a bilinearly interpolated value. @param {Float32Array} values @param {number} width @param {number} height @param {number} x @param {number} y @param {number} c */
function between(values, width, height, x, y, c) {
  const [column, row] = [Math.max(0, Math.min(width - 1, x)), Math.max(0, Math.min(height - 1, y))];
  const [left, top] = [Math.floor(column), Math.floor(row)];
  const [right, bottom] = [Math.min(width - 1, left + 1), Math.min(height - 1, top + 1)];
  const [across, down] = [column - left, row - top];
  const upper = values[3 * (top * width + left) + c] * (1 - across) + values[3 * (top * width + right) + c] * across;
  const lower = values[3 * (bottom * width + left) + c] * (1 - across) + values[3 * (bottom * width + right) + c] * across;
  return upper * (1 - down) + lower * down;
}

/**
 * Returns the tone of the paper without its grain: red, green, blue of each pixel.
 * @param {Uint8ClampedArray} data RGBA @param {Uint8Array} isInk @param {number} width @param {number} height @param {number[]} paper
 */
function toneOf(data, isInk, width, height, paper) {
  const [wide, high] = [Math.ceil(width / BLOCK), Math.ceil(height / BLOCK)];
  const means = new Float32Array(3 * wide * high);
  const counts = new Uint8Array(wide * high);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const i = y * width + x;
      if (isInk[i]) continue;
      const to = Math.floor(y / BLOCK) * wide + Math.floor(x / BLOCK);
      counts[to] += 1;
      for (let c = 0; c < 3; c++) means[3 * to + c] += (data[4 * i + c] - means[3 * to + c]) / counts[to];
    }
  }
  if (!counts.some(Boolean)) {
    // There is only ink.
    counts.fill(1);
    for (let i = 0; i < means.length; i++) means[i] = paper[i % 3];
  }
  fillSmoothly(means, counts, wide, high);
  const tone = new Float32Array(3 * width * height);
  for (let i = 0; i < width * height; i++) {
    const [x, y] = [((i % width) + 0.5) / BLOCK - 0.5, (Math.floor(i / width) + 0.5) / BLOCK - 0.5];
    for (let c = 0; c < 3; c++) tone[3 * i + c] = between(means, wide, high, x, y, c);
  }
  return tone;
}

/** Returns the largest difference of a channel between a pixel and a colour. @param {Uint8ClampedArray} data @param {number} i @param {ArrayLike<number>} colour @param {number} at */
const distance = (data, i, colour, at) =>
  Math.max(Math.abs(data[4 * i] - colour[at]), Math.abs(data[4 * i + 1] - colour[at + 1]), Math.abs(data[4 * i + 2] - colour[at + 2]));

/** Returns marked pixels dilated by a distance along rows and columns. @param {Uint8Array} marked @param {number} width @param {number} by */
function dilated(marked, width, by) {
  let out = marked;
  for (const [step, limit] of [[1, width], [width, Infinity]]) {
    const from = out;
    out = from.slice();
    for (let i = 0; i < from.length; i++) {
      if (!from[i]) continue;
      for (let k = -by; k <= by; k++) {
        const to = i + k * step;
        if (to >= 0 && to < from.length && (limit === Infinity || Math.floor(to / width) === Math.floor(i / width))) out[to] = 1;
      }
    }
  }
  return out;
}

/**
 * Returns the mask of the ink, and the paper without ink. Under ink, the paper has the tone of its surroundings and grain copied
 * from nearby.
 * @param {Uint8ClampedArray} data RGBA, opaque @param {number} width @param {number} height
 * @param {number[]} paper the colour that most of it has
 * @returns {{isInk: Uint8Array, ground: Uint8ClampedArray}} ground: RGBA
 */
export function paperUnder(data, width, height, paper) {
  const count = width * height;
  const inkBy = (/** @type {(i: number) => boolean} */ tells) => dilated(Uint8Array.from({ length: count }, (_, i) => Number(tells(i))), width, EDGE);
  const rough = toneOf(data, inkBy((i) => distance(data, i, paper, 0) > WIDE), width, height, paper);
  const spread = new Uint32Array(256);
  for (let i = 0; i < count; i++) spread[Math.round(Math.min(255, distance(data, i, rough, 3 * i)))] += 1;
  let [half, seen] = [0, spread[0]];
  while (seen < count / 2) seen += spread[++half];
  const least = Math.max(LEAST, Math.min(MOST, GRAIN * half));
  const isInk = inkBy((i) => distance(data, i, rough, 3 * i) > least);
  const tone = toneOf(data, isInk, width, height, paper);
  const ground = data.slice();
  const inked = [...isInk.keys()].filter((i) => isInk[i]);
  const from = (/** @type {number} */ i, /** @type {number[]} */ [right, down]) => {
    const [x, y] = [(i % width) + right, Math.floor(i / width) + down];
    const other = y * width + x;
    return x >= 0 && y >= 0 && x < width && y < height && !isInk[other] ? other : -1;
  };
  const ways = AWAY.flatMap((far) => [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]].map((way) => way.map((each) => each * far)))
    .map((way) => ({ way, found: inked.reduce((sum, i, k) => (k % 16 ? sum : sum + Number(from(i, way) >= 0)), 0) }))
    .sort((a, b) => b.found - a.found);
  for (const i of inked) {
    let other = -1;
    for (let k = 0; other < 0 && k < ways.length; k++) other = from(i, ways[k].way);
    for (let c = 0; c < 3; c++) ground[4 * i + c] = tone[3 * i + c] + (other < 0 ? 0 : data[4 * other + c] - tone[3 * other + c]);
  }
  return { isInk, ground };
}
