/** Tab: an id for each loaded page, and the ids of pages that are still open. */

const LOCK = "normalgan-tab-";

/** Returns a new id, locked as long as the page lives, if the browser supports it. @returns {Promise<string>} */
export async function claimTab() {
  const bytes = crypto.getRandomValues(new Uint8Array(9));
  const id = Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  await /** @type {Promise<void>} */ (new Promise((resolve) => {
    navigator.locks.request(LOCK + id, () => {
      resolve();
      return new Promise(() => {});
    }).catch(() => resolve());
  }));
  return id;
}

/** Returns the ids of open pages; null if the browser does not report them. @returns {Promise<Set<string> | null>} */
export async function openTabs() {
  const { held } = await navigator.locks.query().catch(() => ({ held: undefined }));
  return held ? new Set(held.map(({ name = "" }) => name.replace(LOCK, ""))) : null;
}
