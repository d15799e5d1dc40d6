/** The viewer: a normal map under a movable light, as matcap, in flat paints, or as a relief to turn. */

import { createPlainPainter, shadedPixels } from "./viewer_2d.js";
import { createGlPainter } from "./viewer_gl.js";
import { DEFAULT_LIGHT, FRONT, listen } from "./viewer_input.js";
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

/** @typedef {[number, number, number, number, number, number]} Way as a canvas takes a transform */
/** @typedef {"map" | "lit" | "matcap" | "flat" | "relief"} View */
/** @typedef {{rgba: Uint8Array, width: number, height: number}} Picture */
/** @typedef {{heights: Float32Array, width: number, height: number}} Heights in pixels, NaN off the object */
/**
 * @typedef {{map: Picture | null, heights: Heights | null, view: View, light: number[],
 *   turn: {yaw: number, pitch: number, zoom: number}, ratio: number, frame: Frame | null, colour: number[],
 *   second: Lamp | null, falloff: number, colours: Picture | null, tiled: boolean, pixelated: boolean}} Scene what is to be shown; falloff: 0 to 1; colours: of
 *   the surface, which is clay without them
 */
/**
 * @typedef {object} ScenePainter draws the scene, by WebGL or without
 * @property {(map: Picture | null) => void} setMap
 * @property {(colours: Picture | null) => void} setColours
 * @property {(heights: Heights | null) => void} setHeight
 * @property {(scene: Scene) => void} draw
 * @property {() => void} dispose
 */
/**
 * @typedef {{transform: Way, angle: number}} Frame where the map lies: from its shares to pixels of the page, and
 *   how far it is turned
 * @typedef {{direction: number[], colour: number[]}} Lamp direction towards it; colour: linear red, green, blue
 * @typedef {object} Viewer
 * @property {boolean} available whether there is WebGL; without it, CPU draws all but the relief
 * @property {(rgba: Uint8Array | null, width?: number, height?: number) => void} setMap
 *   colours of normals, OpenGL green, row by row from the top; alpha is the object
 * @property {(heights: Float32Array | null, width?: number, height?: number) => void} setHeight
 *   in pixels towards the viewer, row by row from the top, NaN off the object
 * @property {(view: View) => void} setView
 * @property {(light: number[]) => void} setLight towards the light: x right, y up, z to the viewer
 * @property {(frame: Frame | null) => void} setFrame where the map lies; null fits it into the canvas
 * @property {number[]} light towards the light
 * @property {(x: number, y: number) => number[]} lightAt towards a light over a point of the canvas, in pixels of the page
 * @property {(first: Lamp, second: Lamp | null, falloff?: number) => void} setLights colours show in the views Lit and Relief
 * @property {(picture: Picture | null) => void} setColours of the surface in these views; null is clay
 * @property {(look: {tiled: boolean, pixelated: boolean}) => void} setLook whether a flat view repeats the map, three by three, and
 *   whether it shows its pixels
 * @property {(map: Picture, colours: Picture | null) => Uint8ClampedArray<ArrayBuffer>} shaded RGBA of a map as it is seen now, of any
 *   size; in the views of the map and the relief as lit
 * @property {() => void} resize
 * @property {() => void} dispose
 */

/**
 * Returns a viewer on a canvas, which must be sized by CSS.
 * @param {HTMLCanvasElement} canvas
 * @param {object} options
 * @param {{reliefNeedsWebgl: string, contextLost: string, webglFailed: string}} options.text sentences
 * @param {(sentence: string | null) => void} [options.onError] gets one of them, or null: all is well again
 * @param {(move: {light: number[]}) => void} [options.onMove] is told where the user moved the light
 * @returns {Viewer}
 */
export function createViewer(canvas, { onError = () => {}, text, onMove = () => {} }) {
/** @type {Scene} */
  const scene = { map: null, heights: null, view: "lit", light: DEFAULT_LIGHT, turn: { ...FRONT }, ratio: 1, frame: null, colour: WHITE, second: null, falloff: 0, colours: null, tiled: false, pixelated: false };
  const gl = canvas.getContext("webgl2", { antialias: true, depth: true });
  const ending = new AbortController();
  /** @type {ScenePainter | null} */
  let painter = null;
  let frame = 0;

  function redraw() {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      painter?.draw(scene);
    });
  }

  function start() {
    if (!gl) {
      painter = createPlainPainter(canvas, text, redraw);
      return;
    }
    if (gl.isContextLost()) return; // webglcontextrestored will come
    try {
      painter = createGlPainter(canvas, gl);
    } catch (error) {
      onError(`${text.webglFailed} ${error instanceof Error ? error.message : error}`);
      return;
    }
    painter.setMap(scene.map);
    painter.setHeight(scene.heights);
    painter.setColours(scene.colours);
    redraw();
  }

  function resize() {
    const box = canvas.getBoundingClientRect();
    scene.ratio = window.devicePixelRatio;
    /** @param {number} side */
    const pixels = (side) => Math.max(1, Math.round(side * scene.ratio));
    const [width, height] = [pixels(box.width), pixels(box.height)];
    if (canvas.width === width && canvas.height === height) return;
    [canvas.width, canvas.height] = [width, height];
    // Setting a size empties the canvas: draw at once, or it would flicker.
    painter?.draw(scene);
  }

  canvas.tabIndex = 0;
  canvas.style.touchAction = "none"; // a finger moves the light, not the page
  const { signal } = ending;
  canvas.addEventListener(
    "webglcontextlost",
    (event) => {
      event.preventDefault(); // asks for the context back
      painter = null;
      onError(text.contextLost);
    },
    { signal },
  );
  canvas.addEventListener(
    "webglcontextrestored",
    () => {
      onError(null);
      start();
    },
    { signal },
  );
  /** @param {"light" | "turn"} what */
  const moved = (what) => {
    redraw();
    if (what === "light") onMove({ light: [...scene.light] });
  };
  const lightAt = listen(canvas, scene, moved, signal);
  const observer = new ResizeObserver(resize);
  observer.observe(canvas);
  start();
  resize();

  return {
    available: gl !== null,
    setMap(rgba, width = 0, height = 0) {
      if (rgba) checkSize(rgba, width, height, 4);
      scene.map = rgba && { rgba, width, height };
      painter?.setMap(scene.map);
      redraw();
    },
    setHeight(heights, width = 0, height = 0) {
      if (heights) checkSize(heights, width, height, 1);
      scene.heights = heights && { heights, width, height };
      painter?.setHeight(scene.heights);
      redraw();
    },
    setView(view) {
      if (!VIEWS.has(view)) throw new RangeError(`no view is called ${view}`);
      if (!gl && view === "relief") onError(text.reliefNeedsWebgl);
      if (!gl && scene.view === "relief" && view !== "relief") onError(null);
      scene.view = view;
      canvas.style.cursor = CURSORS[view] ?? "crosshair";
      redraw();
    },
    setLight(light) {
      scene.light = normalised(light);
      redraw();
    },
    setFrame(frame) {
      scene.frame = frame;
      redraw();
    },
    get light() {
      return scene.light;
    },
    lightAt,
    setColours(picture) {
      scene.colours = picture;
      painter?.setColours(picture);
      redraw();
    },
    setLook(look) {
      Object.assign(scene, look);
      redraw();
    },
    shaded(map, colours) {
      const { view } = scene;
      return shadedPixels(map, view === "matcap" || view === "flat" ? view : "lit", { ...scene, colours });
    },
    setLights(first, second, falloff = 0) {
      scene.falloff = falloff;
      scene.light = normalised(first.direction);
      scene.colour = first.colour;
      scene.second = second && { ...second, direction: normalised(second.direction) };
      redraw();
    },
    resize,
    dispose() {
      ending.abort();
      observer.disconnect();
      cancelAnimationFrame(frame);
      painter?.dispose();
      painter = null;
    },
  };
}
