/** Sorting: reorder the rows of a list by dragging. */

/** Minimum movement of a drag in pixels; less is a click. */
const STIRRED = 4;
/** Height in pixels of the zones at the ends of the list in which dragging scrolls it, and pixels per scroll step. */
const [EDGE, SCROLLED] = [24, 8];

/** A drag of a row, from press to release. */
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
    /** Positions of the rows in the list, independent of scrolling. */
    this.middles = this.rows.map((row) => row.offsetTop + row.offsetHeight / 2);
    this.pitch = this.rows.length > 1 ? this.rows[1].offsetTop - this.rows[0].offsetTop : item.offsetHeight;
    this.start = { y: event.clientY, scrolled: list.scrollTop };
    /** Original index of the row, and index that it is dragged to. */
    this.from = this.to = this.rows.indexOf(item);
    /** Position of the pointer. */
    this.y = event.clientY;
    /** Whether the press has become a drag. */
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

  /** Shows the rows in their new order. */
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

  /** @param {boolean} kept whether the row stays at its new position */
  #end(kept) {
    const { item, list, rows, from, to } = this;
    this.listening.abort();
    cancelAnimationFrame(this.frame);
    for (const row of rows) row.style.transform = "";
    item.classList.remove("dragged");
    list.classList.remove("sorting");
    // The end of a drag is not a click.
    if (this.begun) addEventListener("click", (click) => click.stopPropagation(), { capture: true, once: true, signal: AbortSignal.timeout(50) });
    if (kept && to !== from && item.isConnected) this.moved(to - from);
  }
}

/**
 * Makes a row draggable within its list.
 * @param {HTMLElement} handle of the row, which is pressed
 * @param {HTMLElement} item the row
 * @param {(step: number) => void} moved called with the number of rows that it moved down
 */
export function letSort(handle, item, moved) {
  handle.addEventListener("pointerdown", (event) => {
    const list = item.parentElement;
    if (event.button === 0 && list) new RowDrag(handle, item, list, event, moved);
  });
}
