/** Mask tool: mark object and holes. */

import { areaAt } from "../drawing/areas.js";
import { MOST_MASK_STROKES, withMaskStroke } from "../drawing/document.js";
import { makeRoom, rounded } from "../drawing/simplify.js";
import { text } from "../text/text.js";

/** @typedef {import("./tools.js").Touch} Touch */

/** Number of sample points along each side of the paper for deciding whether an area is object. */
const VOICES = 64;

/** Mask brush: adds to the object or cuts from it; in click mode, it flips an enclosed area between object and hole. */
export class MaskTool {
  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {() => import("../result/predictor.js").Painted | null} map returns the latest map
   * @param {import("../elements/status.js").Announce} announce
   */
  constructor(editor, map, announce) {
    this.editor = editor;
    this.map = map;
    this.announce = announce;
    this.step = 1;
    /** @type {Touch | null} the press on an area */
    this.pressed = null;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    if (editor.layer.mask.length >= MOST_MASK_STROKES) {
      this.announce(text.tooManyMaskStrokes, "warning");
      return;
    }
    if (editor.fills) {
      this.pressed = touch;
      return;
    }
    this.step = touch.reach / 5;
    editor.maskStroke = { adds: editor.adds, size: editor.widths.mask, points: [] };
    this.move(touch);
  }

  /** @param {Touch} touch */
  move({ x, y }) {
    const stroke = this.editor.maskStroke;
    if (!stroke) return;
    const [lastX, lastY] = stroke.points.slice(-2);
    if (stroke.points.length && Math.hypot(x - lastX, y - lastY) < this.step) return;
    makeRoom(stroke.points);
    stroke.points.push(rounded(x), rounded(y));
    this.editor.mark();
  }

  up() {
    const { pressed, editor: { maskStroke: stroke } } = this;
    this.cancel();
    if (pressed) this.#toggle(pressed);
    if (stroke) this.editor.commit(withMaskStroke(this.editor.doc, stroke));
  }

  cancel() {
    this.pressed = null;
    this.editor.maskStroke = null;
    this.editor.mark();
  }

  /**
   * Returns the area at a point, and whether most of it is object; a click flips it.
   * @param {{x: number, y: number}} at
   * @returns {import("../drawing/areas.js").Vote | null}
   */
  voteAt({ x, y }) {
    const { doc, layer } = this.editor;
    const area = areaAt(doc, layer, x, y);
    return area && { area, object: this.#isObject(area, x, y) };
  }

  /** Flips an area between object and hole. @param {Touch} touch */
  #toggle({ x, y }) {
    const { editor } = this;
    const vote = this.voteAt({ x, y });
    if (!vote) return;
    if (vote.area.open) {
      this.announce(text.areaOpen, "warning");
      return;
    }
    const adds = !vote.object;
    editor.commit(withMaskStroke(editor.doc, { adds, size: 1, points: [rounded(x), rounded(y)], fills: true }));
    this.announce(adds ? text.areaObject : text.areaHole);
  }

  /**
   * Whether most of an area is object in the current map.
   * @param {import("../drawing/areas.js").Area} area @param {number} x @param {number} y of a point in it
   */
  #isObject(area, x, y) {
    const map = this.map();
    if (!map) return false;
    const { width, height } = this.editor.doc;
    /** @param {number} right @param {number} down */
    const voice = (right, down) => {
      const column = Math.min(map.width - 1, Math.floor((right / width) * map.width));
      const row = Math.min(map.height - 1, Math.floor((down / height) * map.height));
      return map.rgba[4 * (row * map.width + column) + 3] > 127 ? 1 : -1;
    };
    let sum = 0;
    for (let i = 0; i < VOICES; i++) {
      for (let j = 0; j < VOICES; j++) {
        const [right, down] = [((i + 0.5) / VOICES) * width, ((j + 0.5) / VOICES) * height];
        if (area.shows(right, down)) sum += voice(right, down);
      }
    }
    return (sum || voice(x, y)) > 0; // a narrow area may fall between all sample points
  }
}
