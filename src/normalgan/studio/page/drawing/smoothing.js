/** Smoothing: the pen tip follows the pointer along its path, independently of the event rate. */

const LONGEST = 40;

/** A tip that lags behind the pointer by a length on the screen and arrives at the end. */
export class Smoother {
  /** @param {number} amount 0..1 @param {number} scale pixels of the screen for one of the drawing */
  constructor(amount, scale) {
    this.length = (amount * LONGEST) / scale;
    /** @type {{x: number, y: number, pressure: number} | null} */
    this.tip = null;
    /** @type {{x: number, y: number, pressure: number} | null} */
    this.target = null;
  }

  /**
   * Returns the new position of the tip for a position of the pointer.
   * @param {{x: number, y: number, pressure: number}} point
   */
  move(point) {
    if (!this.tip || !this.target) {
      this.tip = this.target = point;
      return point;
    }
    const way = Math.hypot(point.x - this.target.x, point.y - this.target.y);
    const share = this.length > 0 ? 1 - Math.exp(-way / this.length) : 1;
    const { tip } = this;
    /** @param {"x" | "y" | "pressure"} key */
    const mixed = (key) => tip[key] + (point[key] - tip[key]) * share;
    this.target = point;
    this.tip = { x: mixed("x"), y: mixed("y"), pressure: mixed("pressure") };
    return this.tip;
  }

  /** Returns the position of the pointer, where the tip ends so that outlines close. */
  end() {
    return this.target;
  }
}
