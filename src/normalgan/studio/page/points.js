/** Points: the list of hints and suggestions, and the ball beside the chosen one. */

import { suggest } from "./api.js";
import { Ball } from "./ball.js";
import { changedHint, withoutHint } from "./document.js";
import { $, label, make } from "./dom.js";
import { colourOf, inWords } from "./normal.js";
import { say, text } from "./text.js";

const COUNT = 6;
const GAP = 30;

export class Points {
  /**
   * @param {import("./board.js").Board} board
   * @param {import("./tools.js").HintTool} tool
   * @param {import("./painter.js").Painter} painter
   * @param {import("./status.js").Status} status
   */
  constructor(board, tool, painter, status) {
    Object.assign(this, { board, tool, painter, status, editor: board.editor });
    this.popover = $("point");
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

  /** Puts the ball beside its point, inside the pane. */
  #place() {
    const hint = this.editor.doc.hints[this.editor.chosen];
    if (!hint || this.popover.hidden) return;
    const { x, y } = this.board.camera.toPane(hint.x, hint.y);
    const { offsetWidth: width, offsetHeight: height } = this.popover;
    const { pane } = this.board;
    const left = x + GAP + width < pane.width ? x + GAP : x - GAP - width;
    const clamp = (value, most) => Math.max(8, Math.min(most - 8, value));
    this.popover.style.left = `${clamp(left, pane.width - width)}px`;
    this.popover.style.top = `${clamp(y - height / 2, pane.height - height)}px`;
  }
}
