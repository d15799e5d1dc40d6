/** Points: the list of points and suggestions, and the ball next to the selected point. */

import { activeLayer, anchorOf, changedArea, changedHint, mostReach, reachOf, withoutArea, withoutHint } from "../drawing/document.js";
import { colourOf, inWords } from "../drawing/normal.js";
import { $, label, make } from "../elements/dom.js";
import { suggest } from "../server/api.js";
import { say, text } from "../text/text.js";
import { Ball } from "./ball.js";

const COUNT = 6;
/** Distance in pixels from a point to its ball. */
const GAP = 40;
/** Pixels that an arrow key moves the card. */
const STEP = 16;
/** Radius of a mark in pixels. */
const MARK = 14;
/** Height in pixels below which a pane is too low for the card's vertical layout. */
const LOW = 236;

export class Points {
  /**
   * @param {import("../board/board.js").Board[]} boards that show points; the card is in the last touched one
   * @param {import("../board/tool_hint.js").HintTool} tool
   * @param {import("../result/predictor.js").Predictor} predictor
   * @param {import("../elements/status.js").Status} status
   */
  constructor(boards, tool, predictor, status) {
    /** @type {import("../board/board.js").Board} */
    this.board = boards[0];
    this.tool = tool;
    this.predictor = predictor;
    this.status = status;
    this.editor = this.board.editor;
    this.popover = $("point");
    /** @type {{x: number, y: number} | null} position that the card was dragged to */
    this.dragged = null;
    this.#followHandle($("point-handle"));
    this.ball = new Ball($("ball"), (normal, ended) => this.#turn(normal, ended));
    /** @type {HTMLInputElement} */
    this.slider = $("point-reach");
    this.slider.addEventListener("input", () => this.#reach(false));
    this.slider.addEventListener("change", () => this.#reach(true));
    $("point-remove").addEventListener("click", () => this.remove());
    $("point-done").addEventListener("click", () => this.done());
    $("suggest").addEventListener("click", () => this.suggest());
    this.popover.addEventListener("keydown", (event) => {
      if (event.key === "Delete" || event.key === "Backspace") this.remove();
      else if (event.key === "Escape") this.done();
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
    this.editor.addEventListener("change", () => this.#show());
    this.editor.addEventListener("state", () => this.#show());
    predictor.addEventListener("empty", () => this.editor.suggestions.length && this.editor.set({ suggestions: [] }));
    predictor.addEventListener("painted", () => this.#keepOnObject());
    for (const board of boards) board.onDrawn = () => board === this.board && this.#place();
    this.#show();
  }

  /** Drops suggestions that are no longer on the object. */
  #keepOnObject() {
    const { editor: { doc, suggestions }, predictor: { painted, whole } } = this;
    if (!suggestions.length || !painted || !whole) return;
    const { rgba, width, height } = painted;
    const kept = suggestions.filter(({ x, y }) => rgba[4 * (Math.floor((y * height) / doc.height) * width + Math.floor((x * width) / doc.width)) + 3] > 127);
    if (kept.length < suggestions.length) this.editor.set({ suggestions: kept });
  }

  /** Moves the card to another pane. @param {import("../board/board.js").Board} board */
  use(board) {
    if (board === this.board) return;
    this.board = board;
    this.dragged = null;
    board.canvas.after(this.popover);
    this.#place();
  }

  /** Selects a point and focuses its ball. @param {number} index */
  choose(index) {
    this.editor.set({ chosen: index });
    $("ball").focus();
  }

  /** Selects the next or previous point. @param {number} step */
  next(step) {
    const { length } = this.editor.layer.hints;
    if (!length) return;
    const from = this.editor.chosen < 0 && step < 0 ? 0 : this.editor.chosen;
    this.choose((from + step + length) % length);
  }

  /** Deletes the selected point or area. */
  remove() {
    const { editor } = this;
    const { chosen, area } = editor;
    if (chosen < 0 && area < 0) return;
    editor.set({ chosen: -1, area: -1 });
    editor.commit(chosen < 0 ? withoutArea(editor.doc, area) : withoutHint(editor.doc, chosen));
    this.status.say(chosen < 0 ? text.removedArea : text.removed);
    this.board.focus.focus();
  }

  /** Deselects the point or area. */
  done() {
    this.editor.set({ chosen: -1, area: -1 });
    this.board.focus.focus();
  }

  /** Asks the server where a point would help most. */
  async suggest() {
    const { editor, predictor, status } = this;
    const { layer } = editor;
    if (!layer.strokes.length) return;
    try {
      const points = await predictor.ask(suggest, { count: COUNT }, [layer]);
      // Suggestions for an older drawing may lie off the object.
      if (layer.strokes !== editor.layer.strokes) return;
      editor.set({ suggestions: points, tool: "hint", chosen: -1 });
      if (points.length) status.say(say("suggested", { count: points.length }));
      else status.say(text.suggestedNone, "warning");
    } catch (error) {
      status.fail(error);
    }
  }

  /** @param {import("../drawing/document.js").Normal} normal @param {boolean} ended */
  #turn(normal, ended) {
    const { editor } = this;
    const { state } = editor.history;
    if (editor.area >= 0) {
      if (activeLayer(state).areas[editor.area].size) editor.direction = normal;
      this.#change(changedArea(state, editor.area, { normal }), ended);
    } else if (editor.chosen >= 0) this.#change(changedHint(state, editor.chosen, { normal }), ended);
  }

  /** @param {boolean} ended */
  #reach(ended) {
    const { editor } = this;
    if (editor.chosen < 0) return;
    const { state } = editor.history;
    // Finer steps for small values.
    const reach = Math.round((this.slider.valueAsNumber / 100) ** 2 * mostReach(state));
    // Some browsers report the end twice; that is one step in history.
    if (!editor.draft && activeLayer(state).hints[editor.chosen].reach === reach) return;
    this.#change(changedHint(state, editor.chosen, { reach }), ended);
  }

  /** @param {import("../drawing/document.js").Doc} doc @param {boolean} ended */
  #change(doc, ended) {
    // Consecutive arrow presses are one step in history.
    if (ended) this.editor.commit(doc, `turned ${this.editor.chosen} ${this.editor.area}`);
    else this.editor.preview(doc);
  }

  /**
   * Returns the position, direction and name of the selected point or area.
   * @returns {{x: number, y: number, normal: import("../drawing/document.js").Normal, reach?: number, smooths?: boolean, structure?: import("../drawing/document.js").Structure, ball: "ball" | "areaBall", number: number} | undefined}
   */
  #chosen() {
    const { editor } = this;
    const hint = editor.layer.hints[editor.chosen];
    if (hint) return { ...hint, ball: "ball", number: editor.chosen + 1 };
    const area = editor.layer.areas[editor.area];
    return area && { ...anchorOf(area), normal: area.normal, smooths: area.smooths, structure: area.structure, ball: "areaBall", number: editor.area + 1 };
  }

  #show() {
    const { editor } = this;
    const { hints, areas } = editor.layer;
    const chips = hints.map((hint, i) => this.#chip("hintName", i, hint.normal, i === editor.chosen, () => this.choose(i)));
    chips.push(...areas.map((area, i) => this.#chip(area.structure ? "structureName" : area.smooths ? "smoothName" : "areaName", i, area.normal, i === editor.area, () => {
      editor.set({ area: i });
      $("ball").focus();
    })));
    const offers = editor.suggestions.map((point, i) => {
      const words = say("suggestion", { number: i + 1, direction: inWords(point.normal) });
      const chip = make("button", { class: "chip offer", type: "button", text: "+", "aria-label": words, title: words });
      chip.addEventListener("click", () => {
        this.tool.accept(i);
        $("ball").focus();
      });
      return chip;
    });
    const focused = [...$("chips").children].indexOf(/** @type {Element} */ (document.activeElement));
    $("chips").replaceChildren(...chips, ...offers);
    if (focused >= 0) [...chips, ...offers].at(Math.min(focused, chips.length + offers.length - 1))?.focus();
    $("hints-empty").hidden = chips.length + offers.length > 0;
    const chosen = this.#chosen();
    // A structure has no ball, and the brush has its own sliders, so the card would only be in the way.
    this.popover.hidden = !chosen || !["hint", "region", "brush"].includes(editor.tool) || (editor.tool === "brush" && chosen.structure !== undefined);
    if (!chosen) return;
    const words = { number: chosen.number, direction: inWords(chosen.normal) };
    label($("ball"), say(chosen.ball, words));
    const name = chosen.structure ? "structureName" : chosen.smooths ? "smoothName" : null;
    $("ball").hidden = name !== null;
    $("point-words").textContent = name ? say(name, { number: chosen.number }) : words.direction;
    $("point-reach-label").hidden = editor.chosen < 0;
    this.slider.value = String(Math.round(100 * Math.sqrt(reachOf(chosen, editor.doc) / mostReach(editor.doc))));
    if (!this.popover.hidden) this.ball.show(chosen.normal);
    this.#place();
  }

  /**
   * @param {"hintName" | "areaName" | "smoothName" | "structureName"} name @param {number} index @param {import("../drawing/document.js").Normal} normal
   * @param {boolean} chosen @param {() => void} choose
   */
  #chip(name, index, normal, chosen, choose) {
    const words = say(name, { number: index + 1, direction: inWords(normal) });
    const chip = make("button", { class: name === "hintName" ? "chip" : "chip area", type: "button", text: index + 1, "aria-label": words, "aria-pressed": chosen, title: words });
    chip.style.setProperty("--colour", colourOf(normal));
    chip.addEventListener("click", choose);
    return chip;
  }

  /** Makes the card draggable; it stays where it was put until the page is reloaded. @param {HTMLElement} handle */
  #followHandle(handle) {
    /** @type {{x: number, y: number} | null} */
    let from = null;
    handle.addEventListener("pointerdown", (event) => {
      handle.setPointerCapture(event.pointerId);
      from = { x: event.clientX - this.popover.offsetLeft, y: event.clientY - this.popover.offsetTop };
      event.preventDefault();
    });
    handle.addEventListener("pointermove", (event) => {
      if (!from) return;
      this.dragged = { x: event.clientX - from.x, y: event.clientY - from.y };
      this.#place();
    });
    for (const end of ["pointerup", "pointercancel"]) handle.addEventListener(end, () => { from = null; });
    handle.addEventListener("keydown", (event) => {
      const way = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!way) return;
      event.preventDefault();
      this.dragged = { x: this.popover.offsetLeft + way[0] * STEP, y: this.popover.offsetTop + way[1] * STEP };
      this.#place();
    });
  }

  /**
   * Returns a position for the ball next to its point that does not cover other points.
   * @param {{x: number, y: number}} pin in the pane @param {number} width @param {number} height
   */
  #spot(pin, width, height) {
    const { pane, camera } = this.board;
    const { layer: { hints, areas }, suggestions } = this.editor;
    const marks = [...hints, ...areas.map(anchorOf), ...suggestions].map((each) => camera.toPane(each.x, each.y));
    /** @param {number} a @param {number} b @param {number} most */
    const overlap = (a, b, most) => Math.max(0, Math.min(b, most) - Math.max(a, 0));
    const ways = [[1, 0], [-1, 0], [0, -1], [0, 1], [1, -1], [-1, -1], [1, 1], [-1, 1]];
    const spots = ways.map(([x, y]) => ({
      x: pin.x - width / 2 + x * (GAP + width / 2), y: pin.y - height / 2 + y * (GAP + height / 2),
    }));
    /** @param {{x: number, y: number}} spot */
    const cost = ({ x, y }) => {
      const covered = marks.filter((at) =>
        at.x > x - MARK && at.x < x + width + MARK && at.y > y - MARK && at.y < y + height + MARK).length;
      const outside = width * height - overlap(x, x + width, pane.width) * overlap(y, y + height, pane.height);
      return covered + (4 * outside) / (width * height);
    };
    return spots.reduce((best, each) => (cost(each) < cost(best) - 0.01 ? each : best));
  }

  /** Places the ball next to its point, inside the pane. */
  #place() {
    const chosen = this.#chosen();
    if (!chosen || this.popover.hidden) return;
    const { x, y } = this.board.camera.toPane(chosen.x, chosen.y);
    const { pane } = this.board;
    this.popover.classList.toggle("low", pane.height < LOW);
    const { offsetWidth: width, offsetHeight: height } = this.popover;
    const at = this.dragged ?? this.#spot({ x, y }, width, height);
    /** @param {number} value @param {number} most */
    const clamp = (value, most) => Math.max(8, Math.min(most - 8, value));
    this.popover.style.left = `${clamp(at.x, pane.width - width)}px`;
    this.popover.style.top = `${clamp(at.y, pane.height - height)}px`;
  }
}
