/** Canvas: its context for drawing in two dimensions. */

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
 * Clears a canvas, so that it shows: a frame of nothing but clearing may never reach the screen in Chromium where the
 * canvas is drawn by the graphics card, and what was there before stays. One pixel, which nobody sees, makes it a drawing.
 * @param {CanvasRenderingContext2D} context without a transform
 */
export function clear(context) {
  const { width, height } = context.canvas;
  context.clearRect(0, 0, width, height);
  context.fillStyle = "rgb(128 128 128 / 0.5%)";
  context.fillRect(0, 0, 1, 1);
}
