/** Start: opens the files named on the command line or shown in the tab before, and offers unsaved work. */

import { isEmpty, parseDocument, picturesOf } from "../drawing/document.js";
import { linesAt } from "../drawing/ink.js";
import { decodeAll } from "../drawing/pictures.js";
import { choose } from "../elements/dialogs.js";
import { $, label, make, open } from "../elements/dom.js";
import { icon } from "../elements/icons.js";
import { tabRecalls, tabRemembers } from "../elements/settings.js";
import { toast } from "../elements/toast.js";
import { named, namedFile } from "../server/api.js";
import { say, text } from "../text/text.js";
import { unsaved } from "./autosave.js";
import { drawFitted } from "./gallery.js";
import { hold, openTabs } from "./tab.js";

/** @typedef {{projects: import("./projects.js").Projects, importing: import("./importing.js").Importing,
 *   autosave: import("./autosave.js").Autosave, status: import("../elements/status.js").Status}} Parts */

const OPENED = "normalgan-opened";
/** Side of the thumbnails of unsaved work. */
const SMALL = 96;

/**
 * Opens the files named on the command line, or the tab's previous document, and then offers unsaved work.
 * @param {Parts} parts
 */
export async function begin(parts) {
  const { projects, importing, status, autosave } = parts;
  const before = autosave.previousTab();
  try {
    // Only once per tab: after a reload, unsaved changes to it are offered instead.
    const again = tabRecalls(OPENED) !== null;
    const first = again ? null : await named().catch((error) => status.fail(error));
    if (again) await projects.reopen();
    if (first !== undefined) tabRemembers(OPENED, "yes");
    if (first?.kind === "project") await projects.open(first.name);
    if (first?.kind === "document") await projects.load(first.document, null, false);
    if (first?.kind === "drawing") {
      const file = await namedFile(first.name);
      const found = await importing.read(file);
      // For a file with layers or pages the user is asked how to import it, and the page is ready meanwhile.
      const asks = found.layers !== null || found.parts > 1;
      const placed = importing.put(found, asks ? "" : "drawing", file);
      if (asks) placed.catch((error) => status.fail(error));
      else await placed;
    }
  } catch (error) {
    status.fail(error);
  }
  try {
    const tabs = await openTabs();
    const { left, failed } = await unsaved(tabs);
    if (failed) status.say(say("storageUnread", { reason: /** @type {Error} */ (failed).message }), "lasting");
    await offer(left, parts, tabs !== null, before);
  } catch (error) {
    status.fail(error);
  }
}

/** @typedef {import("./autosave.js").Left} Left @typedef {import("./autosave.js").Found} Found */
/** @type {Left[]} the remaining unsaved work */
let offered = [];

/**
 * Restores unsaved work if it is this tab's own or the only one, and nothing would be lost; otherwise offers the newest and a list.
 * @param {Left[]} found @param {Parts} parts @param {boolean} sure whether no other tab can be working on it
 * @param {string | null} [before] tab whose work was shown here before a reload
 */
async function offer(found, parts, sure, before = null) {
  offered = found;
  $("restore-yes").onclick = $("restore-no").onclick = $("restore-all").onclick = null;
  const acts = actsOf(parts);
  const button = $("open-unsaved");
  button.onclick = () => {
    /** @type {HTMLDialogElement} */ ($("open-dialog")).close();
    acts.said(() => list(offered, acts));
  };
  noteCount();
  if (!found.length) return;
  const own = found.find(({ tab }) => tab === before);
  let newest = own ?? found[0];
  let about = await described(newest);
  for (const other of found) {
    if (!about.problem) break;
    const next = await described(other);
    if (!next.problem) [newest, about] = [other, next];
  }
  const { name, when, problem, read } = about;
  // Work that only the server has may belong to another open browser.
  if ((found.length === 1 || newest === own) && sure && newest.here && read && !read.missing && fits(read, parts)) {
    await restoreAtOnce(newest, read, about, parts);
    return;
  }
  $("restore-words").textContent = problem ? say("unreadable", { when, reason: problem }) : say("restoreAsk", { name, when });
  $("restore-picture").replaceChildren(about.picture);
  $("restore-yes").hidden = problem !== "";
  $("restore-all").hidden = found.length < 2;
  $("restore-all").textContent = say("restoreAll", { count: found.length });
  $("restore-yes").onclick = () => acts.said(() => acts.restore(newest));
  $("restore-no").onclick = () => acts.said(() => acts.discard([newest]));
  $("restore-all").onclick = () => acts.said(() => list(offered, acts));
  $("restore-later").onclick = () => {
    $("restore").hidden = true;
    parts.status.say(text.keptForLater);
  };
  $("restore").hidden = false;
}

/** Shows the amount of unsaved work in the dialog for opening projects. */
function noteCount() {
  $("open-unsaved").hidden = !offered.length;
  $("open-unsaved").textContent = say("unsavedWork", { count: offered.length });
  if (!offered.length) $("restore").hidden = true;
}

/** Whether unsaved work continues the current document, which is empty or the project that the work is based on. @param {Found} read @param {Parts} parts */
function fits({ doc, etag }, { projects, autosave }) {
  if (autosave.unsaved) return false;
  const { editor } = projects;
  if (isEmpty(editor.doc) && editor.history.states.length === 1) return true;
  return etag !== null && etag === projects.etag && /** @type {any} */ (doc).settings?.name === projects.name;
}

/**
 * Restores unsaved work without asking. Its backup is kept until something is drawn.
 * @param {Left} left @param {Found} read @param {{name: string, when: string}} about @param {Parts} parts
 */
async function restoreAtOnce(left, read, { name, when }, { projects, autosave, status }) {
  const others = offered.filter((each) => each !== left);
  const release = await hold(left.tab);
  if (!release) { // a tab that opened at the same time has it
    offered = others;
    noteCount();
    return;
  }
  const { editor } = projects;
  const before = { doc: editor.history.state, etag: projects.etag, past: { states: [...editor.history.states], at: editor.history.at } };
  let loaded = false;
  try {
    loaded = await projects.load(read.doc, read.etag, true, read.past);
  } finally {
    if (!loaded) release();
  }
  if (!loaded) return;
  autosave.borrow(left, release);
  offered = others;
  noteCount();
  const back = async () => {
    // Changes since then belong to this tab, and the user is asked about them.
    if (autosave.borrowed === left) {
      autosave.putBack();
      offered = [left, ...others];
      noteCount();
    }
    if (await projects.load(before.doc, before.etag, true, before.past)) status.say(text.keptForLater);
  };
  toast(say("restoredOne", { name, when }), [{ text: text.notNow, act: () => { back().catch((error) => status.fail(error)); } }]);
}

/** @typedef {ReturnType<typeof actsOf>} Acts */
/** Returns the actions for unsaved work. @param {Parts} parts */
function actsOf(parts) {
  const { projects, autosave, status } = parts;
  /** @param {() => Promise<void>} work */
  const said = (work) => work().catch((/** @type {unknown} */ error) => status.fail(error));
  /** @param {Left} left */
  const restore = async (left) => {
    if (!(await projects.mayLeave())) return;
    const release = await hold(left.tab);
    if (!release) {
      await offer(offered.filter((each) => each !== left), parts, false);
      status.say(text.heldElsewhere, "warning");
      return;
    }
    /** @type {Found | null} */
    let found = null;
    try {
      const read = await left.read();
      if (await projects.load(read.doc, read.etag, false, read.past)) found = read;
    } finally {
      if (!found || found.missing) release();
    }
    if (!found) return;
    const { missing } = found;
    // The work now belongs to this tab. The old backup is deleted once this tab has its own, unless part of it could not be read.
    if ((await autosave.secure()) && !missing) await autosave.drop(left);
    offered = offered.filter((each) => each !== left || missing);
    noteCount();
    $("restore").hidden = true;
    status.say(missing ? say("restoredPart", { count: missing }) : text.restored, missing ? "loss" : "");
  };
  /** Discards work after confirmation; it can be undone while the toast is shown. @param {Left[]} dropped @returns {Promise<void>} */
  const discard = async (dropped) => {
    const { name, when } = await described(dropped[0]);
    const one = dropped.length === 1;
    const asked = one ? say("discardAsk", { name, when }) : say("discardAllAsk", { count: dropped.length });
    if (!(await choose(text.discardTitle, asked, [{ value: "drop", text: text.discard }]))) return;
    const before = offered;
    await offer(offered.filter((left) => !dropped.includes(left)), parts, false);
    const undo = () => { said(() => offer(before, parts, false)); };
    const gone = () => { said(async () => {
      for (const left of dropped) {
        const release = await hold(left.tab);
        if (!release) continue; // another tab shows it
        await autosave.drop(left).finally(release);
      }
    }); };
    toast(one ? say("discarded", { name }) : say("discardedAll", { count: dropped.length }), [{ text: text.undoIt, act: undo }], gone);
  };
  return { restore, discard, said };
}

/**
 * Shows a dialog of all unsaved work with name, time and thumbnail.
 * @param {Left[]} found @param {Acts} acts
 */
async function list(found, { restore, discard, said }) {
  /** @type {HTMLDialogElement} */
  const dialog = $("restore-dialog");
  const rows = await Promise.all(found.map(async (left) => {
    const { name, when, picture, problem } = await described(left);
    const open = make("button", { type: "button", class: "project" }, picture, make("strong", { text: name }), make("span", { text: problem || when }));
    open.addEventListener("click", () => {
      dialog.close();
      said(() => restore(left));
    });
    const remove = make("button", { type: "button" }, icon("remove"));
    label(remove, say("discardOne", { name, when }));
    remove.addEventListener("click", () => {
      dialog.close();
      said(() => discard([left]));
    });
    return make("li", {}, open, remove);
  }));
  $("restore-list").replaceChildren(...rows);
  if ((await open(dialog)) === "drop") await discard(offered);
}

/**
 * Returns the name, time and thumbnail of unsaved work, or why it cannot be read.
 * @param {Left} left
 */
async function described({ name, changed, read }) {
  const when = changed ? new Date(changed).toLocaleString([], { dateStyle: "medium", timeStyle: "short" }) : text.unknownTime;
  const picture = make("canvas", { class: "small", width: SMALL, height: SMALL, "aria-hidden": "true" });
  let [called, problem] = [name, ""];
  /** @type {Found | null} */
  let found = null;
  try {
    found = await read();
    const doc = parseDocument(found.doc);
    called = doc.settings.name || called;
    await decodeAll(picturesOf(doc));
    drawFitted(picture, linesAt(doc, SMALL, true));
  } catch (error) {
    problem = /** @type {Error} */ (error).message;
  }
  return { name: called || text.untitled, when, picture, problem, read: problem ? null : found };
}
