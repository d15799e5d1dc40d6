/** Sheets: what a small window keeps behind a button; in a wide one it stands where it is, and the button is hidden. */

import { $ } from "./dom.js";

/** @param {string} name of the button, which names the sheet that it opens */
function followSheet(name) {
  const button = $(name);
  const sheet = $(button.getAttribute("aria-controls") ?? "");
  const show = (/** @type {boolean} */ open) => {
    sheet.classList.toggle("open", open);
    button.setAttribute("aria-expanded", String(open));
  };
  const isOpen = () => sheet.classList.contains("open");
  button.addEventListener("click", () => show(!isOpen()));
  sheet.addEventListener("click", () => show(false)); // something in it was chosen
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

/** Lets the buttons of the header, of the tools and of the result open their sheets. */
export function followSheets() {
  for (const name of ["menu-toggle", "tools-toggle", "looks-toggle"]) followSheet(name);
}
