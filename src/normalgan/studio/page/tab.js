/** Tab: an id for each time the page is loaded, and which of them are still open. */

const LOCK = "normalgan-tab-";

/** Returns a new id, held as long as the page lives. @returns {Promise<string>} */
export async function claimTab() {
  const bytes = crypto.getRandomValues(new Uint8Array(9));
  const id = Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  await /** @type {Promise<void>} */ (new Promise((resolve) => {
    navigator.locks.request(LOCK + id, () => {
      resolve();
      return new Promise(() => {});
    });
  }));
  return id;
}

/** Returns the ids of the pages that are open. @returns {Promise<Set<string>>} */
export async function openTabs() {
  const { held = [] } = await navigator.locks.query();
  return new Set(held.map(({ name = "" }) => name.replace(LOCK, "")));
}
