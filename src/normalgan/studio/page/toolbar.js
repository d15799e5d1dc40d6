/** Toolbar: which tool, how wide, how smooth; shows what the editor holds. */

import { withSettings } from "./document.js";
import { $ } from "./dom.js";
import { say, text } from "./text.js";

const TOOLS = ["pen", "eraser", "hint", "region", "brush", "hand"];
const WIDTHS = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96];

/**
 * Returns the tool if it has a width.
 * @param {import("./editor.js").Editor} editor
 */
const toolOf = ({ tool }) => (tool === "pen" || tool === "eraser" || tool === "brush" ? tool : undefined);

/** @param {import("./editor.js").Editor} editor @param {number} step thinner -1, thicker 1 */
export function widen(editor, step) {
  const kind = toolOf(editor) ?? "pen";
  const at = WIDTHS.findIndex((width) => width >= editor.widths[kind]) + step;
  const width = WIDTHS[Math.max(0, Math.min(WIDTHS.length - 1, at))];
  editor.set({ widths: { ...editor.widths, [kind]: width } });
}

/** @param {import("./editor.js").Editor} editor @param {import("./board.js").Board} board */
export function followTools(editor, board) {
  for (const tool of TOOLS) $(`tool-${tool}`).addEventListener("click", () => editor.set({ tool, area: -1, suggestions: [] }));
  /** @type {HTMLInputElement} */
  const size = $("size");
  /** @type {HTMLInputElement} */
  const smoothing = $("smoothing");
  /** @type {HTMLSelectElement} */
  const source = $("source");
  /** @param {string} id @param {boolean} enabled */
  const enable = (id, enabled) => { /** @type {HTMLButtonElement} */ ($(id)).disabled = !enabled; };
  size.max = String(WIDTHS.length - 1);
  size.addEventListener("input", () => {
    editor.set({ widths: { ...editor.widths, [editor.tool]: WIDTHS[size.valueAsNumber] } });
  });
  smoothing.addEventListener("input", () => editor.set({ smoothing: smoothing.valueAsNumber / 100 }));
  source.addEventListener("change", () => {
    const chosen = /** @type {"outline" | "model" | ""} */ (source.value);
    editor.commit(withSettings(editor.doc, { source: chosen || null }));
  });
  const show = () => {
    const { tool, doc } = editor;
    for (const each of TOOLS) $(`tool-${each}`).setAttribute("aria-pressed", String(each === tool));
    board.canvas.dataset.tool = tool;
    const lined = toolOf(editor);
    const width = lined && editor.widths[lined];
    $("line-options").hidden = !width;
    $("hint-options").hidden = tool !== "hint";
    $("region-options").hidden = tool !== "region";
    $("hand-options").hidden = tool !== "hand";
    if (width) {
      size.value = String(WIDTHS.findIndex((each) => each >= width));
      size.setAttribute("aria-valuetext", say("widthValue", { width }));
      $("size-value").textContent = String(width);
    }
    smoothing.value = String(editor.smoothing * 100);
    $("smoothing-label").hidden = tool !== "pen";
    source.value = doc.settings.source ?? "";
    enable("undo", editor.history.canUndo);
    enable("redo", editor.history.canRedo);
    enable("suggest", doc.strokes.length > 0);
    $("project-name").textContent = doc.settings.name || text.untitled;
    document.title = `${doc.settings.name || text.untitled} – ${text.title}`;
    $("empty-board").hidden = doc.strokes.length + doc.layers.length > 0 || Boolean(board.ink.live);
    $("pixels").textContent = say("pixels", { width: doc.width, height: doc.height });
  };
  editor.addEventListener("change", show);
  editor.addEventListener("state", show);
  show();
}
