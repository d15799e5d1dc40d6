/** Theme: dark or light like the system, until the user switches it. */

import { recalled, remember } from "./settings.js";

const KEY = "normalgan-theme";

/** @param {HTMLElement} button */
export function followTheme(button) {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const show = () => {
    const theme = recalled(KEY) ?? (dark.matches ? "dark" : "light");
    document.documentElement.dataset.theme = theme;
    button.setAttribute("aria-pressed", String(theme === "dark"));
  };
  button.addEventListener("click", () => {
    const other = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    remember(KEY, other);
    show();
  });
  dark.addEventListener("change", show);
  show();
}
