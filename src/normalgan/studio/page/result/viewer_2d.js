/** Draws the views without WebGL: the CPU shades them at the map's size, and the canvas scales them. */

import { context2d } from "../drawing/canvas.js";
import { CHECKER, placeOf } from "./viewer_fit.js";
import { celShader, clayShader, colourAt, dimming, matcapShader } from "./viewer_shading.js";

/** Number of pixels shaded while the light moves, and milliseconds of rest after which all pixels are shaded. */
const [MOVING, REST] = [2 ** 18, 160];
const SHADERS = { lit: clayShader, matcap: matcapShader, flat: celShader };

/**
 * @typedef {{light: number[], colour: number[], second: import("./viewer.js").Lamp | null, falloff: number,
 *   colours: import("./viewer.js").Picture | null}} Lamps of a scene
 */

/**
 * Returns the sRGB RGBA bytes of a map in one of the shaded views.
 * @param {import("./viewer.js").Picture} map
 * @param {"lit" | "matcap" | "flat"} view
 * @param {Lamps} lamps
 * @returns {Uint8ClampedArray<ArrayBuffer>}
 */
export function shadedPixels({ rgba, width, height }, view, { light, colour, second, falloff, colours }) {
  const shade = SHADERS[view](light, colour, second);
  const pixels = new Uint8ClampedArray(rgba.length);
  const [base, dim] = [[0, 0, 0], [1, 1]];
  const place = view === "lit" && (colours || falloff > 0);
  const longer = Math.max(width, height);
  for (let at = 0, pixel = 0; at < rgba.length; at += 4, pixel++) {
    if (rgba[at + 3] === 0) continue;
    const x = rgba[at] / 127.5 - 1;
    const y = rgba[at + 1] / 127.5 - 1;
    const z = rgba[at + 2] / 127.5 - 1;
    const length = Math.sqrt(x * x + y * y + z * z);
    if (place) {
      const [column, row] = [(pixel % width) + 0.5, Math.floor(pixel / width) + 0.5];
      const [right, up] = [(2 * column - width) / longer, (height - 2 * row) / longer];
      dim[0] = dimming(falloff, right, up, light);
      if (second) dim[1] = dimming(falloff, right, up, second.direction);
      shade(x / length, y / length, z / length, pixels, at, colours ? colourAt(colours, column / width, row / height, base) : undefined, dim);
    } else {
      shade(x / length, y / length, z / length, pixels, at);
    }
    pixels[at + 3] = rgba[at + 3];
  }
  return pixels;
}

/** Returns a smaller map, of one pixel in each square of step × step. @param {import("./viewer.js").Picture} map @param {number} step @returns {import("./viewer.js").Picture} */
function sparse({ rgba, width, height }, step) {
  const [wide, high] = [Math.ceil(width / step), Math.ceil(height / step)];
  const out = new Uint8Array(4 * wide * high);
  for (let row = 0, to = 0; row < height; row += step) {
    for (let column = 0; column < width; column += step, to += 4) {
      const from = 4 * (row * width + column);
      for (let i = 0; i < 4; i++) out[to + i] = rgba[from + i];
    }
  }
  return { rgba: out, width: wide, height: high };
}

/** Draws scenes without WebGL; in place of the relief it writes that the relief needs WebGL. */
export class PlainPainter {
  /** The view and lights that the sheet shows. */
  #drawn = "";
  /** The view alone. */
  #shown = "";
  /** Whether the sheet shows only some of the map's pixels. */
  #coarse = false;
  /** @type {import("./viewer.js").Picture | null} a reduced copy of the map, if it has many pixels */
  #few = null;
  /** The timer that ends the light's movement, and its time. */
  #resting = 0;
  #restsAt = 0;
  /** Number of changes of the colours. */
  #paints = 0;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {{reliefNeedsWebgl: string}} text
   * @param {() => void} redraw requests drawing in the next frame
   */
  constructor(canvas, text, redraw) {
    this.canvas = canvas;
    this.text = text;
    this.redraw = redraw;
    this.context = context2d(canvas);
    this.sheet = document.createElement("canvas");
  }

  /** @param {import("./viewer.js").Picture | null} map */
  setMap(map) {
    clearTimeout(this.#resting);
    this.#drawn = this.#shown = "";
    this.#coarse = false;
    const step = map ? Math.ceil(Math.sqrt((map.width * map.height) / MOVING)) : 1;
    this.#few = map && step > 1 ? sparse(map, step) : null;
  }

  setColours() {
    this.#paints++;
  }

  setHeight() {}

  /** @param {import("./viewer.js").Scene} scene */
  draw(scene) {
    const { canvas, context } = this;
    context.clearRect(0, 0, canvas.width, canvas.height);
    if (scene.view === "relief") {
      write(context, this.text.reliefNeedsWebgl, scene.ratio);
    } else if (scene.map) {
      const place = placeOf(scene, scene.map, canvas);
      if (scene.view === "map") drawChecker(context, place, scene.ratio);
      this.#fillSheet(scene.view, scene.map, scene);
      context.imageSmoothingQuality = "medium"; // "high" causes halos when it enlarges
      context.imageSmoothingEnabled = !scene.pixelated;
      context.setTransform(...place);
      const beside = scene.tiled ? [-1, 0, 1] : [0];
      for (const x of beside) for (const y of beside) context.drawImage(this.sheet, x, y, 1, 1);
      context.setTransform(1, 0, 0, 1, 0, 0);
    }
  }

  dispose() {
    this.setMap(null);
  }

  /** @param {"map" | keyof typeof SHADERS} view @param {import("./viewer.js").Picture} map @param {import("./viewer.js").Scene} scene */
  #fillSheet(view, map, scene) {
    const { light, colour, second, falloff } = scene;
    const wanted = view === "map" ? view : JSON.stringify([view, light, colour, second, falloff, this.#paints]);
    const rests = performance.now() >= this.#restsAt;
    if (this.#drawn === wanted && !(this.#coarse && rests)) return;
    if (view === "map") {
      this.#put(map, new Uint8ClampedArray(map.rgba));
      this.#coarse = false;
    } else {
      // While the light follows the pointer, only some pixels are shaded; once it rests, all are.
      const few = this.#shown === view && this.#drawn !== wanted ? this.#few : null;
      this.#coarse = few !== null;
      const picture = few ?? map;
      this.#put(picture, shadedPixels(picture, view, scene));
    }
    if (this.#coarse) {
      this.#restsAt = performance.now() + REST;
      clearTimeout(this.#resting);
      this.#resting = setTimeout(this.redraw, REST + 1);
    }
    [this.#drawn, this.#shown] = [wanted, view];
  }

  /** @param {import("./viewer.js").Picture} picture @param {Uint8ClampedArray<ArrayBuffer>} pixels */
  #put({ width, height }, pixels) {
    const { sheet } = this;
    if (sheet.width !== width || sheet.height !== height) [sheet.width, sheet.height] = [width, height];
    context2d(sheet).putImageData(new ImageData(pixels, width), 0, 0);
  }
}

/** Draws the checker that shows where a map is transparent. @param {CanvasRenderingContext2D} context @param {import("./viewer.js").Way} place @param {number} ratio */
function drawChecker(context, [a, b, c, d, e, f], ratio) {
  const { canvas } = context;
  const side = CHECKER.side * ratio;
  const corners = [[e, f], [e + a, f + b], [e + a + c, f + b + d], [e + c, f + d]];
  /** @param {0 | 1} k @param {number} first @param {number} most */
  const range = (k, first, most) => {
    const values = corners.map((corner) => corner[k]);
    return [Math.floor((Math.max(0, Math.min(...values)) - first) / side), (Math.min(most, Math.max(...values)) - first) / side];
  };
  const [left, top] = [Math.round(e), Math.round(f)];
  const [firstColumn, columns] = range(0, left, canvas.width);
  const [firstRow, rows] = range(1, top, canvas.height);
  context.save();
  context.beginPath();
  for (const [x, y] of corners) context.lineTo(x, y);
  context.clip();
  context.fillStyle = `rgba(${CHECKER.grey}, ${CHECKER.grey}, ${CHECKER.grey}, ${CHECKER.alpha})`;
  for (let row = firstRow; row < rows; row++) {
    for (let column = firstColumn; column < columns; column++) {
      if ((row + column) % 2) context.fillRect(left + column * side, top + row * side, side, side);
    }
  }
  context.restore();
}

/** Writes a sentence in lines into the middle of a canvas. @param {CanvasRenderingContext2D} context @param {string} sentence @param {number} ratio */
function write(context, sentence, ratio) {
  const { canvas } = context;
  context.font = `${15 * ratio}px system-ui, sans-serif`;
  context.fillStyle = getComputedStyle(canvas).color;
  context.textAlign = "center";
  const lines = [""];
  for (const word of sentence.split(" ")) {
    const longer = `${lines.at(-1)} ${word}`.trim();
    if (context.measureText(longer).width < 0.85 * canvas.width) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  const first = canvas.height / 2 - 11 * ratio * (lines.length - 1);
  lines.forEach((line, i) => context.fillText(line, canvas.width / 2, first + 22 * ratio * i));
}
