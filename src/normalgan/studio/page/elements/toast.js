/** Toast: shows a completed action for some seconds, with buttons to change it. Only one is shown at a time. */

import { $, make } from "./dom.js";

/** Milliseconds for which a toast is shown; longer while the pointer or the focus is on it. */
const STAYS = 12_000;

/** Pixels between a toast and the messages above it. */
const GAP = 12;

/** Raises the messages at the foot of a pane, which a toast would cover. @param {number} pixels */
const makeRoom = (pixels) => document.documentElement.style.setProperty("--toast", `${pixels}px`);

/** Removes the current toast. */
let end = () => {};

/**
 * Shows a message with buttons.
 * @param {string} words
 * @param {{text: string, act: () => void}[]} ways
 * @param {() => void} [ended] called when it disappears without a button having been pressed
 */
export function toast(words, ways, ended = () => {}) {
  end();
  const box = $("toast");
  let timer = 0;
  /** @param {() => void} then */
  const close = (then) => {
    clearTimeout(timer);
    end = () => {};
    box.hidden = true;
    makeRoom(0);
    then();
  };
  const wait = () => {
    clearTimeout(timer);
    timer = setTimeout(() => (box.matches(":hover, :focus-within") ? wait() : close(ended)), STAYS);
  };
  end = () => close(ended);
  const buttons = ways.map(({ text, act }) => {
    const button = make("button", { type: "button", text });
    button.addEventListener("click", () => close(act));
    return button;
  });
  $("toast-words").textContent = words;
  $("toast-ways").replaceChildren(...buttons);
  // Behind an open dialog, the buttons could not be pressed.
  const page = document.querySelector("main");
  const dialog = document.querySelector("dialog[open]");
  (dialog ?? page)?.append(box);
  dialog?.addEventListener("close", () => page?.append(box), { once: true });
  box.hidden = false;
  makeRoom(box.offsetHeight + GAP);
  wait();
}
