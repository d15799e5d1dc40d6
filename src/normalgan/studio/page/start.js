/** Start: what the command line named or the tab showed is opened, and unsaved work is offered. */

import { named } from "./api.js";
import { unsaved } from "./autosave.js";
import { context2d } from "./canvas.js";
import { parseDocument, picturesOf } from "./document.js";
import { $, label, make, open } from "./dom.js";
import { icon } from "./icons.js";
import { linesAt } from "./ink.js";
import { decodeAll } from "./pictures.js";
import { tabRecalls, tabRemembers } from "./settings.js";
import { openTabs } from "./tab.js";
import { say, text } from "./text.js";

/** @typedef {{projects: import("./projects.js").Projects, importing: import("./importing.js").Importing,
 *   autosave: import("./autosave.js").Autosave, status: import("./status.js").Status}} Parts */

const OPENED = "normalgan-opened";
/** Side of the small pictures of unsaved work. */
const SMALL = 96;

/**
 * Opens what the command line named, or again what the tab showed, then offers unsaved work.
 * @param {Parts} parts
 */
export async function begin(parts) {
  const { projects, importing, status } = parts;
  try {
    // Once in a tab: a page that is loaded again offers what was made of it since.
    const again = tabRecalls(OPENED) !== null;
    const first = again ? null : await named().catch((error) => status.fail(error));
    if (again) await projects.reopen();
    if (first !== undefined) tabRemembers(OPENED, "yes");
    if (first?.kind === "project") await projects.open(first.name);
    if (first?.kind === "document") await projects.load(first.document, null, false);
    if (first?.kind === "drawing") {
      const { picture, width, height, given, layers } = first;
      const read = layers && (async () => {
        if (layers.error) throw new Error(layers.error);
        return layers;
      });
      const placed = importing.place({ picture, width, height, given, layers: read }, read ? "" : "drawing", first.name);
      // A file with layers asks as what it is to come in, and the page is ready meanwhile.
      if (read) placed.catch((error) => status.fail(error));
      else await placed;
    }
  } catch (error) {
    status.fail(error);
  }
  try {
    const { left, failed } = await unsaved(await openTabs());
    if (failed) status.say(say("storageUnread", { reason: /** @type {Error} */ (failed).message }), "error");
    await offer(left, parts);
  } catch (error) {
    status.fail(error);
  }
}

/** @typedef {import("./autosave.js").Left} Left */
/** @type {Left[]} what is left to be offered */
let offered = [];

/**
 * Offers the newest unsaved work, and a list of all where there is more.
 * @param {Left[]} found @param {Parts} parts
 */
async function offer(found, parts) {
  offered = found;
  const banner = $("restore");
  banner.hidden = !found.length;
  if (!found.length) return;
  const { projects, autosave, status } = parts;
  let [newest] = found;
  let about = await described(newest);
  for (const other of found.slice(1)) {
    if (!about.problem) break;
    const next = await described(other);
    if (!next.problem) [newest, about] = [other, next];
  }
  const { name, when, problem } = about;
  $("restore-words").textContent = problem ? say("unreadable", { when, reason: problem }) : say("restoreAsk", { name, when });
  $("restore-picture").replaceChildren(about.picture);
  $("restore-yes").hidden = problem !== "";
  $("restore-all").hidden = found.length < 2;
  $("restore-all").textContent = say("restoreAll", { count: found.length });
  /** @param {Left} left */
  const restore = async (left) => {
    if (!(await projects.mayLeave())) return;
    const { doc, etag, past, missing } = await left.read();
    if (!(await projects.load(doc, etag, false, past))) return;
    // It is this tab's now. The old one goes once it is kept under this one's name, and never what could not be read.
    if ((await autosave.secure()) && !missing) await autosave.drop(left);
    banner.hidden = true;
    status.say(missing ? say("restoredPart", { count: missing }) : text.restored, missing ? "warning" : "");
  };
  /** @param {Left[]} dropped */
  const drop = async (dropped) => {
    for (const left of dropped) await autosave.drop(left);
    await offer(offered.filter((left) => !dropped.includes(left)), parts);
  };
  /** @param {() => Promise<void>} work */
  const said = (work) => work().catch((/** @type {unknown} */ error) => status.fail(error));
  $("restore-yes").onclick = () => said(() => restore(newest));
  $("restore-no").onclick = () => said(() => drop([newest]));
  $("restore-all").onclick = () => said(() => list(found, { restore, drop, said }));
}

/**
 * Shows all unsaved work to choose from, each with its name, time and picture.
 * @param {Left[]} found
 * @param {{restore: (left: Left) => Promise<void>, drop: (left: Left[]) => Promise<void>, said: (work: () => Promise<void>) => Promise<void>}} acts
 */
async function list(found, { restore, drop, said }) {
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
    remove.addEventListener("click", async () => {
      remove.closest("li")?.remove();
      await drop([left]);
      if (!$("restore-list").children.length) dialog.close();
    });
    return make("li", {}, open, remove);
  }));
  $("restore-list").replaceChildren(...rows);
  if ((await open(dialog)) === "drop") await drop(offered);
}

/**
 * Returns what unsaved work is called, when it was changed, a small picture of it, and why it cannot be read, if so.
 * @param {Left} left
 */
async function described({ name, changed, read }) {
  const when = changed ? new Date(changed).toLocaleString([], { dateStyle: "medium", timeStyle: "short" }) : text.unknownTime;
  const picture = make("canvas", { class: "small", width: SMALL, height: SMALL, "aria-hidden": "true" });
  let [called, problem] = [name, ""];
  try {
    const doc = parseDocument((await read()).doc);
    called = doc.settings.name || called;
    await decodeAll(picturesOf(doc));
    draw(picture, doc);
  } catch (error) {
    problem = /** @type {Error} */ (error).message;
  }
  return { name: called || text.untitled, when, picture, problem };
}

/** Draws a document as large as fits. @param {HTMLCanvasElement} canvas @param {import("./document.js").Doc} doc */
function draw(canvas, doc) {
  const lines = linesAt(doc, SMALL);
  context2d(canvas).drawImage(lines, (SMALL - lines.width) / 2, (SMALL - lines.height) / 2);
}
