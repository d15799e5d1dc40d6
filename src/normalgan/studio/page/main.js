/** Main: puts the parts of the studio together. */

import { about } from "./api.js";
import { Autosave } from "./autosave.js";
import { Board } from "./board.js";
import { Connection } from "./connection.js";
import { $, fill, make, open } from "./dom.js";
import { Editor } from "./editor.js";
import { Exporting } from "./exporting.js";
import { Importing } from "./importing.js";
import { Ink } from "./ink.js";
import { followKeyboard } from "./keyboard_pen.js";
import { followLayer } from "./layers.js";
import { Painter } from "./painter.js";
import { followPointers } from "./pointer.js";
import { Points } from "./points.js";
import { Projects } from "./projects.js";
import { Result, VIEWS } from "./result.js";
import { begin } from "./start.js";
import { SHOWN, followKeys } from "./shortcuts.js";
import { Status } from "./status.js";
import { claimTab } from "./tab.js";
import { say, text, wordsOf } from "./text.js";
import { followTheme } from "./theme.js";
import { followTools, widen } from "./toolbar.js";
import { AreaTool, HintTool, LineTool } from "./tools.js";

fill();
followTheme($("theme"));
const tab = await claimTab();
const connection = new Connection();
const status = new Status(connection);
const editor = new Editor();
const ink = new Ink();
const board = new Board($("board"), $("sheet"), editor, ink);
const painter = new Painter(editor, ink, connection, tab);
const result = new Result(painter, status);
const autosave = new Autosave(editor, connection, tab);
const projects = new Projects(editor, autosave, status);
const importing = new Importing(editor, board, status, projects);
const exporting = new Exporting(editor, painter, status);
const lines = new LineTool(board);
const pins = new HintTool(board, () => painter.painted, (words) => status.say(words));
const areas = new AreaTool(board, () => painter.painted, (words) => status.say(words));
const points = new Points(board, pins, painter, status);
/** @type {Record<string, import("./tools.js").Tool | null>} */
const tools = { pen: lines, eraser: lines, hint: pins, region: areas, brush: areas, hand: null };
const tool = () => tools[editor.tool];
const pointers = followPointers(board, tool);
followKeyboard(board, tool, status);
followTools(editor, board);
followLayer(editor, importing);
autosave.addEventListener("failed", (event) => status.fail(/** @type {CustomEvent} */ (event).detail));

/** @param {"undo" | "redo"} way @param {string} words */
const step = (way, words) => {
  pointers.cancel();
  if (editor.step(way)) status.say(words);
};
const undo = () => step("undo", text.undone);
const redo = () => step("redo", text.redone);
const help = () => open($("help-dialog"));
/** @type {HTMLInputElement[]} */
const [newWidth, newHeight] = [$("new-width"), $("new-height")];
const create = async () => {
  if (!(await projects.mayLeave()) || !(await open($("new-dialog")))) return;
  projects.create(newWidth.valueAsNumber, newHeight.valueAsNumber);
};
const escape = () => {
  pointers.cancel();
  editor.set({ chosen: -1, area: -1, suggestions: [] });
};
const clicks = {
  new: create, open: () => projects.choose(), save: () => projects.save(), "save-as": () => projects.saveAs(),
  import: () => importing.pick(), export: () => exporting.ask(), undo, redo, help,
  "zoom-in": () => board.zoom(1.25), "zoom-out": () => board.zoom(0.8), "zoom-fit": () => board.fit(),
};
for (const [id, action] of Object.entries(clicks)) $(id).addEventListener("click", action);
const letters = { p: "pen", b: "pen", e: "eraser", h: "hint", r: "region", d: "brush", v: "hand" };
followKeys({
  ...Object.fromEntries(Object.entries(letters).map(([key, tool]) => [key, () => editor.set({ tool })])),
  ...Object.fromEntries(VIEWS.map((view, i) => [String(i + 1), () => result.show(view)])),
  "[": () => widen(editor, -1), "]": () => widen(editor, 1),
  "ctrl+z": undo, "ctrl+shift+z": redo, "ctrl+y": redo,
  "ctrl+s": clicks.save, "ctrl+o": clicks.open, "ctrl+i": clicks.import, "ctrl+e": clicks.export,
  "+": clicks["zoom-in"], "=": clicks["zoom-in"], "-": clicks["zoom-out"], 0: clicks["zoom-fit"],
  n: () => points.next(1), "shift+n": () => points.next(-1),
  Delete: () => points.remove(), Backspace: () => points.remove(), Escape: escape, "?": help,
});
for (const button of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-side]"))) {
  button.addEventListener("click", () => {
    newWidth.value = newHeight.value = button.dataset.side ?? "";
  });
}
for (const cancel of document.querySelectorAll("[data-close]")) {
  cancel.addEventListener("click", () => cancel.closest("dialog")?.close(""));
}
const rows = SHOWN.map(([keys, words]) => make("tr", {}, make("td", {}, ...keys.split("  ").flatMap((key) => [make("kbd", { text: key }), " "])), make("td", { text: wordsOf(words) })));
$("keys").replaceChildren(...rows);

const served = await about().catch((error) => status.fail(error));
if (served) $("about").textContent = say("about", { version: served.version, model: served.model.name });
await begin({ projects, importing, autosave, status });
document.documentElement.dataset.ready = "true";
