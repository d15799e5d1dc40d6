/** Camera: where the drawing lies in its pane. */

const LEAST = 0.05;
const MOST = 40;
const MARGIN = 24;

export class Camera {
  constructor() {
    this.scale = 1;
    this.x = 0;
    this.y = 0;
    /** Whether it follows the size of the pane, until it is moved by hand. */
    this.fitted = true;
  }

  /** Shows all of a drawing. @param {{width: number, height: number}} pane @param {{width: number, height: number}} doc */
  fit(pane, doc) {
    const margin = Math.min(MARGIN, pane.width / 20);
    this.scale = Math.max(LEAST, Math.min((pane.width - 2 * margin) / doc.width, (pane.height - 2 * margin) / doc.height));
    this.x = (pane.width - doc.width * this.scale) / 2;
    this.y = (pane.height - doc.height * this.scale) / 2;
    this.fitted = true;
  }

  /** Zooms around a point of the pane. @param {number} x @param {number} y @param {number} factor */
  zoom(x, y, factor) {
    const scale = Math.max(LEAST, Math.min(MOST, this.scale * factor));
    this.x = x - ((x - this.x) * scale) / this.scale;
    this.y = y - ((y - this.y) * scale) / this.scale;
    this.scale = scale;
    this.fitted = false;
  }

  /** @param {number} dx @param {number} dy in pixels of the pane */
  pan(dx, dy) {
    this.x += dx;
    this.y += dy;
    this.fitted = false;
  }

  /** Returns where a point of the pane lies in the drawing. @param {number} x @param {number} y */
  toDrawing(x, y) {
    return { x: (x - this.x) / this.scale, y: (y - this.y) / this.scale };
  }

  /** Returns where a point of the drawing lies in the pane. @param {number} x @param {number} y */
  toPane(x, y) {
    return { x: x * this.scale + this.x, y: y * this.scale + this.y };
  }
}
