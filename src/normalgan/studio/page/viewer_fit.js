/** Where a picture lies on a canvas: as large as fits, in the middle, on whole pixels. */

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

/** What lies behind a map: side in CSS pixels, grey and alpha of every other cell. */
export const CHECKER = { side: 8, grey: 127.5, alpha: 0.25 };
