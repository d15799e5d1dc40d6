/** Points: the list of hints and suggestions, and the ball beside the chosen one. */

import { suggest } from "./api.js";
import { Ball } from "./ball.js";
import { changedHint, withoutHint } from "./document.js";
import { $, label, make } from "./dom.js";
import { colourOf, inWords } from "./normal.js";
import { say, text } from "./text.js";

const COUNT = 6;
const GAP = 30;
/** How far about its middle a mark reaches. */
const MARK = 14;

export class Points {
  /**
   * @param {import("./board.js").Board} board
   * @param {import("./tools.js").HintTool} tool
   * @param {import("./painter.js").Painter} painter
   * @param {import("./status.js").Status} status
   */
  constructor(board, tool, painter, status) {
    this.board = board;
    this.tool = tool;
    this.painter = painter;
    this.status = status;
    this.editor = board.editor;
    this.popover = $("point");
    /** @type {{x: number, y: number} | null} where the card was dragged to */
    this.dragged = null;
    this.#followHandle($("point-handle"));
    this.ball = new Ball($("ball"), (normal, ended) => this.#turn(normal, ended));
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
    painter.addEventListener("empty", () => this.editor.suggestions.length && this.editor.set({ suggestions: [] }));
    board.onDrawn = () => this.#place();
    this.#show();
  }

  /** Chooses a point and gives its ball the focus. @param {number} index */
  choose(index) {
    this.editor.set({ chosen: index });
    $("ball").focus();
  }

  /** Chooses the next or the previous point. @param {number} step */
  next(step) {
    const { length } = this.editor.doc.hints;
    if (!length) return;
    const from = this.editor.chosen < 0 && step < 0 ? 0 : this.editor.chosen;
    this.choose((from + step + length) % length);
  }

  /** Removes the chosen point. */
  remove() {
    const { editor } = this;
    if (editor.chosen < 0) return;
    const index = editor.chosen;
    editor.set({ chosen: -1 });
    editor.commit(withoutHint(editor.doc, index));
    this.status.say(text.removed);
    this.board.canvas.focus();
  }

  /** Leaves the chosen point. */
  done() {
    this.editor.set({ chosen: -1 });
    this.board.canvas.focus();
  }

  /** Asks the server where a point would help most. */
  async suggest() {
    const { editor, painter, status } = this;
    if (!editor.doc.strokes.length) return;
    try {
      const { doc } = editor;
      const points = await painter.ask(suggest, { count: COUNT });
      // What was asked for an older drawing may lie beside the object.
      if (doc.strokes !== editor.doc.strokes) return;
      editor.set({ suggestions: points, tool: "hint", chosen: -1 });
      status.say(points.length ? say("suggested", { count: points.length }) : text.suggestedNone);
    } catch (error) {
      status.fail(error);
    }
  }

  #turn(normal, ended) {
    const { editor } = this;
    if (editor.chosen < 0) return;
    const doc = changedHint(editor.history.state, editor.chosen, { normal });
    if (ended) editor.commit(doc);
    else editor.preview(doc);
  }

  #show() {
    const { editor } = this;
    const { hints } = editor.doc;
    const chips = hints.map((hint, i) => this.#chip(i + 1, hint.normal, i === editor.chosen));
    const offers = editor.suggestions.map((point, i) => {
      const words = say("suggestion", { number: i + 1, direction: inWords(point.normal) });
      const chip = make("button", { class: "chip offer", type: "button", text: "+", "aria-label": words, title: words });
      chip.addEventListener("click", () => {
        this.tool.accept(i);
        $("ball").focus();
      });
      return chip;
    });
    const focused = [...$("chips").children].indexOf(document.activeElement);
    $("chips").replaceChildren(...chips, ...offers);
    if (focused >= 0) $("chips").children[Math.min(focused, chips.length + offers.length - 1)]?.focus();
    $("hints-empty").hidden = chips.length + offers.length > 0;
    const hint = hints[editor.chosen];
    this.popover.hidden = !hint || (editor.tool !== "hint");
    if (!hint) return;
    const words = { number: editor.chosen + 1, direction: inWords(hint.normal) };
    label($("ball"), say("ball", words));
    $("point-words").textContent = words.direction;
    if (!this.popover.hidden) this.ball.show(hint.normal);
    this.#place();
  }

  #chip(number, normal, chosen) {
    const words = say("hintName", { number, direction: inWords(normal) });
    const chip = make("button", { class: "chip", type: "button", text: number, "aria-label": words, "aria-pressed": chosen, title: words });
    chip.style.setProperty("--colour", colourOf(normal));
    chip.addEventListener("click", () => this.choose(number - 1));
    return chip;
  }

  /** Lets the card be dragged; where it was put it stays, until the next page. */
  #followHandle(handle) {
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
  }

  /** Returns where the card covers least: other points, then the drawing. */
  #spot(pin, width, height) {
    const { pane, camera } = this.board;
    const { hints, width: side, height: other } = this.editor.doc;
    const [start, end] = [camera.toPane(0, 0), camera.toPane(side, other)];
    const overlap = (a, b, from, to) => Math.max(0, Math.min(b, to) - Math.max(a, from));
    const ways = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];
    const spots = ways.flatMap(([x, y]) => [1, 3].map((far) => ({
      x: pin.x - width / 2 + x * (far * GAP + width / 2), y: pin.y - height / 2 + y * (far * GAP + height / 2),
    })));
    const cost = ({ x, y }) => {
      const covered = hints.filter((hint) => {
        const at = camera.toPane(hint.x, hint.y);
        return at.x > x - MARK && at.x < x + width + MARK && at.y > y - MARK && at.y < y + height + MARK;
      }).length;
      const paper = overlap(x, x + width, start.x, end.x) * overlap(y, y + height, start.y, end.y);
      const outside = width * height - overlap(x, x + width, 0, pane.width) * overlap(y, y + height, 0, pane.height);
      return covered + (paper + 4 * outside) / (width * height);
    };
    return spots.reduce((best, each) => (cost(each) < cost(best) - 0.01 ? each : best));
  }

  /** Puts the ball beside its point, inside the pane. */
  #place() {
    const hint = this.editor.doc.hints[this.editor.chosen];
    if (!hint || this.popover.hidden) return;
    const { x, y } = this.board.camera.toPane(hint.x, hint.y);
    const { offsetWidth: width, offsetHeight: height } = this.popover;
    const { pane } = this.board;
    const at = this.dragged ?? this.#spot({ x, y }, width, height);
    const clamp = (value, most) => Math.max(8, Math.min(most - 8, value));
    this.popover.style.left = `${clamp(at.x, pane.width - width)}px`;
    this.popover.style.top = `${clamp(at.y, pane.height - height)}px`;
  }
}
