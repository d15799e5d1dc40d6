/** Connection: notices that the server is away and waits for it to come back. */

import { about } from "./api.js";

const EVERY = 1500;

/** Events: `away` and `back`. */
export class Connection extends EventTarget {
  constructor() {
    super();
    this.away = false;
  }

  /** Reports that the server did not answer. */
  lost() {
    if (this.away) return;
    this.away = true;
    this.dispatchEvent(new Event("away"));
    this.#wait();
  }

  #wait() {
    setTimeout(async () => {
      try {
        await about();
      } catch {
        this.#wait();
        return;
      }
      this.away = false;
      this.dispatchEvent(new Event("back"));
    }, EVERY);
  }
}
