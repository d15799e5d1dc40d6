/** Undo and redo over values that never change. */

/** @template T */
export class History {
  /** @param {T} state @param {number} [most] maximum number of states */
  constructor(state, most = 500) {
    /** @type {T[]} */
    this.states = [state];
    this.at = 0;
    this.most = most;
  }

  /** @returns {T} */
  get state() {
    return this.states[this.at];
  }

  get canUndo() {
    return this.at > 0;
  }

  get canRedo() {
    return this.at < this.states.length - 1;
  }

  /** Adds a state after the current one and forgets undone states. @param {T} state */
  push(state) {
    this.states.splice(this.at + 1, Infinity, state);
    if (this.states.length > this.most) this.states.shift();
    this.at = this.states.length - 1;
  }

  /** Replaces the current state without a step in history. @param {T} state */
  replace(state) {
    this.states[this.at] = state;
  }

  undo() {
    if (this.canUndo) this.at -= 1;
  }

  redo() {
    if (this.canRedo) this.at += 1;
  }
}
