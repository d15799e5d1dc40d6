/** Status: one calm line that screen readers hear. */

import { Away } from "./api.js";
import { $ } from "./dom.js";
import { say, text } from "./text.js";

export class Status {
  /** @param {import("./connection.js").Connection} connection */
  constructor(connection) {
    this.connection = connection;
    this.line = $("status");
    connection.addEventListener("away", () => this.say(text.offline, "away"));
    connection.addEventListener("back", () => this.say(text.online));
    this.say(text.ready);
  }

  /** @param {string} words @param {"" | "warning" | "error" | "away"} [kind] */
  say(words, kind = "") {
    this.line.textContent = words;
    this.line.dataset.kind = kind;
  }

  /** Says a figure for the eye only: screen readers would hear one with every stroke. @param {string} words */
  note(words) {
    $("note").textContent = words;
  }

  /** @param {unknown} error */
  fail(error) {
    if (error instanceof Away) {
      this.connection.lost();
      this.say(text.offline, "away"); // again, where it is known already: what was begun has ended
    } else this.say(say("broken", { reason: error instanceof Error ? error.message : String(error) }), "error");
  }
}
