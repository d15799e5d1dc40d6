// The viewer: a normal map under a movable light, as matcap, cel-shaded, or as a relief to turn around.

import { createPlainPainter } from "./viewer_2d.js";
import { createGlPainter } from "./viewer_gl.js";
import { DEFAULT_LIGHT, FRONT, listen } from "./viewer_input.js";
import { normalised } from "./viewer_shading.js";

const CURSORS = { map: "default", relief: "grab" };
const VIEWS = new Set(["map", "lit", "matcap", "flat", "relief"]);

function checkSize(values, width, height, channels) {
  if (values.length !== width * height * channels) {
    throw new RangeError(`${values.length} values do not make ${width} × ${height} × ${channels}`);
  }
}

// The canvas must be sized by CSS. `text` has the sentences {reliefNeedsWebgl, contextLost, webglFailed};
// onError gets one of them, or null when all is well again; onMove gets {light} when the user moved it.
export function createViewer(canvas, { onError = () => {}, text, onMove = () => {} }) {
  const scene = { map: null, heights: null, view: "lit", light: DEFAULT_LIGHT, turn: { ...FRONT }, ratio: 1 };
  const gl = canvas.getContext("webgl2", { antialias: true, depth: true });
  const ending = new AbortController();
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
      painter = createPlainPainter(canvas, text);
      return;
    }
    if (gl.isContextLost()) return; // webglcontextrestored will come
    try {
      painter = createGlPainter(canvas, gl);
    } catch (error) {
      onError(`${text.webglFailed} ${error.message}`);
      return;
    }
    painter.setMap(scene.map);
    painter.setHeight(scene.heights);
    redraw();
  }

  function resize() {
    const box = canvas.getBoundingClientRect();
    scene.ratio = window.devicePixelRatio;
    const [width, height] = [box.width, box.height].map((side) => Math.max(1, Math.round(side * scene.ratio)));
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
  const moved = (what) => {
    redraw();
    if (what === "light") onMove({ light: [...scene.light] });
  };
  listen(canvas, scene, moved, signal);
  const observer = new ResizeObserver(resize);
  observer.observe(canvas);
  start();
  resize();

  return {
    available: gl !== null,
    setMap(rgba, width, height) {
      if (rgba) checkSize(rgba, width, height, 4);
      scene.map = rgba && { rgba, width, height };
      painter?.setMap(scene.map);
      redraw();
    },
    setHeight(heights, width, height) {
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
