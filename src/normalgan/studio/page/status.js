/** Status: one calm line that screen readers hear. */

import { Away, Refused } from "./api.js";
import { $ } from "./dom.js";
import { say, sentence, text } from "./text.js";

/** Milliseconds after which a line is old news, but for what is wrong or goes on. */
const STAYS = 20_000;

export class Status {
  /** @param {import("./connection.js").Connection} connection */
  constructor(connection) {
    this.connection = connection;
    this.line = $("status");
    this.timer = 0;
    connection.addEventListener("away", () => this.say(text.offline, "away"));
    connection.addEventListener("back", () => this.say(text.online));
    this.say(text.loading);
  }

  /** @param {string} words @param {"" | "warning" | "error" | "away"} [kind] */
  say(words, kind = "") {
    this.line.textContent = words;
    this.line.dataset.kind = kind;
    this.line.title = words; // where it is too long for the window
    clearTimeout(this.timer);
    if (!kind && words !== text.loading) this.timer = setTimeout(() => { this.say(""); }, STAYS);
  }

  /** Says that the model is there, unless something else was said meanwhile. */
  ready() {
    if (this.line.textContent === text.loading) this.say(text.ready);
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
      return;
    }
    // What the page or the server refuses is a sentence; anything else is an error of the program.
    const said = error instanceof Refused || (error instanceof Error && error.constructor === Error);
    const reason = error instanceof Error ? error.message : String(error);
    this.say(said ? sentence(reason) : say("broken", { reason }), "error");
  }
}
