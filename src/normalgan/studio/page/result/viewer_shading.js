/**
 * The viewer's shading of a normal: materials, and their colours on the CPU; viewer_shaders.js has the same in GLSL.
 * Normals and lights: x right, y up, z to the viewer. Colours: linear, 0 to 1, unless named sRGB.
 */

/** @typedef {(x: number, y: number, z: number, out: Uint8ClampedArray, at: number) => void} Shader
 * writes the three sRGB levels of a unit normal into out, from index at on */

/**
 * The clay from normalgan.inference.outputs.lighting, so that the page and `generate --preview` look alike.
 * @type {{colour: number[], lamp: number[], sky: number[], ground: number[], gloss: number, sharpness: number}}
 */
export const CLAY = await (await fetch(new URL("../clay.json", import.meta.url))).json();

/** Flat paints in sRGB from dark to bright, each above its threshold, and last a glint. */
export const CEL = {
  paints: [
    [0.36, 0.35, 0.52],
    [0.8, 0.6, 0.5],
    [0.96, 0.83, 0.66],
    [1, 0.97, 0.9],
  ],
  thresholds: [0.12, 0.62], // thresholds of Lambert's cosine
  glint: 0.988, // cosine between the normal and the half-way vector
  soft: 0.02, // half the width of a step
};

/** Matcap: a glazed ball in a photographer's studio. */
const GLAZE = {
  dark: [0.012, 0.03, 0.05],
  body: [0.1, 0.36, 0.38],
  window: [1, 0.96, 0.88],
  fill: [0.5, 0.22, 0.1],
  rim: [0.35, 0.5, 0.6],
};

/** Side of the matcap in pixels. */
export const MATCAP_SIZE = 256;

/** @param {number[]} vector @returns {number[]} of length 1 */
export function normalised(vector) {
  const length = Math.hypot(...vector);
  return vector.map((value) => value / length);
}

/** Returns the unit vector half-way between the light and the viewer. @param {number[]} light */
function halfway(light) {
  return normalised([light[0], light[1], light[2] + 1 + 1e-6]);
}

/** @param {number[]} a @param {number} x @param {number} y @param {number} z */
const dot = (a, x, y, z) => a[0] * x + a[1] * y + a[2] * z;

/** @param {number} from @param {number} to @param {number} value */
function smoothstep(from, to, value) {
  const t = Math.min(Math.max((value - from) / (to - from), 0), 1);
  return t * t * (3 - 2 * t);
}

const TABLE = Uint8ClampedArray.from({ length: 4097 }, (_, i) => {
  const linear = i / 4096;
  return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
});

/** Returns the sRGB level, 0 to 255, of a linear value (IEC 61966-2-1). @param {number} linear */
function toSrgb(linear) {
  return TABLE[Math.round(4096 * Math.min(Math.max(linear, 0), 1))];
}

/** Linear values of sRGB levels. */
const LINEAR = Float32Array.from({ length: 256 }, (_, level) => {
  const value = level / 255;
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
});

/** White light. */
export const WHITE = [1, 1, 1];
/** How fast a light fades at full falloff: to one half within a quarter of half the picture's longer side. */
export const FADE = 4;
const UNDIMMED = [1, 1];

/**
 * Returns the intensity of the light from a lamp over a picture.
 * @param {number} falloff 0 to 1
 * @param {number} x right, from the picture's middle, in halves of its longer side @param {number} y up
 * @param {number[]} light direction towards it
 */
export function dimming(falloff, x, y, light) {
  return 1 / (1 + (FADE * falloff) ** 2 * ((x - light[0]) ** 2 + (y - light[1]) ** 2));
}

/**
 * Writes the linear colour of a picture at a share of its sides, over white.
 * @param {{rgba: Uint8Array | Uint8ClampedArray, width: number, height: number}} picture @param {number} right @param {number} down @param {number[]} out
 */
export function colourAt({ rgba, width, height }, right, down, out) {
  const from = 4 * (Math.min(height - 1, Math.floor(down * height)) * width + Math.min(width - 1, Math.floor(right * width)));
  const alpha = rgba[from + 3] / 255;
  for (let i = 0; i < 3; i++) out[i] = LINEAR[Math.round(rgba[from + i] * alpha + 255 * (1 - alpha))];
  return out;
}

/**
 * Shades with Lambert's law, the highlight of Blinn 1977, and a sky that lights surfaces facing up.
 * @param {number[]} light unit vector
 * @param {number[]} [colour] linear
 * @param {{direction: number[], colour: number[]} | null} [second] another light, without a sky
 * @returns {(x: number, y: number, z: number, out: Uint8ClampedArray, at: number, base?: number[], dim?: number[]) => void} a
 *   shader; base: linear colour of the surface, dim: how much comes from either lamp
 */
export function clayShader(light, colour = WHITE, second = null) {
  const lamps = [{ direction: light, colour }, ...(second ? [second] : [])].map((each) => ({
    direction: each.direction, half: halfway(each.direction), lamp: CLAY.lamp.map((value, i) => value * each.colour[i]),
  }));
  const { colour: clay, sky, ground, gloss, sharpness } = CLAY;
  const sum = [0, 0, 0]; // one for all pixels: a new one per pixel would take longer than everything else
  return (x, y, z, out, at, base = clay, dim = UNDIMMED) => {
    const up = (y + 1) / 2;
    for (let i = 0; i < 3; i++) sum[i] = base[i] * (up * sky[i] + (1 - up) * ground[i]);
    for (let k = 0; k < lamps.length; k++) {
      const { direction, half, lamp } = lamps[k];
      const lambert = dot(direction, x, y, z);
      if (lambert <= 0) continue;
      const facing = Math.max(dot(half, x, y, z), 0);
      const glint = gloss * facing ** sharpness * Math.min(4 * lambert, 1);
      for (let i = 0; i < 3; i++) sum[i] += (base[i] * lambert + glint) * lamp[i] * dim[k];
    }
    for (let i = 0; i < 3; i++) out[at + i] = toSrgb(sum[i]);
  };
}

/**
 * Shades with flat paints and soft steps between them.
 * @param {number[]} light unit vector
 * @returns {Shader}
 */
export function celShader(light) {
  const half = halfway(light);
  const { paints, thresholds, soft } = CEL;
  /** @param {number} edge @param {number} value */
  const step = (edge, value) => smoothstep(edge - soft, edge + soft, value);
  return (x, y, z, out, at) => {
    const lambert = dot(light, x, y, z);
    const lit = step(thresholds[0], lambert);
    const bright = step(thresholds[1], lambert);
    const glint = smoothstep(CEL.glint - soft / 8, CEL.glint + soft / 8, dot(half, x, y, z));
    for (let i = 0; i < 3; i++) {
      let paint = paints[0][i] + (paints[1][i] - paints[0][i]) * lit;
      paint += (paints[2][i] - paint) * bright;
      out[at + i] = 255 * (paint + (paints[3][i] - paint) * glint);
    }
  };
}

/**
 * Shades the ball: a body that darkens away from the light, with a window and a warm fill light mirrored in the glaze.
 * @param {number[]} light
 * @returns {Shader}
 */
function glazeShader(light) {
  const fillLight = normalised([-light[0], 0.3 - light[1], 0.35]);
  return (x, y, z, out, at) => {
    const [rx, ry, rz] = [2 * z * x, 2 * z * y, 2 * z * z - 1];
    const wrapped = (0.5 + 0.5 * dot(light, x, y, z)) ** 2;
    const window = 0.75 * smoothstep(0.86, 0.96, dot(light, rx, ry, rz));
    const fill = smoothstep(0.2, 1, dot(fillLight, rx, ry, rz)) * 0.55;
    const rim = (1 - z) ** 3 * (0.6 + 0.4 * y);
    for (let i = 0; i < 3; i++) {
      const body = GLAZE.dark[i] + (GLAZE.body[i] - GLAZE.dark[i]) * wrapped;
      out[at + i] = toSrgb(body + window * GLAZE.window[i] + fill * GLAZE.fill[i] + rim * GLAZE.rim[i]);
    }
  };
}

/**
 * Returns the sRGB RGBA bytes of the ball, MATCAP_SIZE a side, rows from the bottom: y grows as in normals.
 * @param {number[]} light unit vector
 * @returns {Uint8ClampedArray}
 */
export function matcapPixels(light) {
  const shade = glazeShader(light);
  const pixels = new Uint8ClampedArray(4 * MATCAP_SIZE ** 2).fill(255);
  for (let row = 0, at = 0; row < MATCAP_SIZE; row++) {
    for (let column = 0; column < MATCAP_SIZE; column++, at += 4) {
      let x = ((column + 0.5) / MATCAP_SIZE) * 2 - 1;
      let y = ((row + 0.5) / MATCAP_SIZE) * 2 - 1;
      const outside = Math.max(Math.hypot(x, y), 1); // beyond the ball its rim continues
      x /= outside;
      y /= outside;
      shade(x, y, Math.sqrt(Math.max(1 - x * x - y * y, 0)), pixels, at);
    }
  }
  return pixels;
}

/**
 * Shades a normal like the ball where it faces the same way.
 * @param {number[]} light unit vector
 * @returns {Shader}
 */
export function matcapShader(light) {
  const ball = matcapPixels(light);
  return (x, y, z, out, at) => {
    const outside = z < 0 ? Math.hypot(x, y) : 1; // a normal that faces away looks like the rim
    /** @param {number} value */
    const cell = (value) =>
      Math.min(Math.max(Math.floor(((value / outside + 1) / 2) * MATCAP_SIZE), 0), MATCAP_SIZE - 1);
    const from = 4 * (cell(y) * MATCAP_SIZE + cell(x));
    for (let i = 0; i < 3; i++) out[at + i] = ball[from + i];
  };
}
