/** Sorting: a row of a list is dragged to another place in it. */

/** Pixels that a press moves before it drags: less is a click. */
const STIRRED = 4;
/** Pixels at the ends of the list in which dragging scrolls it, and by how many at a time. */
const [EDGE, SCROLLED] = [24, 8];

/** One drag of a row, from the press to its end. */
class RowDrag {
  /**
   * @param {HTMLElement} handle of the row, which is pressed
   * @param {HTMLElement} item the row
   * @param {HTMLElement} list
   * @param {PointerEvent} event the press
   * @param {(step: number) => void} moved
   */
  constructor(handle, item, list, event, moved) {
    this.item = item;
    this.list = list;
    this.moved = moved;
    this.rows = /** @type {HTMLElement[]} */ ([...list.children]);
    /** Where the rows lie in the list, whatever part of it is on show. */
    this.middles = this.rows.map((row) => row.offsetTop + row.offsetHeight / 2);
    this.pitch = this.rows.length > 1 ? this.rows[1].offsetTop - this.rows[0].offsetTop : item.offsetHeight;
    this.start = { y: event.clientY, scrolled: list.scrollTop };
    /** The place that the row has, and the one that it is dragged to. */
    this.from = this.to = this.rows.indexOf(item);
    /** Where the pointer is. */
    this.y = event.clientY;
    /** Whether it is more than a click. */
    this.begun = false;
    this.frame = 0;
    this.listening = new AbortController();
    const { signal } = this.listening;
    handle.setPointerCapture(event.pointerId);
    handle.addEventListener("pointermove", (move) => this.#move(move), { signal });
    handle.addEventListener("pointerup", () => this.#end(true), { signal });
    handle.addEventListener("pointercancel", () => this.#end(false), { signal });
    addEventListener("keydown", (key) => {
      if (key.key !== "Escape") return;
      key.stopPropagation();
      this.#end(false);
    }, { capture: true, signal });
  }

  /** @param {PointerEvent} event */
  #move(event) {
    this.y = event.clientY;
    if (!this.begun && Math.abs(this.y - this.start.y) < STIRRED) return;
    if (!this.begun) {
      this.begun = true;
      this.item.classList.add("dragged");
      this.list.classList.add("sorting");
      this.frame = requestAnimationFrame(() => this.#scroll());
    }
    this.#show();
  }

  /** Shows the rows as they would lie now. */
  #show() {
    const { rows, middles, pitch, from, list, start } = this;
    const by = this.y - start.y + list.scrollTop - start.scrolled;
    const to = middles.reduce((nearest, middle, i) =>
      Math.abs(middle - middles[from] - by) < Math.abs(middles[nearest] - middles[from] - by) ? i : nearest, from);
    rows.forEach((row, i) => {
      const shift = i === from ? by : i > from && i <= to ? -pitch : i < from && i >= to ? pitch : 0;
      row.style.transform = shift ? `translateY(${shift}px)` : "";
    });
    this.to = to;
  }

  /** Scrolls the list while the pointer is at one of its ends. */
  #scroll() {
    const { list, y } = this;
    const { top, bottom } = list.getBoundingClientRect();
    const by = y < top + EDGE ? -SCROLLED : y > bottom - EDGE ? SCROLLED : 0;
    const before = list.scrollTop;
    list.scrollTop = Math.max(0, Math.min(list.scrollHeight - list.clientHeight, before + by));
    if (list.scrollTop !== before) this.#show();
    this.frame = requestAnimationFrame(() => this.#scroll());
  }

  /** @param {boolean} kept whether the row stays where it was dragged to */
  #end(kept) {
    const { item, list, rows, from, to } = this;
    this.listening.abort();
    cancelAnimationFrame(this.frame);
    for (const row of rows) row.style.transform = "";
    item.classList.remove("dragged");
    list.classList.remove("sorting");
    // What was pressed to be dragged was not clicked.
    if (this.begun) addEventListener("click", (click) => click.stopPropagation(), { capture: true, once: true, signal: AbortSignal.timeout(50) });
    if (kept && to !== from && item.isConnected) this.moved(to - from);
  }
}

/**
 * Lets a row be dragged to another place in its list.
 * @param {HTMLElement} handle of the row, which is pressed
 * @param {HTMLElement} item the row
 * @param {(step: number) => void} moved is told by how many rows it went down
 */
export function letSort(handle, item, moved) {
  handle.addEventListener("pointerdown", (event) => {
    const list = item.parentElement;
    if (event.button === 0 && list) new RowDrag(handle, item, list, event, moved);
  });
}
