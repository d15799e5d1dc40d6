/** Sheets: panels that open with a button in small windows; in wide windows they are always visible and the button is hidden. */

import { $ } from "./dom.js";

/**
 * @param {string} name of the button, which names the sheet that it opens
 * @param {() => void} [onOpen]
 */
function followSheet(name, onOpen) {
  const button = $(name);
  const sheet = $(button.getAttribute("aria-controls") ?? "");
  const show = (/** @type {boolean} */ open) => {
    sheet.classList.toggle("open", open);
    button.setAttribute("aria-expanded", String(open));
    if (open) onOpen?.();
  };
  const isOpen = () => sheet.classList.contains("open");
  button.addEventListener("click", () => show(!isOpen()));
  sheet.addEventListener("click", () => show(false)); // something in the sheet was chosen
  addEventListener("pointerdown", (event) => {
    const inside = [button, sheet].some((each) => each.contains(/** @type {Node} */ (event.target)));
    if (!inside) show(false);
  });
  addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !isOpen()) return;
    event.stopImmediatePropagation();
    show(false);
    button.focus();
  }, { capture: true });
  show(false);
}

/** Makes the buttons of the header, the tools and the result open their sheets. */
export function followSheets() {
  for (const name of ["menu-toggle", "tools-toggle", "looks-toggle"]) followSheet(name);
}

/** Distance in pixels of a card from its button and from the window's edge. */
const GAP = 8;

/**
 * Makes a button open a card of pictures to choose from.
 * @param {string} name of the button
 * @param {() => void} fill creates the card's contents each time it opens
 */
export function followPicker(name, fill) {
  const button = $(name);
  const card = $(button.getAttribute("aria-controls") ?? "");
  const choices = () => /** @type {HTMLButtonElement[]} */ ([...card.querySelectorAll("button:not(:disabled)")]);
  followSheet(name, () => {
    fill();
    const { left, top, bottom } = button.getBoundingClientRect();
    const below = bottom + GAP + card.offsetHeight <= innerHeight;
    card.style.left = `${Math.max(GAP, Math.min(left, innerWidth - card.offsetWidth - GAP))}px`;
    card.style.top = `${Math.max(GAP, below ? bottom + GAP : Math.min(top - GAP, innerHeight - GAP) - card.offsetHeight)}px`;
    (choices().find((each) => each.getAttribute("aria-pressed") === "true") ?? choices()[0]).focus();
  });
  card.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const all = choices();
    all[(all.indexOf(/** @type {HTMLButtonElement} */ (document.activeElement)) + step + all.length) % all.length].focus();
  });
  // Keyboard users continue at the button that opened the card.
  card.addEventListener("click", () => button.focus());
}
