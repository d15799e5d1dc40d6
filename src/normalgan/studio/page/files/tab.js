/** Tab: an id for each time the page is loaded, and which of them are still open. */

const LOCK = "normalgan-tab-";

/** Returns a new id, held as long as the page lives; a browser that was told to keep nothing may hold none. @returns {Promise<string>} */
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

/** Returns the ids of the pages that are open; null if the browser does not say. @returns {Promise<Set<string> | null>} */
export async function openTabs() {
  const { held } = await navigator.locks.query().catch(() => ({ held: undefined }));
  return held ? new Set(held.map(({ name = "" }) => name.replace(LOCK, ""))) : null;
}
