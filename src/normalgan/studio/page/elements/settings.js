/** Settings: remember preferences in the browser, if it allows that. */

/**
 * Returns a remembered value.
 * @param {string} key
 * @returns {any} null if nothing was, or if it cannot be read
 */
export function recalled(key) {
  try {
    return JSON.parse(localStorage.getItem(key) ?? "null");
  } catch {
    return null; // another program wrote this value, or the browser stores nothing
  }
}

/** Remembers a value, unless the browser's storage is full or closed. @param {string} key @param {unknown} value */
export function remember(key, value) {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch {
    // The next page then starts with the defaults.
  }
}

/** Returns a value that this tab remembers across reloads; null if there is none. @param {string} key @returns {string | null} */
export function tabRecalls(key) {
  try {
    return sessionStorage.getItem(key);
  } catch {
    return null; // storage is disabled in the browser
  }
}

/** Makes this tab remember a value or forget it. @param {string} key @param {string | null} value */
export function tabRemembers(key, value) {
  try {
    if (value === null) sessionStorage.removeItem(key);
    else sessionStorage.setItem(key, value);
  } catch {
    // After a reload, the page then starts with an empty drawing.
  }
}
