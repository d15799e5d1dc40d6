/** Fits a picture into a canvas: as large as possible, centred, on whole pixels. */

/**
 * @param {{width: number, height: number}} picture
 * @param {{width: number, height: number}} canvas
 * @returns {{x: number, y: number, width: number, height: number}} from the upper left corner of the canvas
 */
export function fitted(picture, canvas) {
  const scale = Math.min(canvas.width / picture.width, canvas.height / picture.height);
  const width = Math.max(1, Math.round(picture.width * scale));
  const height = Math.max(1, Math.round(picture.height * scale));
  return { x: (canvas.width - width) >> 1, y: (canvas.height - height) >> 1, width, height };
}

/**
 * Returns the way from a picture's shares, from its upper left corner, to pixels of a canvas: as the canvas's own
 * `transform` takes it.
 * @param {import("./viewer.js").Scene} scene
 * @param {import("./viewer.js").Picture} picture
 * @param {{width: number, height: number}} canvas
 * @returns {import("./viewer.js").Way}
 */
export function placeOf({ frame, ratio }, picture, canvas) {
  if (frame) return /** @type {import("./viewer.js").Way} */ (frame.transform.map((value) => value * ratio));
  const { x, y, width, height } = fitted(picture, canvas);
  return [width, 0, 0, height, x, y];
}

/** Returns the inverse transform, column by column as for shaders. @param {import("./viewer.js").Way} transform @returns {number[]} */
export function inverted([a, b, c, d, e, f]) {
  const determinant = a * d - b * c;
  return [
    d / determinant, -b / determinant, 0, -c / determinant, a / determinant, 0,
    (c * f - d * e) / determinant, (b * e - a * f) / determinant, 1,
  ];
}

/** The checker behind a map: side in CSS pixels, and grey and alpha of every other cell. */
export const CHECKER = { side: 8, grey: 127.5, alpha: 0.25 };
