/** Small helpers for the page's elements. */

import { icon } from "./icons.js";
import { text } from "./text.js";

/** @template {HTMLElement} T @param {string} id @returns {T} */
export const $ = (id) => /** @type {T} */ (document.getElementById(id));

/**
 * Makes an element.
 * @param {string} tag
 * @param {Record<string, unknown>} [properties] `class`, `text`, attributes with a dash, or properties
 * @param {...(Node | string)} children
 */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key === "class") element.className = String(value);
    else if (key === "text") element.textContent = String(value);
    else if (key.includes("-") || key === "role") element.setAttribute(key, String(value));
    else element[key] = value;
  }
  element.append(...children);
  return element;
}

/** Puts words and icons into elements that name them by `data-text`, `data-label` and `data-icon`. */
export function fill(root = document) {
  for (const each of root.querySelectorAll("[data-icon]")) each.prepend(icon(each.dataset.icon));
  for (const each of root.querySelectorAll("[data-text]")) {
    each.append(text[each.dataset.text]);
  }
  for (const each of root.querySelectorAll("[data-label]")) label(each, text[each.dataset.label]);
}

/** Names an element for the eye and for screen readers. @param {Element} element @param {string} words */
export function label(element, words) {
  element.setAttribute("aria-label", words);
  if (element.matches("button, summary, input, select")) element.setAttribute("title", words);
}

/** Hands a file to the browser's downloads. @param {Blob} blob @param {string} name */
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
