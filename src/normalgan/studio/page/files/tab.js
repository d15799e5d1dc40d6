/** Tab: an id for each loaded page, and the ids that open pages hold: their own, and those of tabs whose work they show. */

const LOCK = "normalgan-tab-";

/** Returns a new id, held as long as the page lives, if the browser supports it. @returns {Promise<string>} */
export async function claimTab() {
  const bytes = crypto.getRandomValues(new Uint8Array(9));
  const id = Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  await hold(id);
  return id;
}

/**
 * Holds the id of a tab until it is released, or the page ends.
 * @param {string} id
 * @returns {Promise<(() => void) | null>} releases it; null if another page holds it
 */
export function hold(id) {
  return new Promise((resolve) => {
    navigator.locks.request(LOCK + id, { ifAvailable: true }, (lock) => {
      if (lock) return new Promise((release) => resolve(() => release(undefined)));
      return resolve(null);
    }).catch(() => resolve(() => {})); // the browser refuses locks
  });
}

/** Returns the ids that open pages hold; null if the browser does not report them. @returns {Promise<Set<string> | null>} */
export async function openTabs() {
  const { held } = await navigator.locks.query().catch(() => ({ held: undefined }));
  return held ? new Set(held.map(({ name = "" }) => name.replace(LOCK, ""))) : null;
}
