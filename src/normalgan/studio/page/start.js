/** Start: what the command line named is opened, and unsaved work is offered. */

import { named } from "./api.js";
import { unsaved } from "./autosave.js";
import { $ } from "./dom.js";
import { openTabs } from "./tab.js";
import { say, text } from "./text.js";

/** @typedef {{projects: import("./projects.js").Projects, importing: import("./importing.js").Importing,
 *   autosave: import("./autosave.js").Autosave, status: import("./status.js").Status}} Parts */

const OPENED = "normalgan-opened";

/**
 * Opens what the command line named, then offers unsaved work.
 * @param {Parts} parts
 */
export async function begin(parts) {
  const { projects, importing, status } = parts;
  try {
    // Once in a tab: a page that is loaded again offers what was made of it since.
    const first = sessionStorage.getItem(OPENED) ? null : await named().catch((error) => status.fail(error));
    if (first !== undefined) sessionStorage.setItem(OPENED, "yes");
    if (first?.kind === "project") await projects.open(first.name);
    if (first?.kind === "document") await projects.load(first.document, null, false);
    if (first?.kind === "drawing") {
      const url = `data:image/png;base64,${first.picture}`;
      await importing.place(url, first.width, first.height, "drawing", first.name);
    }
    await offer(await unsaved(await openTabs()), parts);
  } catch (error) {
    status.fail(error);
  }
}

/** Offers the newest unsaved work; where it is dropped, the next. */
async function offer(found, parts) {
  const banner = $("restore");
  const [newest, ...older] = found;
  banner.hidden = !newest;
  if (!newest) return;
  const when = new Date(newest.changed).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
  $("restore-words").textContent = say("restoreAsk", { when });
  const { projects, autosave, status } = parts;
  $("restore-yes").onclick = async () => {
    try {
      if (!(await projects.mayLeave())) return;
      await projects.load(await newest.read(), null, false);
      // It is this tab's now, and kept under its name before the old one goes.
      await autosave.flush();
      await autosave.drop(newest.tab, newest.there);
      banner.hidden = true;
      status.say(text.restored);
    } catch (error) {
      status.fail(error);
    }
  };
  $("restore-no").onclick = async () => {
    try {
      await autosave.drop(newest.tab, newest.there);
      await offer(older, parts);
    } catch (error) {
      status.fail(error);
    }
  };
}
