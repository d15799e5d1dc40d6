/** Status: one calm line of what was done, and a toast near the act for what went wrong. Screen readers hear both. */

import { Away, Refused } from "../server/api.js";
import { say, sentence, text } from "../text/text.js";
import { $ } from "./dom.js";

/** Milliseconds after which what was done is old news. */
const STAYS = 6000;
/** Milliseconds that a problem stays; longer while the pointer or the focus is on it. */
const PROBLEM_STAYS = 15_000;
/** Pixels between a problem and what it is about. */
const GAP = 10;

/**
 * @typedef {"" | "warning" | "loss" | "error" | "away"} Kind what is said: what was done; why it could not be done; what is missing
 *   of it; what failed; that the server is away
 */
/** @typedef {(words: string, kind?: Kind) => void} Announce */

/** Returns an error in words: what the page or the server refuses is a sentence, anything else an error of the program. @param {unknown} error */
export function reasonOf(error) {
  const said = error instanceof Refused || (error instanceof Error && error.constructor === Error);
  const reason = error instanceof Error ? error.message : String(error);
  return said ? sentence(reason) : say("broken", { reason });
}

export class Status {
  /** @param {import("../server/connection.js").Connection} connection */
  constructor(connection) {
    this.connection = connection;
    this.line = $("status");
    this.problem = $("problem");
    this.timer = 0;
    this.problemTimer = 0;
    /** @type {Element | null} what was pressed last */
    this.act = null;
    for (const name of ["pointerdown", "keydown"]) {
      addEventListener(name, ({ target }) => { this.act = target instanceof Element ? target : null; }, { capture: true });
    }
    $("problem-close").addEventListener("click", () => this.#settle());
    addEventListener("resize", () => this.#place());
    // A toast may come or go after the problem did; neither may cover the other's buttons.
    new ResizeObserver(() => this.#place()).observe($("toast"));
    connection.addEventListener("away", () => this.say(text.offline, "away"));
    connection.addEventListener("back", () => {
      this.#settle();
      this.say(text.online);
    });
    this.say(text.loading);
  }

  /** @param {string} words @param {Kind} [kind] away stays until the server is back */
  say(words, kind = "") {
    clearTimeout(this.timer);
    this.line.textContent = kind ? "" : words;
    this.line.title = this.line.textContent; // where it is too long for the window
    if (kind) this.#warn(words, kind);
    else if (words !== text.loading) this.timer = setTimeout(() => { this.line.textContent = ""; }, STAYS);
  }

  /** Forgets what was done, and why something could not be done: something else was done since, or will be. */
  clear() {
    if (this.line.textContent !== text.loading) this.say("");
    if (this.problem.dataset.kind === "warning") this.#settle();
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
    this.say(reasonOf(error), "error");
  }

  /** @param {string} words @param {string} kind */
  #warn(words, kind) {
    const { problem } = this;
    // What lies behind an open dialog can be neither seen nor pressed. That the server is away is not of the dialog.
    const dialog = kind === "away" ? null : document.querySelector("dialog[open] form");
    const buttons = dialog?.querySelector(".ways");
    if (buttons) buttons.before(problem); // they stay at the dialog's foot and would cover it
    else (dialog ?? document.body).append(problem);
    problem.dataset.kind = kind;
    problem.hidden = false;
    if (dialog) problem.scrollIntoView({ block: "nearest" });
    $("problem-words").textContent = words;
    this.#place();
    clearTimeout(this.problemTimer);
    const wait = () => {
      this.problemTimer = setTimeout(() => (problem.matches(":hover, :focus-within") ? wait() : this.#settle()), PROBLEM_STAYS);
    };
    if (kind !== "away") wait();
  }

  /** Takes a problem away; that the server is away is said as long as it is. */
  #settle() {
    clearTimeout(this.problemTimer);
    this.problem.hidden = true;
    document.body.append(this.problem);
  }

  /** Puts the problem beside what was pressed last, or at the foot of the pane. */
  #place() {
    const { problem, act } = this;
    const near = act?.isConnected ? act.closest(".pane, button, summary, label") : null;
    const box = (near?.getClientRects().length ? near : document.querySelector("main > section"))?.getBoundingClientRect();
    if (!box) return;
    const { offsetWidth: width, offsetHeight: height } = problem;
    const middle = (box.left + box.right) / 2 - width / 2;
    const inside = box.height > 3 * height;
    const below = box.top < innerHeight / 2;
    const beside = inside ? box.bottom - height - 4 * GAP : below ? box.bottom + GAP : box.top - height - GAP;
    const left = Math.max(GAP, Math.min(innerWidth - width - GAP, middle));
    const top = Math.max(GAP, Math.min(innerHeight - height - GAP, beside));
    const toast = $("toast").getBoundingClientRect();
    const covers = left < toast.right && toast.left < left + width && top < toast.bottom && toast.top < top + height;
    problem.style.left = `${left}px`;
    problem.style.top = `${covers ? toast.top - height - GAP : top}px`;
  }
}
