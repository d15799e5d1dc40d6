/** Fill tool: a click fills the area between lines with a colour. */

import { areaAt } from "../drawing/areas.js";
import { MOST_STROKES, withActive } from "../drawing/document.js";
import { isInFill } from "../drawing/strokes.js";
import { text } from "../text/text.js";

/** @typedef {import("./tools.js").Touch} Touch @typedef {import("../drawing/document.js").Line} Line */

/** Pressure of a fill's points, which have no width. */
const PRESSURE = 0.5;

/** Fill: an area that is clicked again takes another colour, or none if it has that colour. */
export class FillTool {
  /** @param {import("../drawing/editor.js").Editor} editor @param {import("../elements/status.js").Announce} announce */
  constructor(editor, announce) {
    this.editor = editor;
    this.announce = announce;
    /** @type {Touch | null} */
    this.pressed = null;
  }

  /** @param {Touch} touch */
  down(touch) {
    this.pressed = touch;
  }

  move() {}

  up() {
    const { pressed } = this;
    this.cancel();
    if (pressed) this.#fill(pressed);
  }

  cancel() {
    this.pressed = null;
  }

  /** Returns the area that a click fills. @param {{x: number, y: number}} at */
  areaAt({ x, y }) {
    const { doc, layer } = this.editor;
    return areaAt(doc, layer, x, y);
  }

  /** @param {{x: number, y: number}} at */
  #fill(at) {
    const { editor } = this;
    const area = this.areaAt(at);
    const points = area && !area.open ? area.filling().flatMap(({ x, y }) => [x, y, PRESSURE]) : null;
    const { strokes } = editor.layer;
    // Without its outline, an area is still found by its colour.
    const there = strokes.findLastIndex((stroke) => stroke.kind === "fill" && (points ? String(stroke.points) === String(points) : isInFill(stroke, at)));
    if (there < 0 && !points) {
      if (area || !strokes.length) this.announce(text.areaOpen, "warning");
      return;
    }
    if (there < 0 && strokes.length >= MOST_STROKES) {
      this.announce(text.tooManyStrokes, "warning");
      return;
    }
    const before = /** @type {Line | undefined} */ (strokes[there]);
    const others = strokes.filter((each) => each !== before);
    const { fillColour: colour } = editor;
    const filled = before?.colour === colour ? others : [...others, { kind: /** @type {const} */ ("fill"), size: 1, colour, points: before?.points ?? points ?? [] }];
    editor.commit(withActive(editor.doc, { strokes: filled }));
    this.announce(filled.length > others.length ? text.filled : text.unfilled);
  }
}
