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

/** Returns what this tab remembers, also when its page is loaded again; null if nothing. @param {string} key @returns {string | null} */
export function tabRecalls(key) {
  try {
    return sessionStorage.getItem(key);
  } catch {
    return null; // the browser was told to keep nothing
  }
}

/** Has this tab remember a value, or forget it. @param {string} key @param {string | null} value */
export function tabRemembers(key, value) {
  try {
    if (value === null) sessionStorage.removeItem(key);
    else sessionStorage.setItem(key, value);
  } catch {
    // The page begins with an empty drawing when it is loaded again.
  }
}
