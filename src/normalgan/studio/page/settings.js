/** Settings: what this browser remembers of how somebody works. Where it cannot, nothing is lost but that. */

/**
 * Returns what was remembered.
 * @param {string} key
 * @returns {any} null if nothing was, or if it cannot be read
 */
export function recalled(key) {
  try {
    return JSON.parse(localStorage.getItem(key) ?? "null");
  } catch {
    return null; // something else wrote there, or the browser keeps nothing
  }
}

/** Remembers a value, unless the browser's storage is full or closed. @param {string} key @param {unknown} value */
export function remember(key, value) {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch {
    // The next page begins with what is usual.
  }
}
