/** Camera: maps the drawing to a pane. Panes that share a view show the same part of the drawing at the same rotation. */

const LEAST = 0.05;
const MOST = 40;
const MARGIN = 24;

/** @typedef {{x: number, y: number}} Point @typedef {{width: number, height: number}} Size */

/** The view shared by all panes; emits `change`. */
export class View extends EventTarget {
  constructor() {
    super();
    /** Zoom relative to the scale at which the whole drawing fits. */
    this.zoom = 1;
    /** The point at the centre of the pane, as fractions of the drawing's sides. */
    this.x = 0.5;
    this.y = 0.5;
    /** Clockwise rotation of the drawing in radians. */
    this.angle = 0;
  }

  /** Shows the whole drawing, upright. */
  fit() {
    Object.assign(this, { zoom: 1, x: 0.5, y: 0.5, angle: 0 });
    this.changed();
  }

  /** Notifies all panes. */
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

  /** Pane pixels per drawing pixel at which the whole drawing fits. */
  get fitted() {
    const { pane, doc } = this;
    const margin = Math.min(MARGIN, pane.width / 20);
    return Math.max(1e-3, Math.min((pane.width - 2 * margin) / doc.width, (pane.height - 2 * margin) / doc.height));
  }

  /** Pane pixels per drawing pixel. */
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

  /** Rotates the drawing around a point of the pane. @param {number} x @param {number} y @param {number} by radians */
  turn(x, y, by) {
    const held = this.toDrawing(x, y);
    const angle = this.view.angle + by;
    this.view.angle = Math.atan2(Math.sin(angle), Math.cos(angle));
    this.#hold(held, x, y);
  }

  /** Converts a point of the pane to the drawing. @param {number} x @param {number} y @returns {Point} */
  toDrawing(x, y) {
    const [a, b, c, d, e, f] = this.transform();
    const [dx, dy] = [x - e, y - f];
    const determinant = a * d - b * c;
    return { x: (d * dx - c * dy) / determinant, y: (a * dy - b * dx) / determinant };
  }

  /** Converts a point of the drawing to the pane. @param {number} x @param {number} y @returns {Point} */
  toPane(x, y) {
    const [a, b, c, d, e, f] = this.transform();
    return { x: a * x + c * y + e, y: b * x + d * y + f };
  }

  /**
   * Returns the transform from the drawing to the pane, as a canvas takes it.
   * @param {number} [ratio] canvas pixels per pane pixel
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

  /** Moves the view so that a point of the drawing is at the given point of the pane. @param {Point} held @param {number} x @param {number} y */
  #hold(held, x, y) {
    const at = this.toDrawing(x, y);
    this.view.x += (held.x - at.x) / this.doc.width;
    this.view.y += (held.y - at.y) / this.doc.height;
    this.view.changed();
  }
}
