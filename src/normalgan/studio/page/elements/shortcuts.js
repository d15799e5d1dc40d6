/** Shortcuts: keys that work everywhere except in fields and dialogs; the help lists them. */

import { fieldOf } from "./dom.js";

/** Entries of the help: keys and the name of their text. */
export const SHOWN = [
  ["P  E  S  H  R  D  M  B  L  V", "keyPen"],
  ["[  ]", "keyWidth"],
  ["Ctrl+Z  Ctrl+Shift+Z", "keyUndo"],
  ["Ctrl+S  Ctrl+O  Ctrl+I  Ctrl+E", "keyFile"],
  ["+  −  0", "keyZoom"],
  ["Space", "keyPan"],
  ["1 … 5", "keyViews"],
  ["F  C  O", "keyPanes"],
  ["T  K", "keyLook"],
  ["Ctrl+A", "keySelect"],
  ["Q  J", "keyLasso"],
  ["Ctrl+D  Ctrl+C  Ctrl+X  Ctrl+V", "keyArrange"],
  ["Y  Z", "keySymmetry"],
  ["X  A", "keyMask"],
  ["G", "keyForm"],
  ["W  Shift+W  Shift+G  U  I", "keyBrush"],
  [",  .", "keyTurn"],
  ["PgUp  PgDn", "keyLayer"],
  ["N  Shift+N", "keyHint"],
  ["Del", "keyDelete"],
  ["Esc", "keyEscape"],
  ["?", "keyHelp"],
];

/**
 * Handles the shortcuts.
 * @param {Record<string, () => void>} actions by key, with "ctrl+" and "shift+" in front for letters
 */
export function followKeys(actions) {
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.altKey || document.querySelector("dialog[open]")) return;
    const field = fieldOf(event, "input:not([type=range], [type=checkbox], [type=color]), select, textarea");
    const control = event.ctrlKey || event.metaKey;
    if (field && !control) return;
    const letter = /^[a-z]$/i.test(event.key);
    const shift = letter && event.shiftKey ? "shift+" : "";
    const action = actions[`${control ? "ctrl+" : ""}${shift}${letter ? event.key.toLowerCase() : event.key}`];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
