/** Toolbar: the tools and their options. */

import { withActive } from "../drawing/document.js";
import { LIMITS } from "../drawing/limits.js";
import { $, enable, field, label } from "../elements/dom.js";
import { icon } from "../elements/icons.js";
import { recalled, remember } from "../elements/settings.js";
import { say, text } from "../text/text.js";

const TOOLS = ["pen", "eraser", "select", "hint", "region", "brush", "mask", "fill", "light", "hand"];
/** Tools with options other than the line's. */
const WITH_OPTIONS = ["hint", "region", "hand", "select", "mask", "fill", "light"];
/** Range of the side of a structure's tiles in the slider, in drawing pixels. */
export const PERIODS = [16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512];
const WIDTHS = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96];

/** @type {("straight" | "symmetry")[]} */
const SWITCHES = ["straight", "symmetry"];
const KEY = "normalgan-brushes";

/** Saves the line settings for the next session. @param {import("../drawing/editor.js").Editor} editor */
const keepBrushes = ({ widths, smoothing, colour, fillColour, brush, structure }) =>
  remember(KEY, { widths, smoothing, colour, fillColour, brush, ...(!structure.picture && { structure }) });

/** Restores saved settings that are valid. @param {import("../drawing/editor.js").Editor} editor */
function recallBrushes(editor) {
  const before = recalled(KEY) ?? {};
  const widths = Object.fromEntries(Object.entries(editor.widths).map(([tool, width]) => [tool, WIDTHS.includes(before.widths?.[tool]) ? before.widths[tool] : width]));
  const smoothing = before.smoothing >= 0 && before.smoothing <= 1 ? before.smoothing : editor.smoothing;
  const [colour, fillColour] = /** @type {const} */ (["colour", "fillColour"]).map((name) => (/^#[0-9a-f]{6}$/.test(before[name]) ? before[name] : editor[name]));
  const share = (/** @type {"soft" | "strength"} */ part) => (before.brush?.[part] >= 0 && before.brush[part] <= 1 ? Number(before.brush[part]) : editor.brush[part]);
  const works = ["smooth", "structure"].includes(before.brush?.works) ? before.brush.works : editor.brush.works;
  const brush = { soft: share("soft"), strength: share("strength"), works };
  const { kind, period, turn } = before.structure ?? {};
  const structure = LIMITS.kinds.includes(kind) && PERIODS.includes(period) ? { kind, period, ...(Number.isFinite(turn) && { turn }) } : editor.structure;
  editor.set({ widths, smoothing, colour, fillColour, brush, structure });
}

/**
 * Returns the name of the tool if it has a width.
 * @param {import("../drawing/editor.js").Editor} editor
 */
const toolOf = ({ tool, widths }) => (tool in widths ? tool : undefined);

/** @param {import("../drawing/editor.js").Editor} editor @param {number} step thinner -1, thicker 1 */
export function widen(editor, step) {
  const kind = toolOf(editor) ?? "pen";
  const at = WIDTHS.findIndex((width) => width >= editor.widths[kind]) + step;
  const width = WIDTHS[Math.max(0, Math.min(WIDTHS.length - 1, at))];
  editor.set({ widths: { ...editor.widths, [kind]: width } });
}

/** Cycles the pen between engraving, embossing and plain lines. @param {import("../drawing/editor.js").Editor} editor */
export const turnCarving = (editor) => editor.set({ tool: "pen", carves: editor.carves === 0 ? -1 : editor.carves < 0 ? 1 : 0 });

/** Hides the help next to a tool's options if it would be cut off. */
function followHelp() {
  const sized = new ResizeObserver((entries) => {
    for (const { target } of entries) target.classList.toggle("cut", target.scrollHeight > target.clientHeight + 1);
  });
  for (const help of document.querySelectorAll(".options > .quiet")) sized.observe(help);
}

/** The buttons and options of the tools. */
export class Toolbar {
  /** @param {import("../drawing/editor.js").Editor} editor @param {import("../drawing/ink.js").Inks} inks */
  constructor(editor, inks) {
    this.editor = editor;
    this.inks = inks;
    this.size = field("size");
    this.smoothing = field("smoothing");
    this.colour = field("colour");
    this.fillColour = field("fill-colour");
    this.carveHeight = field("carve-height");
    this.size.max = String(WIDTHS.length - 1);
    followHelp();
    this.#listen();
    recallBrushes(editor);
    editor.addEventListener("state", () => keepBrushes(editor));
    for (const event of ["change", "state"]) editor.addEventListener(event, () => this.#show());
    this.#show();
  }

  #listen() {
    const { editor, size, smoothing, colour, fillColour, carveHeight } = this;
    for (const tool of TOOLS) $(`tool-${tool}`).addEventListener("click", () => editor.set({ tool, area: -1, suggestions: [] }));
    size.addEventListener("input", () => editor.set({ widths: { ...editor.widths, [editor.tool]: WIDTHS[size.valueAsNumber] } }));
    smoothing.addEventListener("input", () => editor.set({ smoothing: smoothing.valueAsNumber / 100 }));
    colour.addEventListener("input", () => editor.set({ colour: colour.value }));
    fillColour.addEventListener("input", () => editor.set({ fillColour: fillColour.value }));
    $("carve").addEventListener("click", () => turnCarving(editor));
    carveHeight.addEventListener("input", () => editor.set({ carveHeight: carveHeight.valueAsNumber / 100 }));
    for (const id of SWITCHES) $(id).addEventListener("click", () => editor.set({ [id]: !editor[id] }));
    $("mask-add").addEventListener("click", () => editor.set({ adds: true, fills: false }));
    $("mask-cut").addEventListener("click", () => editor.set({ adds: false, fills: false }));
    $("mask-area").addEventListener("click", () => editor.set({ fills: true }));
    $("mask-clear").addEventListener("click", () => editor.commit(withActive(editor.doc, { mask: [], source: null })));
  }

  #show() {
    const { tool } = this.editor;
    for (const each of TOOLS) press(`tool-${each}`, each === tool);
    for (const each of document.querySelectorAll("#board, #overlay")) /** @type {HTMLElement} */ (each).dataset.tool = tool;
    for (const each of WITH_OPTIONS) $(`${each}-options`).hidden = tool !== each;
    this.#showLine();
    this.#showCarving();
    this.#showMask();
    this.#showDrawing();
  }

  /** Shows the line settings. */
  #showLine() {
    const { editor, size, smoothing, colour } = this;
    const { tool } = editor;
    const width = editor.widths[tool];
    $("line-options").hidden = !width || (tool === "mask" && editor.fills);
    if (width) {
      size.value = String(WIDTHS.findIndex((each) => each >= width));
      size.setAttribute("aria-valuetext", say("widthValue", { width }));
      $("size-value").textContent = String(width);
    }
    smoothing.value = String(editor.smoothing * 100);
    $("smoothing-label").hidden = tool !== "pen";
    colour.value = editor.colour;
    colour.hidden = tool !== "pen";
    this.fillColour.value = editor.fillColour;
    for (const id of SWITCHES) {
      press(id, editor[id]);
      $(id).hidden = !["pen", "eraser"].includes(tool);
    }
  }

  /** Shows whether lines are engraved or embossed. */
  #showCarving() {
    const { tool, carves, carveHeight } = this.editor;
    const button = $("carve");
    button.hidden = tool !== "pen";
    press("carve", carves !== 0);
    button.replaceChildren(icon(carves > 0 ? "emboss" : "engrave"));
    label(button, carves < 0 ? text.carveIn : carves > 0 ? text.carveOut : text.carveNot);
    $("carve-height-label").hidden = tool !== "pen" || carves === 0;
    this.carveHeight.value = String(Math.round(100 * carveHeight));
  }

  #showMask() {
    const { adds, fills, layer } = this.editor;
    $("mask-help").hidden = !fills;
    press("mask-add", adds && !fills);
    press("mask-cut", !adds && !fills);
    press("mask-area", fills);
    enable("mask-clear", layer.mask.length > 0 || layer.source !== null);
  }

  /** Shows what depends on the drawing. */
  #showDrawing() {
    const { inks, editor: { doc, layer, history } } = this;
    enable("undo", history.canUndo);
    enable("redo", history.canRedo);
    enable("suggest", layer.visible && layer.strokes.length > 0);
    const name = doc.settings.name || text.untitled;
    $("project-name").textContent = name;
    document.title = `${name} – ${text.title}`;
    const begun = doc.pictures.length > 0 || doc.layers.some((each) => each.strokes.length > 0) || inks.live;
    $("empty-board").hidden = begun;
    $("offer").hidden = begun;
    $("pixels").textContent = say("pixels", { width: doc.width, height: doc.height });
  }
}

/** Shows whether a button is pressed. @param {string} id @param {boolean} pressed */
const press = (id, pressed) => $(id).setAttribute("aria-pressed", String(pressed));
