/** Dialogs that ask one question. */

import { text } from "../text/text.js";
import { $, make, open } from "./dom.js";

/** The current or last question. @type {Promise<unknown>} */
let asked = Promise.resolve();

/**
 * Asks the user to choose an option, after any previous question has been answered; all questions share one dialog.
 * @param {string} title
 * @param {string} body
 * @param {{value: string, text: string, strong?: boolean}[]} ways besides cancelling
 * @param {Node} [more] shown below the words
 * @returns {Promise<string>} the value, or "" if it was dismissed
 */
export function choose(title, body, ways, more) {
  const answer = asked.then(() => ask(title, body, ways, more));
  asked = answer.catch(() => {}); // reported to the caller
  return answer;
}

/**
 * @param {string} title @param {string} body @param {{value: string, text: string, strong?: boolean}[]} ways
 * @param {Node} [more]
 */
function ask(title, body, ways, more) {
  /** @type {HTMLDialogElement} */
  const dialog = $("choose");
  /** @param {string} selector */
  const part = (selector) => /** @type {HTMLElement} */ (dialog.querySelector(selector));
  part("h2").textContent = title;
  part("p").textContent = body;
  part(".more").replaceChildren(...(more ? [more] : []));
  const buttons = ways.map(({ value, text: words, strong }) =>
    make("button", { value, text: words, class: strong ? "strong" : "", autofocus: Boolean(strong) }));
  part(".ways").replaceChildren(make("button", { value: "", text: text.cancel }), ...buttons);
  return open(dialog);
}

/**
 * Asks for a project's name.
 * @param {string} before @param {string} [title] @param {string} [yes] words of the button
 * @returns {Promise<string>} the name, or "" if it was dismissed
 */
export async function askName(before, title = text.saveTitle, yes = text.save) {
  /** @type {HTMLInputElement} */
  const field = $("name-field");
  field.value = before;
  $("save-title").textContent = title;
  $("save-yes").textContent = yes;
  const answer = open($("save-dialog"));
  field.select();
  return (await answer) ? field.value.trim() : "";
}
