/** The viewer: a normal map under a movable light, as matcap, in flat paints, or as a relief to turn. */

import { PlainPainter, shadedPixels } from "./viewer_2d.js";
import { GlPainter } from "./viewer_gl.js";
import { DEFAULT_LIGHT, FRONT, ViewerInput } from "./viewer_input.js";
import { WHITE, normalised } from "./viewer_shading.js";

/** @type {Record<string, string>} */
const CURSORS = { map: "default", relief: "grab" };
const VIEWS = new Set(["map", "lit", "matcap", "flat", "relief"]);

/** @param {{length: number}} values @param {number} width @param {number} height @param {number} channels */
function checkSize(values, width, height, channels) {
  if (values.length !== width * height * channels) {
    throw new RangeError(`${values.length} values do not make ${width} × ${height} × ${channels}`);
  }
}

/** @typedef {[number, number, number, number, number, number]} Way a transform in the form of a canvas */
/** @typedef {"map" | "lit" | "matcap" | "flat" | "relief"} View */
/** @typedef {{rgba: Uint8Array, width: number, height: number}} Picture */
/** @typedef {{heights: Float32Array, width: number, height: number}} Heights in pixels, NaN off the object */
/**
 * @typedef {{map: Picture | null, heights: Heights | null, view: View, light: number[],
 *   turn: {yaw: number, pitch: number, zoom: number}, ratio: number, frame: Frame | null, colour: number[],
 *   second: Lamp | null, falloff: number, colours: Picture | null, tiled: boolean, pixelated: boolean}} Scene everything to show; falloff: 0 to 1; colours: of
 *   the surface, which is clay without them
 */
/**
 * @typedef {object} ScenePainter draws the scene, with WebGL or without
 * @property {(map: Picture | null) => void} setMap
 * @property {(colours: Picture | null) => void} setColours
 * @property {(heights: Heights | null) => void} setHeight
 * @property {(scene: Scene) => void} draw
 * @property {() => void} dispose
 */
/**
 * @typedef {{transform: Way, angle: number}} Frame the place of the map: from its shares to pixels of the page, and
 *   its rotation
 * @typedef {{direction: number[], colour: number[]}} Lamp direction towards it; colour: linear red, green, blue
 */

/** A viewer on a canvas, which must be sized by CSS. */
export class Viewer {
  /** @type {ScenePainter | null} */
  #painter = null;
  /** @type {Scene} */
  #scene = { map: null, heights: null, view: "lit", light: DEFAULT_LIGHT, turn: { ...FRONT }, ratio: 1, frame: null, colour: WHITE, second: null, falloff: 0, colours: null, tiled: false, pixelated: false };
  /** ID of the animation frame that draws next, or 0. */
  #frame = 0;
  #ending = new AbortController();

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {object} options
   * @param {{reliefNeedsWebgl: string, contextLost: string, webglFailed: string}} options.text sentences
   * @param {(sentence: string | null) => void} [options.onError] receives one of them, or null once the error is over
   * @param {(move: {light: number[]}) => void} [options.onMove] receives the new direction when the user moves the light
   */
  constructor(canvas, { onError = () => {}, text, onMove = () => {} }) {
    this.canvas = canvas;
    this.text = text;
    this.onError = onError;
    this.gl = canvas.getContext("webgl2", { antialias: true, depth: true });
    canvas.tabIndex = 0;
    canvas.style.touchAction = "none"; // a finger moves the light, not the page
    const { signal } = this.#ending;
    this.#followContext(signal);
    this.input = new ViewerInput(canvas, this.#scene, (what) => {
      this.#redraw();
      if (what === "light") onMove({ light: [...this.light] });
    }, signal);
    const observer = new ResizeObserver(() => this.resize());
    observer.observe(canvas);
    signal.addEventListener("abort", () => observer.disconnect());
    this.#start();
    this.resize();
  }

  /** Whether WebGL is available; without it, the CPU draws everything except the relief. */
  get available() {
    return this.gl !== null;
  }

  /** Towards the light. */
  get light() {
    return this.#scene.light;
  }

  /**
   * Returns the direction to a light over a point of the canvas.
   * @param {number} x in pixels of the page
   * @param {number} y
   */
  lightAt(x, y) {
    return this.input.lightAt(x, y);
  }

  /**
   * @param {Uint8Array | null} rgba colours of normals, OpenGL green, row by row from the top; alpha is the object
   * @param {number} [width]
   * @param {number} [height]
   */
  setMap(rgba, width = 0, height = 0) {
    if (rgba) checkSize(rgba, width, height, 4);
    this.#scene.map = rgba && { rgba, width, height };
    this.#painter?.setMap(this.#scene.map);
    this.#redraw();
  }

  /**
   * @param {Float32Array | null} heights in pixels towards the viewer, row by row from the top, NaN off the object
   * @param {number} [width]
   * @param {number} [height]
   */
  setHeight(heights, width = 0, height = 0) {
    if (heights) checkSize(heights, width, height, 1);
    this.#scene.heights = heights && { heights, width, height };
    this.#painter?.setHeight(this.#scene.heights);
    this.#redraw();
  }

  /** @param {View} view */
  setView(view) {
    if (!VIEWS.has(view)) throw new RangeError(`no view is called ${view}`);
    if (!this.gl && view === "relief") this.onError(this.text.reliefNeedsWebgl);
    if (!this.gl && this.#scene.view === "relief" && view !== "relief") this.onError(null);
    this.canvas.style.cursor = CURSORS[view] ?? "crosshair";
    this.#change({ view });
  }

  /** @param {number[]} light towards the light: x right, y up, z to the viewer */
  setLight(light) {
    this.#change({ light: normalised(light) });
  }

  /**
   * Sets the lights, whose colours show in the views Lit and Relief.
   * @param {Lamp} first
   * @param {Lamp | null} second
   * @param {number} [falloff]
   */
  setLights(first, second, falloff = 0) {
    this.#change({
      falloff, light: normalised(first.direction), colour: first.colour,
      second: second && { ...second, direction: normalised(second.direction) },
    });
  }

  /** @param {Frame | null} frame the place of the map; null fits it into the canvas */
  setFrame(frame) {
    this.#change({ frame });
  }

  /** @param {Picture | null} picture colours of the surface in the views Lit and Relief; null for clay */
  setColours(picture) {
    this.#painter?.setColours(picture);
    this.#change({ colours: picture });
  }

  /** @param {{tiled: boolean, pixelated: boolean}} look whether a flat view repeats the map three by three, and whether it shows sharp pixels */
  setLook(look) {
    this.#change(look);
  }

  /**
   * Returns the RGBA of a map of any size in the current view; the views Map and Relief give the lit map.
   * @param {Picture} map
   * @param {Picture | null} colours
   */
  shaded(map, colours) {
    const { view } = this.#scene;
    return shadedPixels(map, view === "matcap" || view === "flat" ? view : "lit", { ...this.#scene, colours });
  }

  resize() {
    const { canvas } = this;
    const box = canvas.getBoundingClientRect();
    const ratio = window.devicePixelRatio;
    this.#scene.ratio = ratio;
    /** @param {number} side */
    const pixels = (side) => Math.max(1, Math.round(side * ratio));
    const [width, height] = [pixels(box.width), pixels(box.height)];
    if (canvas.width === width && canvas.height === height) return;
    [canvas.width, canvas.height] = [width, height];
    // Setting a size clears the canvas, so draw at once to avoid flicker.
    this.#painter?.draw(this.#scene);
  }

  dispose() {
    this.#ending.abort();
    cancelAnimationFrame(this.#frame);
    this.#painter?.dispose();
    this.#painter = null;
  }

  /** @param {AbortSignal} signal */
  #followContext(signal) {
    this.canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault(); // requests that the context is restored
      this.#painter = null;
      this.onError(this.text.contextLost);
    }, { signal });
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.onError(null);
      this.#start();
    }, { signal });
  }

  /** Creates the painter, and gives it everything to show. */
  #start() {
    const { canvas, gl, text } = this;
    if (!gl) {
      this.#painter = new PlainPainter(canvas, text, () => this.#redraw());
      return;
    }
    if (gl.isContextLost()) return; // webglcontextrestored will follow
    try {
      this.#painter = new GlPainter(canvas, gl);
    } catch (error) {
      this.onError(`${text.webglFailed} ${error instanceof Error ? error.message : error}`);
      return;
    }
    const { map, heights, colours } = this.#scene;
    this.#painter.setMap(map);
    this.#painter.setHeight(heights);
    this.#painter.setColours(colours);
    this.#redraw();
  }

  /** @param {Partial<Scene>} change */
  #change(change) {
    Object.assign(this.#scene, change);
    this.#redraw();
  }

  #redraw() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      this.#painter?.draw(this.#scene);
    });
  }
}
