/** Tools: what a gesture does, whether it comes from a pointer or from the keyboard. */

import { Areas, layerAt } from "./areas.js";
import { MOST_AREAS, MOST_HINTS, MOST_MASK_STROKES, MOST_STROKES, activeLayer, anchorOf, changedHint, knobOf, middleOfPixel, mostReach, withArea, withHint, withMaskStroke, withStroke, withStructures } from "./document.js";
import { LIMITS } from "./limits.js";
import { nearest } from "./marks.js";
import { meanNormal, normalAt } from "./normal.js";
import { quickShape } from "./quick_shape.js";
import { makeRoom } from "./simplify.js";
import { Smoother } from "./smoothing.js";
import { say, text } from "./text.js";

/**
 * @typedef {{x: number, y: number, pressure: number, reach: number, scale: number,
 *   pane?: {x: number, y: number}, straight?: boolean, eraser?: boolean}} Touch in the drawing; reach: what counts as hit; scale: pixels of
 *   the pane for one of the drawing; pane: where it is in the pane; straight: whether a straight line is wanted, or more
 *   to be chosen; eraser: whether it is the pen's other end
 */

/**
 * @typedef {object} Tool what works on the board from the pointer's or the keyboard's press to its end
 * @property {(touch: Touch) => void} down
 * @property {(touch: Touch) => void} move
 * @property {() => void} up
 * @property {() => void} cancel
 */

/** Radians within which a straight line is level, upright or diagonal. */
const SNAP = 0.06;
const ALL = { left: -Infinity, top: -Infinity, right: Infinity, bottom: Infinity };
/** Places that are asked along each side of the paper whether they are object. */
const VOICES = 64;
/** @param {number} value */
const round = (value) => Math.round(value * 100) / 100;

/** Milliseconds that a pen is held still at the end of a stroke to make a shape of it; pixels of the pane that it may stir; and that the stroke goes at least. */
const [HELD, STIRRED, LEAST_WAY] = [600, 4, 30];
/** A hand that tests lead pauses wherever the machine is busy, so they set a longer time. */
const heldFor = () => Number(document.documentElement.dataset.held ?? HELD);

/** Pen and eraser: a stroke from down to up. */
export class LineTool {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {import("./ink.js").Inks} inks
   * @param {import("./status.js").Announce} announce
   */
  constructor(editor, inks, announce) {
    this.editor = editor;
    this.inks = inks;
    this.announce = announce;
    /** @type {Touch | null} where the pen is held still, maybe */
    this.rest = null;
    this.waiting = 0;
    /** @type {import("./document.js").Line | null} the stroke as it was drawn, if a shape was made of it */
    this.raw = null;
    /** @type {import("./document.js").Line | null} */
    this.line = null;
    /** @type {Touch | null} where a straight line begins */
    this.start = null;
    this.smoother = new Smoother(0, 1);
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    const kind = editor.tool === "eraser" || touch.eraser ? "eraser" : "pen";
    const { colour, symmetry, doc } = editor;
    const carve = kind === "pen" ? editor.carves * editor.carveHeight : 0;
    if (editor.layer.strokes.length >= MOST_STROKES) {
      this.announce(text.tooManyStrokes, "warning");
      return;
    }
    this.line = {
      kind, size: editor.widths[kind], points: [], ...(kind === "pen" && colour !== "#000000" && { colour }), ...(carve && { carve }),
      ...(symmetry && { mirror: doc.width / 2 }),
    };
    this.start = editor.straight || touch.straight ? touch : null;
    this.rest = this.raw = null;
    this.smoother = new Smoother(editor.smoothing, touch.scale);
    this.move(touch);
  }

  /** @param {Touch} touch */
  move(touch) {
    if (!this.line) return;
    if (this.start) {
      this.#straight(touch);
      return;
    }
    if (this.raw) {
      if (!this.rest || Math.hypot(touch.x - this.rest.x, touch.y - this.rest.y) * touch.scale < LEAST_WAY) return;
      this.#goOn(touch);
    }
    this.#wait(touch);
    this.#add(this.smoother.move(touch));
    this.editor.draw(this.inks.of(this.editor.layer).draw(this.line, false));
  }

  up() {
    if (!this.line) return;
    const { line, raw, editor } = this;
    clearTimeout(this.waiting);
    if (!this.start && !raw) this.#add(this.smoother.end());
    this.line = this.raw = null;
    editor.guide = null;
    if (raw) {
      // Undo leads back to the stroke as it was drawn.
      const before = editor.doc;
      editor.commit(withStroke(before, raw));
      editor.commit(withStroke(before, line));
      this.announce(text.shaped); // still so, now that it is done
      return;
    }
    editor.draw(this.inks.of(editor.layer).draw(line, true), true);
    editor.commit(withStroke(editor.doc, line));
  }

  cancel() {
    if (!this.line) return;
    clearTimeout(this.waiting);
    this.line = this.raw = null;
    this.editor.guide = null;
    this.inks.sync(this.editor.doc);
    this.editor.draw(ALL, true);
    this.editor.drop();
  }

  /** Waits whether the pen is held still; keys, which have no place in the pane, pause for other reasons. @param {Touch} touch */
  #wait(touch) {
    if (!touch.pane || this.line?.kind !== "pen") return;
    if (this.rest && Math.hypot(touch.x - this.rest.x, touch.y - this.rest.y) * touch.scale < STIRRED) return;
    this.rest = touch;
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      // A busy page learns with the next frame that the hand has moved on meanwhile.
      requestAnimationFrame(() => this.rest === touch && this.#shape(touch));
    }, heldFor());
  }

  /** Brings the stroke back as it was drawn: it was a pause, and not its end. @param {Touch} touch */
  #goOn({ scale }) {
    const { raw, editor, inks } = this;
    if (!raw) return;
    [this.line, this.raw, editor.guide] = [raw, null, null];
    const [x, y, pressure] = raw.points.slice(-3);
    this.smoother = new Smoother(editor.smoothing, scale);
    this.smoother.move({ x, y, pressure });
    inks.sync(editor.doc);
    editor.draw(ALL, true);
  }

  /** Makes a shape of the stroke, if it means one. @param {Touch} touch */
  #shape(touch) {
    const { line, editor, inks } = this;
    const { scale } = touch;
    if (!line) return;
    const end = this.smoother.end();
    const points = [...line.points, ...(end ? [end.x, end.y, end.pressure] : [])];
    const places = Array.from({ length: points.length / 3 }, (_, i) => ({ x: points[3 * i], y: points[3 * i + 1] }));
    const way = places.slice(1).reduce((sum, { x, y }, i) => sum + Math.hypot(x - places[i].x, y - places[i].y), 0);
    const shape = way * scale < LEAST_WAY ? null : quickShape(places);
    if (!shape) return;
    this.raw = { ...line, points };
    const pressure = round(points.reduce((sum, value, i) => (i % 3 === 2 ? sum + value : sum), 0) / places.length);
    // A corner that is there twice is sharp: between points a line is curved.
    this.line = { ...line, points: shape.points.flatMap(({ x, y }) => Array.from({ length: shape.sharp ? 2 : 1 }, () => [round(x), round(y), pressure]).flat()) };
    // Its end may still be moved.
    if (shape.points.length === 2) this.start = { ...touch, ...shape.points[0] };
    inks.sync(editor.doc); // without the stroke
    editor.draw(ALL, true);
    editor.guide = this.line;
    editor.mark();
    this.announce(text.shaped);
  }

  /** Shows a straight line to where the pointer is; near a level, an upright or a diagonal it is exactly that. @param {Touch} touch */
  #straight(touch) {
    const { line, start, editor } = this;
    if (!line || !start) return;
    let [dx, dy] = [touch.x - start.x, touch.y - start.y];
    const [length, angle] = [Math.hypot(dx, dy), Math.atan2(dy, dx)];
    const exact = Math.round(angle / (Math.PI / 4)) * (Math.PI / 4);
    if (Math.abs(angle - exact) < SNAP) [dx, dy] = [length * Math.cos(exact), length * Math.sin(exact)];
    line.points = [round(start.x), round(start.y), 0.5];
    if (length > 0) line.points.push(round(start.x + dx), round(start.y + dy), 0.5);
    editor.guide = line;
    editor.mark();
  }

  /** @param {{x: number, y: number, pressure: number} | null} at */
  #add(at) {
    if (!at || !this.line) return;
    const point = [round(at.x), round(at.y), round(at.pressure)];
    const last = this.line.points.slice(-3);
    if (point.some((value, i) => value !== last[i])) this.line.points.push(...point);
  }
}

/** Points: a click pins or chooses one, dragging moves it. Not before its end: the press may be the first of two fingers. */
export class HintTool {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {() => import("./predictor.js").Painted | null} map what was painted last
   * @param {import("./status.js").Announce} announce
   */
  constructor(editor, map, announce) {
    this.editor = editor;
    this.map = map;
    this.announce = announce;
    /** @type {{index: number, dx: number, dy: number, from: Touch, moved: boolean, ring: boolean} | null} ring: its reach is changed */
    this.held = null;
    /** @type {Touch | null} where no point was when it was pressed */
    this.pressed = null;
  }

  /** @param {Touch} touch */
  down(touch) {
    const { editor } = this;
    const { doc, layer } = editor;
    const chosen = layer.hints[editor.chosen];
    const ring = chosen !== undefined && nearest([knobOf(chosen, doc, touch.scale)], touch, touch.reach) === 0;
    const index = ring ? editor.chosen : nearest(layer.hints, touch, touch.reach);
    this.pressed = index < 0 ? touch : null;
    if (index < 0) return;
    const { x, y } = layer.hints[index];
    this.held = { index, dx: x - touch.x, dy: y - touch.y, from: touch, moved: false, ring };
  }

  /** Takes the suggestion at a touch, or pins a point there. @param {Touch} touch */
  #press(touch) {
    const { editor } = this;
    const { doc, layer } = editor;
    const suggestion = nearest(editor.suggestions, touch, touch.reach);
    if (suggestion >= 0) {
      this.accept(suggestion);
      return;
    }
    // A direction is of the part that is seen there, whichever layer is worked on.
    const front = layerAt(doc, touch);
    const other = front !== null && front.id !== layer.id;
    if (other) editor.work(front.id);
    const index = nearest(editor.layer.hints, touch, touch.reach);
    if (index >= 0) editor.set({ chosen: index });
    else this.add(touch, normalAt(this.map(), touch.x / doc.width, touch.y / doc.height));
    if (other) this.announce(say("layerWorked", { name: front.name }));
  }

  /** @param {Touch} touch */
  move(touch) {
    const { held, editor } = this;
    if (!held) return;
    held.moved ||= Math.hypot(touch.x - held.from.x, touch.y - held.from.y) > touch.reach / 4;
    if (!held.moved) return;
    if (editor.chosen !== held.index) editor.set({ chosen: held.index });
    const { state } = editor.history;
    const { x, y } = activeLayer(state).hints[held.index];
    const change = held.ring
      ? { reach: Math.round(Math.min(mostReach(state), Math.hypot(touch.x - x, touch.y - y))) }
      : middleOfPixel({ x: touch.x + held.dx, y: touch.y + held.dy }, editor.doc);
    editor.preview(changedHint(state, held.index, change));
  }

  up() {
    const { held, pressed, editor } = this;
    this.held = this.pressed = null;
    if (held) editor.set({ chosen: held.index });
    if (held?.moved) editor.commit(editor.doc);
    if (pressed) this.#press(pressed);
  }

  cancel() {
    this.held = this.pressed = null;
    this.editor.drop();
  }

  /** Takes a suggestion as a point. @param {number} index */
  accept(index) {
    const { editor } = this;
    const { normal, ...at } = editor.suggestions[index];
    if (this.add(at, normal)) editor.set({ suggestions: editor.suggestions.filter((_, i) => i !== index) });
  }

  /**
   * Pins a point.
   * @param {{x: number, y: number}} at @param {import("./document.js").Normal} normal
   * @returns {boolean} whether there was room for it
   */
  add(at, normal) {
    const { editor } = this;
    const { doc: { width, height }, layer: { hints } } = editor;
    if (at.x < 0 || at.y < 0 || at.x >= width || at.y >= height) return false;
    if (hints.length >= MOST_HINTS) {
      this.announce(text.tooMany, "warning");
      return false;
    }
    editor.commit(withHint(editor.doc, { ...middleOfPixel(at, editor.doc), normal }));
    editor.set({ chosen: hints.length });
    return true;
  }
}

/** Region and brush: what is circled is turned as a whole, what is brushed gets a direction, which the ball tells, is smoothed, or gets a structure. */
export class AreaTool {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {() => import("./predictor.js").Painted | null} map what was painted last
   * @param {import("./status.js").Announce} announce
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
    /** Index of the area whose mark is pressed, -1 is none. */
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
    points.push(round(x), round(y));
    this.editor.outline = { points, normal: [0, 0, 1], ...(this.size && { size: this.size }) };
    this.editor.mark();
  }

  up() {
    const { points, size, pressed } = this;
    this.cancel();
    if (pressed >= 0) this.editor.set({ area: pressed });
    if (!points || (!size && points.length < 6)) return;
    const { editor } = this;
    const { doc, layer } = editor;
    const { works, ...brush } = editor.brush;
    if (size && works === "smooth") {
      // There is nothing to be turned: the next stroke may follow at once.
      editor.commit(withArea(doc, { points, normal: [0, 0, 1], size, ...brush, smooths: true }));
      return;
    }
    if (size && works === "structure") {
      const { structure, ownStructure: own } = editor;
      const whole = withStructures(doc, structure.picture === own?.id && own ? [own] : []);
      if (!whole) {
        this.announce(say("tooManyStructures", { most: LIMITS.structures }), "warning");
        return;
      }
      editor.commit(withArea(whole, { points, normal: [0, 0, 1], size, ...brush, structure }));
      return;
    }
    const normal = size
      ? editor.direction ?? normalAt(this.map(), points[0] / doc.width, points[1] / doc.height)
      : meanNormal(this.map(), points, doc);
    editor.commit(withArea(doc, { points, normal, ...(size && { size, ...brush }) }));
    editor.set({ area: layer.areas.length });
  }

  cancel() {
    this.points = null;
    this.pressed = -1;
    this.editor.outline = null;
    this.editor.mark();
  }
}

/** Mask brush: adds to the object or cuts from it; or a click makes an area between lines object or hole. */
export class MaskTool {
  /**
   * @param {import("./editor.js").Editor} editor
   * @param {() => import("./predictor.js").Painted | null} map what was painted last
   * @param {import("./status.js").Announce} announce
   */
  constructor(editor, map, announce) {
    this.editor = editor;
    this.map = map;
    this.areas = new Areas();
    this.announce = announce;
    this.step = 1;
    /** @type {Touch | null} where an area is clicked */
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
    stroke.points.push(round(x), round(y));
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
   * Returns the area about a point, and whether most of it is object: a click turns that over.
   * @param {{x: number, y: number}} at
   * @returns {import("./areas.js").Vote | null}
   */
  voteAt({ x, y }) {
    const { doc, layer } = this.editor;
    const area = this.areas.at(doc, layer, x, y);
    return area && { area, object: this.#isObject(area, x, y) };
  }

  /** Makes an area object, or a hole if it was one. @param {Touch} touch */
  #toggle({ x, y }) {
    const { editor } = this;
    const vote = this.voteAt({ x, y });
    if (!vote) return;
    if (vote.area.open) {
      this.announce(text.areaOpen, "warning");
      return;
    }
    const adds = !vote.object;
    editor.commit(withMaskStroke(editor.doc, { adds, size: 1, points: [round(x), round(y)], fills: true }));
    this.announce(adds ? text.areaObject : text.areaHole);
  }

  /**
   * Whether the map on show has more of an area as object than not.
   * @param {import("./areas.js").Area} area @param {number} x @param {number} y of a point in it
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
    return (sum || voice(x, y)) > 0; // a narrow area may lie between them all
  }
}

/** Light: a drag over the result moves it. */
export class LightTool {
  /** @param {(x: number, y: number) => void} move over a point of the pane */
  constructor(move) {
    this.shine = move;
  }

  /** @param {Touch} touch */
  down({ pane }) {
    if (pane) this.shine(pane.x, pane.y);
  }

  /** @param {Touch} touch */
  move(touch) {
    this.down(touch);
  }

  up() {}

  cancel() {}
}
