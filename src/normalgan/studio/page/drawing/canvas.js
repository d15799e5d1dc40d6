/** Canvas: 2D contexts. */

/**
 * Returns the context of a canvas; every browser that runs the page has it.
 * @param {HTMLCanvasElement} canvas
 * @param {CanvasRenderingContext2DSettings} [settings]
 * @returns {CanvasRenderingContext2D}
 */
export function context2d(canvas, settings) {
  const context = canvas.getContext("2d", settings);
  if (!context) throw new Error("this browser draws no canvas");
  return context;
}

/**
 * Clears a canvas. In Chromium with GPU canvases, a frame that only clears may never reach the screen, so an invisible
 * pixel is drawn as well.
 * @param {CanvasRenderingContext2D} context without a transform
 */
export function clear(context) {
  const { width, height } = context.canvas;
  context.clearRect(0, 0, width, height);
  context.fillStyle = "rgb(128 128 128 / 0.5%)";
  context.fillRect(0, 0, 1, 1);
}
