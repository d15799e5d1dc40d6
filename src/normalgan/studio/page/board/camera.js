/** Camera: where the drawing lies in a pane. Panes that share a view show the same part of it, turned alike. */

const LEAST = 0.05;
const MOST = 40;
const MARGIN = 24;

/** @typedef {{x: number, y: number}} Point @typedef {{width: number, height: number}} Size */

/** What all panes show; event `change`. */
export class View extends EventTarget {
  constructor() {
    super();
    /** How much larger than when all of the drawing fits. */
    this.zoom = 1;
    /** The point in the middle of the pane, as shares of the drawing's sides. */
    this.x = 0.5;
    this.y = 0.5;
    /** How far the drawing is turned, clockwise, in radians. */
    this.angle = 0;
  }

  /** Shows all of the drawing, upright. */
  fit() {
    Object.assign(this, { zoom: 1, x: 0.5, y: 0.5, angle: 0 });
    this.changed();
  }

  /** Tells all panes. */
  changed() {
    this.dispatchEvent(new Event("change"));
  }
}

export class Camera {
  /** @param {View} view */
  constructor(view) {
    this.view = view;
    /** @type {Size} */
    this.pane = { width: 1, height: 1 };
    /** @type {Size} */
    this.doc = { width: 1, height: 1 };
  }

  /** Pixels of the pane for one of the drawing where all of it fits. */
  get fitted() {
    const { pane, doc } = this;
    const margin = Math.min(MARGIN, pane.width / 20);
    return Math.max(1e-3, Math.min((pane.width - 2 * margin) / doc.width, (pane.height - 2 * margin) / doc.height));
  }

  /** Pixels of the pane for one of the drawing. */
  get scale() {
    return this.fitted * this.view.zoom;
  }

  /** Zooms around a point of the pane. @param {number} x @param {number} y @param {number} factor */
  zoom(x, y, factor) {
    const held = this.toDrawing(x, y);
    this.view.zoom = Math.max(LEAST, Math.min(MOST, this.scale * factor)) / this.fitted;
    this.#hold(held, x, y);
  }

  /** Moves the drawing. @param {number} dx @param {number} dy in pixels of the pane */
  pan(dx, dy) {
    const { width, height } = this.pane;
    this.#hold(this.toDrawing(width / 2 - dx, height / 2 - dy), width / 2, height / 2);
  }

  /** Turns the drawing around a point of the pane. @param {number} x @param {number} y @param {number} by radians */
  turn(x, y, by) {
    const held = this.toDrawing(x, y);
    const angle = this.view.angle + by;
    this.view.angle = Math.atan2(Math.sin(angle), Math.cos(angle));
    this.#hold(held, x, y);
  }

  /** Returns where a point of the pane lies in the drawing. @param {number} x @param {number} y @returns {Point} */
  toDrawing(x, y) {
    const [a, b, c, d, e, f] = this.transform();
    const [dx, dy] = [x - e, y - f];
    const determinant = a * d - b * c;
    return { x: (d * dx - c * dy) / determinant, y: (a * dy - b * dx) / determinant };
  }

  /** Returns where a point of the drawing lies in the pane. @param {number} x @param {number} y @returns {Point} */
  toPane(x, y) {
    const [a, b, c, d, e, f] = this.transform();
    return { x: a * x + c * y + e, y: b * x + d * y + f };
  }

  /**
   * Returns the way from the drawing to the pane as a canvas takes it.
   * @param {number} [ratio] pixels of the canvas for one of the pane
   * @returns {[number, number, number, number, number, number]}
   */
  transform(ratio = 1) {
    const { view, pane, doc } = this;
    const [cos, sin] = [Math.cos(view.angle), Math.sin(view.angle)].map((value) => value * this.scale * ratio);
    const [x, y] = [view.x * doc.width, view.y * doc.height];
    return [
      cos, sin, -sin, cos, (ratio * pane.width) / 2 - cos * x + sin * y, (ratio * pane.height) / 2 - sin * x - cos * y,
    ];
  }

  /** Brings a point of the drawing to where it was in the pane. @param {Point} held @param {number} x @param {number} y */
  #hold(held, x, y) {
    const at = this.toDrawing(x, y);
    this.view.x += (held.x - at.x) / this.doc.width;
    this.view.y += (held.y - at.y) / this.doc.height;
    this.view.changed();
  }
}
