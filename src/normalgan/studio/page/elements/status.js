/** Status: a line for successful actions, and a toast near the action for problems. Screen readers announce both. */

import { Away, Refused } from "../server/api.js";
import { say, sentence, text } from "../text/text.js";
import { $ } from "./dom.js";

/** Milliseconds after which a success message is cleared. */
const STAYS = 6000;
/** Milliseconds for which a problem is shown; longer while the pointer or the focus is on it. */
const PROBLEM_STAYS = 15_000;
/** Distance in pixels between a problem and the element it concerns. */
const GAP = 10;

/**
 * @typedef {"" | "warning" | "loss" | "error" | "lasting" | "unpredicted" | "away"} Kind the kind of message: a completed action; the
 *   reason for a refusal; a partial loss; a failure; one that no other action settles; a failed prediction; the server's absence
 */
/** Kinds of messages about a state, which stay as long as it lasts. */
const STATES = ["unpredicted", "away"];
/** @typedef {(words: string, kind?: Kind) => void} Announce */

/** Returns an error's message: refusals of the page or the server as they are, anything else as an error of the program. @param {unknown} error */
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
    /** @type {Element | null} the last pressed element */
    this.act = null;
    for (const name of ["pointerdown", "keydown"]) {
      addEventListener(name, ({ target }) => { this.act = target instanceof Element ? target : null; }, { capture: true });
    }
    $("problem-close").addEventListener("click", () => this.#settle());
    addEventListener("resize", () => this.#place());
    // A toast and a problem may appear in any order; neither may cover the other's buttons.
    new ResizeObserver(() => this.#place()).observe($("toast"));
    connection.addEventListener("away", () => this.say(text.offline, "away"));
    connection.addEventListener("back", () => {
      this.#settle();
      this.say(text.online);
    });
    this.say(text.loading);
  }

  /** A completed action removes an error or a refusal that came before it. @param {string} words @param {Kind} [kind] `unpredicted` stays until there is a map, `away` until the server is back */
  say(words, kind = "") {
    clearTimeout(this.timer);
    this.line.textContent = kind ? "" : words;
    this.line.title = this.line.textContent; // the full text if it is too long for the window
    if (kind) this.#warn(words, kind);
    else if (words) this.#settle(["warning", "error"]);
    if (words !== text.loading && !kind) this.timer = setTimeout(() => { this.line.textContent = ""; }, STAYS);
  }

  /** Clears success messages and warnings, because a new action starts. */
  clear() {
    if (this.line.textContent !== text.loading) this.say("");
    this.#settle(["warning"]);
  }

  /** Announces that the model is ready, unless another message has been shown meanwhile. */
  ready() {
    if (this.line.textContent === text.loading) this.say(text.ready);
  }

  /** Shows a message without announcing it, because screen readers would read it after every stroke. @param {string} words */
  note(words) {
    $("note").textContent = words;
  }

  /** @param {unknown} error @param {Kind} [kind] `lasting` if it outlives the next completed action */
  fail(error, kind = "error") {
    if (error instanceof Away) {
      this.connection.lost();
      this.say(text.offline, "away"); // shown again, because a new attempt has failed too
      return;
    }
    this.say(reasonOf(error), kind);
  }

  /** @param {string} words @param {string} kind */
  #warn(words, kind) {
    const { problem } = this;
    // Messages behind an open dialog can be neither read nor clicked, so they move into it, except that the server is away.
    const dialog = kind === "away" ? null : document.querySelector("dialog[open] form");
    const buttons = dialog?.querySelector(".ways");
    if (buttons) buttons.before(problem); // the buttons stick to the foot of the dialog and would cover the message
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
    if (!STATES.includes(kind)) wait();
  }

  /** Removes the message that a prediction failed, because a map is shown or wanted no longer. */
  predicted() {
    this.#settle(["unpredicted"]);
  }

  /** Removes a problem of these kinds; the message that the server is away stays as long as it is. @param {string[]} [kinds] all, unless given */
  #settle(kinds) {
    if (kinds && !kinds.includes(this.problem.dataset.kind ?? "")) return;
    clearTimeout(this.problemTimer);
    this.problem.hidden = true;
    document.body.append(this.problem);
  }

  /** Places the problem next to the last pressed element, or at the foot of the pane. */
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
