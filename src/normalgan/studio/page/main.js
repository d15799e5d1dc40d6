/** Main: assemble the parts of the studio. */

import { Arranging } from "./board/arranging.js";
import { Board } from "./board/board.js";
import { View } from "./board/camera.js";
import { KeyboardPen } from "./board/keyboard_pen.js";
import { Panes } from "./board/panes.js";
import { Pointers } from "./board/pointer.js";
import { AreaTool } from "./board/tool_area.js";
import { HintTool } from "./board/tool_hint.js";
import { LineTool } from "./board/tool_line.js";
import { FillTool } from "./board/tool_fill.js";
import { MaskTool } from "./board/tool_mask.js";
import { SelectTool } from "./board/tool_select.js";
import { LightTool } from "./board/tools.js";
import { Editor, NOTHING } from "./drawing/editor.js";
import { Inks } from "./drawing/ink.js";
import { $, fill, make, open } from "./elements/dom.js";
import { followSheets } from "./elements/sheets.js";
import { SHOWN, followKeys } from "./elements/shortcuts.js";
import { Status } from "./elements/status.js";
import { followTheme } from "./elements/theme.js";
import { Autosave } from "./files/autosave.js";
import { Exporting } from "./files/exporting.js";
import { Folder } from "./files/folder.js";
import { Importing } from "./files/importing.js";
import { Projects } from "./files/projects.js";
import { begin } from "./files/start.js";
import { claimTab } from "./files/tab.js";
import { Brushes } from "./panels/brushes.js";
import { teach } from "./panels/first_steps.js";
import { Forms } from "./panels/forms.js";
import { followHistory } from "./panels/history_list.js";
import { Layers } from "./panels/layers.js";
import { followPaper } from "./panels/paper.js";
import { Points } from "./panels/points.js";
import { offerSamples } from "./panels/samples.js";
import { Toolbar, turnCarving, widen } from "./panels/toolbar.js";
import { Lights } from "./result/lights.js";
import { Materials } from "./result/materials.js";
import { Predictor } from "./result/predictor.js";
import { Result, VIEWS } from "./result/result.js";
import { about } from "./server/api.js";
import { Connection } from "./server/connection.js";
import { say, text, wordsOf } from "./text/text.js";

fill();
followTheme($("theme"));
followSheets();
const tab = await claimTab();
const connection = new Connection();
const status = new Status(connection);
const editor = new Editor();
const inks = new Inks();
const view = new View();
const board = new Board($("board"), $("sheet"), editor, inks, view);
const overlay = new Board($("overlay"), $("result-sheet"), editor, inks, view, $("viewer"));
const predictor = new Predictor(editor, inks, connection, tab);
const result = new Result(predictor, status);
const lights = new Lights(result.viewer, () => result.view, (each) => result.show(each));
result.onLight = (/** @type {number[]} */ light) => lights.took(light);
const materials = new Materials(editor, predictor, result);
const panes = new Panes(board, overlay, predictor, status);
// Marks would hide the map from users who only look at it.
overlay.marked = () => panes.layout === "result" || ["hint", "region", "brush"].includes(editor.tool);
overlay.onMoved = () => {
  const [a, b, c, d, e, f] = overlay.camera.transform();
  const { width, height } = editor.doc;
  result.viewer.setFrame({ transform: [a * width, b * width, c * height, d * height, e, f], angle: view.angle });
};
const autosave = new Autosave(editor, connection, tab);
const projects = new Projects(editor, autosave, status);
const importing = new Importing(editor, view, status, projects);
const folder = new Folder(importing, projects, predictor, (map) => result.viewer.shaded(map, null));
importing.onSeveral = (/** @type {DataTransfer} */ dropped) => folder.take(dropped);
const exporting = new Exporting(editor, predictor, status, (map, clay = false) =>
  result.viewer.shaded(map, clay ? null : materials.colours(Math.max(map.width, map.height))));
/** @type {import("./elements/status.js").Announce} */
const announce = (words, kind) => status.say(words, kind);
const lines = new LineTool(editor, inks, announce);
const pins = new HintTool(editor, () => predictor.painted, announce);
const areas = new AreaTool(editor, () => predictor.painted, announce);
const points = new Points([board, overlay], pins, predictor, status);
const mask = new MaskTool(editor, () => predictor.painted, announce);
const bucket = new FillTool(editor, announce);
for (const each of [board, overlay]) {
  each.voteAt = (at) => mask.voteAt(at);
  each.areaAt = (at) => (editor.tool === "fill" ? bucket : areas).areaAt(at);
}
const select = new SelectTool(editor, announce);
const arranging = new Arranging(editor, announce);
result.onFigures = (/** @type {import("./drawing/lasso.js").Lasso[]} */ outlines) => arranging.part(outlines);
const light = new LightTool((x, y) => lights.move(x, y));
/** @type {Record<string, import("./board/tools.js").Tool | null>} */
const tools = { pen: lines, eraser: lines, select, hint: pins, region: areas, brush: areas, mask, fill: bucket, light: null, hand: null };
const tool = () => {
  const chosen = tools[editor.tool];
  if (!chosen || editor.layer.visible) return chosen;
  status.say(text.layerUnseen, "warning");
  return null;
};
const overResult = () => {
  // If the drawing is visible too, pen and eraser only draw there, and move the light over the result.
  const drawing = ["pen", "eraser"].includes(editor.tool) && panes.layout !== "result";
  if (drawing || editor.tool === "light") return result.view === "map" ? null : light;
  return tool();
};
const pointers = [{ each: board, chosen: tool }, { each: overlay, chosen: overResult }].map(({ each, chosen }) =>
  new Pointers(each, chosen, () => points.use(each), (fingers) => (fingers === 2 ? undo() : redo())));
new KeyboardPen(board, tool, status);
new Toolbar(editor, inks);
offerSamples((doc, name) => {
  projects.load(doc, null, false).then((shown) => {
    if (!shown) return;
    if (panes.layout === "drawing") panes.show("both"); // the map should be visible
    status.say(say("opened", { name }));
  }).catch((error) => status.fail(error));
});
followHistory(editor, announce);
followPaper(editor, importing);
const forms = new Forms(editor, predictor, (map) => result.viewer.shaded(map, null));
const brush = new Brushes(editor, (file) => importing.pictureOf(file), announce);
const layers = new Layers(editor, inks, announce);
autosave.addEventListener("failed", (event) => status.fail(/** @type {CustomEvent} */ (event).detail, "lasting"));

// A new action clears the last message; its own message follows.
editor.addEventListener("change", (event) => /** @type {CustomEvent} */ (event).detail.live || status.clear());
editor.addEventListener("full", () => status.say(text.noRoom, "warning"));
let { tool: chosenTool } = editor;
editor.addEventListener("state", () => {
  if (editor.tool !== chosenTool) status.clear();
  chosenTool = editor.tool;
});
const drop = () => pointers.forEach((each) => each.cancel());
/** @param {"undo" | "redo"} way @param {string} words */
const step = (way, words) => {
  drop();
  if (editor.step(way)) status.say(words);
};
const undo = () => step("undo", text.undone);
const redo = () => step("redo", text.redone);
const help = () => open($("help-dialog"));
/** @type {HTMLInputElement[]} */
const [newWidth, newHeight] = [$("new-width"), $("new-height")];
const sides = /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-side]"));
const showSide = () => {
  for (const each of sides) {
    each.setAttribute("aria-pressed", String([newWidth, newHeight].every(({ value }) => value === each.dataset.side)));
  }
};
const create = async () => {
  if (!(await projects.mayLeave()) || !(await open($("new-dialog")))) return;
  projects.create(newWidth.valueAsNumber, newHeight.valueAsNumber);
};
const escape = () => {
  const card = /** @type {HTMLDetailsElement | null} */ (document.querySelector("details[open]"));
  if (card) {
    card.open = false;
    card.querySelector("summary")?.focus();
    return;
  }
  drop();
  status.clear();
  editor.set({ chosen: -1, area: -1, suggestions: [], selection: NOTHING });
};
/** Returns the visible pane and its centre. */
const middle = () => {
  const { camera } = board.visible ? board : overlay;
  return { camera, x: camera.pane.width / 2, y: camera.pane.height / 2 };
};
/** @param {number} factor */
const zoom = (factor) => {
  const { camera, x, y } = middle();
  camera.zoom(x, y, factor);
};
// All repeats should be visible.
result.onLook = (/** @type {"tiled" | "pixelated"} */ way) => {
  if (way !== "tiled") return;
  view.fit();
  if (result.look.tiled) zoom(1 / 3);
};
/** @param {number} degrees */
const turn = (degrees) => {
  const { camera, x, y } = middle();
  camera.turn(x, y, (degrees * Math.PI) / 180);
};
editor.addEventListener("open", () => {
  drop(); // a stroke begun on the previous drawing
  view.fit();
});
const remove = () => {
  if (editor.tool !== "select") points.remove();
  else select.remove();
};
$("select-remove").addEventListener("click", remove);
const clicks = {
  new: create, open: () => projects.choose(), save: () => projects.save(), "save-as": () => projects.saveAs().then((saved) => saved && /** @type {HTMLDialogElement} */ ($("open-dialog")).close()),
  import: () => importing.pick(), export: () => exporting.ask(), "lit-save": () => exporting.saveLit(), undo, redo, help,
  "zoom-in": () => zoom(1.25), "zoom-out": () => zoom(0.8), "zoom-fit": () => view.fit(),
};
for (const [id, action] of Object.entries(clicks)) $(id).addEventListener("click", action);
const letters = { p: "pen", e: "eraser", s: "select", h: "hint", r: "region", d: "brush", m: "mask", b: "fill", l: "light", v: "hand" };
followKeys({
  ...Object.fromEntries(Object.entries(letters).map(([key, tool]) => [key, () => editor.set({ tool, area: -1, suggestions: [] })])),
  ...Object.fromEntries(VIEWS.map((view, i) => [String(i + 1), () => result.show(view)])),
  "[": () => widen(editor, -1), "]": () => widen(editor, 1),
  "ctrl+z": undo, "ctrl+shift+z": redo, "ctrl+y": redo,
  "ctrl+s": clicks.save, "ctrl+o": clicks.open, "ctrl+i": clicks.import, "ctrl+e": clicks.export,
  "+": clicks["zoom-in"], "=": clicks["zoom-in"], "-": clicks["zoom-out"], 0: clicks["zoom-fit"],
  f: () => panes.enlarge("result"), "shift+f": () => panes.enlarge("drawing"), c: () => panes.compare(), o: () => panes.overlay(),
  x: () => editor.set(editor.fills ? { fills: false } : { adds: !editor.adds }),
  a: () => editor.set({ tool: "mask", fills: true }),
  z: () => turnCarving(editor),
  w: () => brush.turnTo("smooth"), "shift+w": () => brush.turnTo("structure"), "shift+g": () => brush.next(),
  u: () => brush.change("soft", 1), "shift+u": () => brush.change("soft", -1),
  i: () => brush.change("strength", 1), "shift+i": () => brush.change("strength", -1),
  q: () => editor.set({ tool: "select", lassoes: editor.tool !== "select" || !editor.lassoes }), j: () => arranging.toLayer("new"),
  PageUp: () => layers.step(1), PageDown: () => layers.step(-1),
  ",": () => turn(-15), ".": () => turn(15),
  g: () => forms.next(), t: () => result.turnOver("tiled"), k: () => result.turnOver("pixelated"),
  n: () => points.next(1), "shift+n": () => points.next(-1),
  y: () => editor.set({ symmetry: !editor.symmetry }), "ctrl+a": () => select.all(), "ctrl+d": () => arranging.duplicate(), Delete: remove, Backspace: remove, Escape: escape, "?": help,
});
for (const button of sides) {
  button.addEventListener("click", () => {
    newWidth.value = newHeight.value = button.dataset.side ?? "";
    showSide();
  });
}
for (const each of [newWidth, newHeight]) each.addEventListener("input", showSide);
showSide();
for (const cancel of document.querySelectorAll("[data-close]")) {
  cancel.addEventListener("click", () => cancel.closest("dialog")?.close(""));
}
const rows = SHOWN.map(([keys, words]) => make("tr", {}, make("td", {}, ...keys.split("  ").flatMap((key) => [make("kbd", { text: key }), " "])), make("td", { text: wordsOf(words) })));
$("keys").replaceChildren(...rows);

teach(editor, predictor, result);
const served = about().then(({ version, model, exports }) => {
  if (exports) exporting.offer(exports);
  if (exports && !("height" in exports)) result.withoutRelief();
  $("about").textContent = say("about", { version, model: model.name });
  status.ready();
}).catch((error) => status.fail(error));
await begin({ projects, importing, autosave, status });
await served;
document.documentElement.dataset.ready = "true";
