/** Area tool: regions and the strokes of the direction brush. */

import { areaAt } from "../drawing/areas.js";
import { MOST_AREAS, anchorOf, withArea, withStructures } from "../drawing/document.js";
import { LIMITS } from "../drawing/limits.js";
import { meanNormal, normalAt } from "../drawing/normal.js";
import { makeRoom, rounded } from "../drawing/simplify.js";
import { say, text } from "../text/text.js";
import { nearest } from "./marks.js";

/** @typedef {import("./tools.js").Touch} Touch */

/** The normal of areas without a direction. @type {import("../drawing/document.js").Normal} */
const FRONT = [0, 0, 1];

/**
 * Region and brush: a region, which is circled or clicked between lines, is tilted rigidly; a brush stroke gets a direction, is
 * smoothed, or gets a structure.
 */
export class AreaTool {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {() => import("../result/predictor.js").Painted | null} map returns the latest map
   * @param {import("../elements/status.js").Announce} announce
   */
  constructor(editor, map, announce) {
    this.editor = editor;
    this.map = map;
    this.announce = announce;
    /** @type {number[] | null} */
    this.points = null;
    /** @type {number | undefined} */
    this.size = undefined;
    this.step = 0;
    /** Index of the area whose mark is pressed; -1 for none. */
    this.pressed = -1;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    this.pressed = nearest(editor.layer.areas.map(anchorOf), touch, touch.reach);
    if (this.pressed >= 0) return;
    if (editor.layer.areas.length >= MOST_AREAS) {
      this.announce(text.tooManyAreas, "warning");
      return;
    }
    this.points = [];
    this.size = editor.tool === "brush" ? editor.widths.brush : undefined;
    this.step = touch.reach / 5;
    this.move(touch);
  }

  /** @param {Touch} touch */
  move({ x, y }) {
    if (!this.points) return;
    const { points } = this;
    const [lastX, lastY] = points.slice(-2);
    const far = points.length < 2 || Math.hypot(x - lastX, y - lastY) > this.step;
    if (!far) return;
    makeRoom(points);
    points.push(rounded(x), rounded(y));
    this.editor.outline = { points, normal: FRONT, ...(this.size && { size: this.size }) };
    this.editor.mark();
  }

  up() {
    const { points, size, pressed } = this;
    this.cancel();
    if (pressed >= 0) this.editor.set({ area: pressed });
    if (!points) return;
    if (size) this.#brushed(points, size);
    else if (points.length >= 6) this.#region(points);
    else this.#clicked({ x: points[0], y: points[1] });
  }

  /**
   * Returns the area between lines that a click makes a region.
   * @param {{x: number, y: number}} at
   */
  areaAt({ x, y }) {
    const { doc, layer, outline } = this.editor;
    return outline ? null : areaAt(doc, layer, x, y);
  }

  /** Makes the area at a click a region, or selects the region that it is. @param {{x: number, y: number}} at */
  #clicked(at) {
    const area = this.areaAt(at);
    if (!area || area.open) {
      // Otherwise it is on a line.
      if (area || !this.editor.layer.strokes.length) this.announce(text.areaOpen, "warning");
      return;
    }
    const points = area.outline();
    const there = this.editor.layer.areas.findIndex((each) => !each.size && String(each.points) === String(points));
    if (there >= 0) this.editor.set({ area: there });
    else this.#region(points);
  }

  /** @param {number[]} points */
  #region(points) {
    this.#add({ points, normal: meanNormal(this.map(), points, this.editor.doc) });
  }

  /** Finishes a brush stroke. @param {number[]} points @param {number} size */
  #brushed(points, size) {
    const { editor } = this;
    const { doc, direction, structure, ownStructure: own } = editor;
    const { works, ...brush } = editor.brush;
    const stroke = { points, normal: FRONT, size, ...brush };
    if (works === "direction") {
      this.#add({ ...stroke, normal: direction ?? normalAt(this.map(), points[0] / doc.width, points[1] / doc.height) });
    } else if (works === "smooth") {
      // A smoothing stroke has no direction to set, so the next stroke can follow at once.
      editor.commit(withArea(doc, { ...stroke, smooths: true }));
    } else {
      const whole = withStructures(doc, structure.picture === own?.id && own ? [own] : []);
      if (whole) editor.commit(withArea(whole, { ...stroke, structure }));
      else this.announce(say("tooManyStructures", { most: LIMITS.structures }), "warning");
    }
  }

  /** Adds an area and selects it, so that it can be tilted. @param {import("../drawing/document.js").Area} area */
  #add(area) {
    const { editor } = this;
    const index = editor.layer.areas.length;
    editor.commit(withArea(editor.doc, area));
    editor.set({ area: index });
  }

  cancel() {
    this.points = null;
    this.pressed = -1;
    this.editor.outline = null;
    this.editor.mark();
  }
}
