/** Small helpers for the page's elements. */

import { wordsOf } from "../text/text.js";
import { icon } from "./icons.js";

/** @template {HTMLElement} T @param {string} id @returns {T} */
export const $ = (id) => /** @type {T} */ (document.getElementById(id));

/** A field of a form. @param {string} id @returns {HTMLInputElement} */
export const field = (id) => $(id);

/**
 * Returns the field that an event goes to. A dialog that closes leaves the focus on its field until the next frame; nobody
 * types there any more.
 * @param {Event} event @param {string} kinds of fields, as a selector
 * @returns {Element | null}
 */
export function fieldOf({ target }, kinds) {
  const found = target instanceof Element ? target.closest(kinds) : null;
  return found?.getClientRects().length ? found : null;
}

/** Enables or disables a button. @param {string} id @param {boolean} enabled */
export const enable = (id, enabled) => { /** @type {HTMLButtonElement} */ ($(id)).disabled = !enabled; };

/**
 * Makes an element.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, unknown>} [properties] `class`, `text`, attributes with a dash, or properties
 * @param {...(Node | string)} children
 */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key === "class") element.className = String(value);
    else if (key === "text") element.textContent = String(value);
    else if (key.includes("-") || key === "role") element.setAttribute(key, String(value));
    else Object.assign(element, { [key]: value });
  }
  element.append(...children);
  return element;
}

/** Fills in the texts and icons of elements with `data-text`, `data-label` or `data-icon`. */
export function fill(root = document) {
  /** @param {"icon" | "text" | "label"} kind @param {(element: HTMLElement, name: string) => void} put */
  const each = (kind, put) => {
    for (const element of /** @type {NodeListOf<HTMLElement>} */ (root.querySelectorAll(`[data-${kind}]`))) {
      put(element, element.dataset[kind] ?? "");
    }
  };
  each("icon", (element, name) => element.prepend(icon(name)));
  each("text", (element, name) => element.append(wordsOf(name)));
  each("label", (element, name) => label(element, wordsOf(name)));
  // Buttons that show their text need no other name; their tooltip only shows the shortcut.
  for (const element of /** @type {NodeListOf<HTMLElement>} */ (root.querySelectorAll("[data-keys]:not([data-label])"))) element.title = element.dataset.keys ?? "";
}

/** Sets the tooltip and the accessible name of an element. @param {Element} element @param {string} words */
export function label(element, words) {
  element.setAttribute("aria-label", words);
  if (!element.matches("button, summary, input, select")) return;
  const keys = /** @type {HTMLElement} */ (element).dataset.keys;
  element.setAttribute("title", keys ? `${words} (${keys})` : words);
}

/** Downloads a file. @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  make("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/**
 * Opens a dialog and returns the value it was closed with; "" if it was dismissed.
 * @param {HTMLDialogElement} dialog
 * @returns {Promise<string>}
 */
export function open(dialog) {
  dialog.returnValue = "";
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue), { once: true });
  });
}
