/** Dialogs that ask one question. */

import { $, make, open } from "./dom.js";
import { text } from "./text.js";

/**
 * Asks to choose between ways to go on.
 * @param {string} title
 * @param {string} body
 * @param {{value: string, text: string, strong?: boolean}[]} ways besides cancelling
 * @param {Node} [more] shown below the words
 * @returns {Promise<string>} the value, or "" if it was dismissed
 */
export function choose(title, body, ways, more) {
  const dialog = $("choose");
  dialog.querySelector("h2").textContent = title;
  dialog.querySelector("p").textContent = body;
  dialog.querySelector(".more").replaceChildren(...(more ? [more] : []));
  const buttons = ways.map(({ value, text: words, strong }) =>
    make("button", { value, text: words, class: strong ? "strong" : "", autofocus: Boolean(strong) }));
  dialog.querySelector(".ways").replaceChildren(make("button", { value: "", text: text.cancel }), ...buttons);
  return open(dialog);
}

/**
 * Asks for a project's name.
 * @param {string} before
 * @returns {Promise<string>} the name, or "" if it was dismissed
 */
export async function askName(before) {
  const field = $("name-field");
  field.value = before;
  const answer = open($("save-dialog"));
  field.select();
  return (await answer) ? field.value.trim() : "";
}
