/** Pixels: average a part of a fine canvas to the drawing's size. */

/** Number of rows read at once, because a whole large canvas would take too much memory. */
const ROWS = 64;

/**
 * Returns a box of a canvas with the mean of each square of its pixels.
 *
 * `getImageData` and not `convertToBlob`, which waits until the browser has nothing else to do.
 * @param {CanvasRenderingContext2D} context black or coloured ink on nothing
 * @param {[number, number, number, number]} box left, top, right, bottom in pixels of the drawing
 * @param {number} scale pixels of the canvas per pixel of the drawing, a whole number
 * @param {1 | 4} channels grey of black ink on white, or red, green, blue and opacity
 * @param {boolean} onPaper whether the ground under the ink is white instead of transparent
 * @returns {Uint8Array} row by row
 */
export function averaged(context, [left, top, right, bottom], scale, channels, onPaper) {
  const width = right - left;
  const bytes = new Uint8Array(Math.max(0, width * (bottom - top) * channels));
  if (!bytes.length) return bytes;
  for (let row = top; row < bottom; row += ROWS) {
    const rows = Math.min(ROWS, bottom - row);
    const { data } = context.getImageData(left * scale, row * scale, width * scale, rows * scale);
    const out = bytes.subarray((row - top) * width * channels);
    if (channels === 1) grey(data, out, width, rows, scale);
    else coloured(data, out, width, rows, scale, onPaper);
  }
  return bytes;
}

/**
 * @param {Uint8ClampedArray} data @param {Uint8Array} out
 * @param {number} width @param {number} rows @param {number} scale
 */
function grey(data, out, width, rows, scale) {
  const [line, area] = [4 * width * scale, scale * scale];
  let at = 0;
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < width; column++) {
      let sum = 0;
      const first = row * scale * line + column * scale * 4 + 3;
      for (let y = 0; y < scale; y++) {
        for (let x = 0, from = first + y * line; x < scale; x++, from += 4) sum += data[from];
      }
      out[at++] = 255 - Math.round(sum / area);
    }
  }
}

/**
 * @param {Uint8ClampedArray} data @param {Uint8Array} out
 * @param {number} width @param {number} rows @param {number} scale @param {boolean} onPaper
 */
function coloured(data, out, width, rows, scale, onPaper) {
  const [line, area] = [4 * width * scale, scale * scale];
  let at = 0;
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < width; column++, at += 4) {
      let [red, green, blue, opacity] = [0, 0, 0, 0];
      const first = row * scale * line + column * scale * 4;
      for (let y = 0; y < scale; y++) {
        for (let x = 0, from = first + y * line; x < scale; x++, from += 4) {
          const alpha = data[from + 3];
          red += data[from] * alpha;
          green += data[from + 1] * alpha;
          blue += data[from + 2] * alpha;
          opacity += alpha;
        }
      }
      // Colours of transparent pixels are ignored.
      const white = onPaper ? 255 * (255 * area - opacity) : 0;
      const share = onPaper ? 255 * area : Math.max(opacity, 1);
      out[at] = Math.round((red + white) / share);
      out[at + 1] = Math.round((green + white) / share);
      out[at + 2] = Math.round((blue + white) / share);
      out[at + 3] = onPaper ? 255 : Math.round(opacity / area);
    }
  }
}
