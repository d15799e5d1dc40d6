/** Steps: store a history of documents as the changes of each step. */

/** @typedef {import("./document.js").Doc} Doc @typedef {import("./document.js").Layer} Layer
 * @typedef {import("./document.js").Stroke | import("./document.js").Picture} Piece */
/**
 * @typedef {[number, ...number[]]} Numbers the count of items shared with the previous step, then the numbers of the others
 * @typedef {{id: number, strokes: Numbers, more: Partial<Layer>}} LayerStep the changes from the previous layer with that id
 * @typedef {object} Step a document of the history, as changes from the previous step
 * @property {(number | LayerStep)[] | null} layers a number is the id of an unchanged layer; null: all are unchanged
 * @property {Numbers} pictures
 * @property {Partial<Doc>} more what else differs
 * @typedef {{steps: Step[], at: number}} Steps
 * @typedef {{states: Doc[], at: number}} Past
 */

/** @param {Piece[]} to @param {Piece[]} from @param {(piece: Piece) => number} numbered @returns {Numbers} */
function others(to, from, numbered) {
  let same = 0;
  while (same < to.length && same < from.length && to[same] === from[same]) same++;
  return [same, ...to.slice(same).map(numbered)];
}

/** Returns the properties of a value that have changed. @template {object} T @param {T} to @param {Record<string, any>} [from] @returns {Partial<T>} */
const differing = (to, from) =>
  /** @type {Partial<T>} */ (Object.fromEntries(Object.entries(to).filter(([key, value]) => !from || from[key] !== value)));

/**
 * Returns a history as steps that only hold changes.
 * @param {Past} past
 * @param {number} most steps, as many to be undone as to be redone where there are more
 * @param {(piece: Piece) => number} numbered
 * @returns {Steps}
 */
export function toSteps({ states, at }, most, numbered) {
  const first = Math.max(0, Math.min(at - Math.floor(most / 2), states.length - most));
  const shown = states.slice(first, first + most);
  const steps = shown.map((state, i) => {
    const before = /** @type {Doc | undefined} */ (shown[i - 1]);
    const { layers, pictures, ...rest } = state;
    const changed = layers.map((layer) => {
      const old = before?.layers.find(({ id }) => id === layer.id);
      if (old === layer) return layer.id;
      const { strokes, ...more } = layer;
      return { id: layer.id, strokes: others(strokes, old?.strokes ?? [], numbered), more: differing(more, old) };
    });
    return {
      layers: layers === before?.layers ? null : changed,
      pictures: others(pictures, before?.pictures ?? [], numbered), more: differing(rest, before),
    };
  });
  return { steps, at: at - first };
}

/**
 * Returns the history of stored steps; null if something is missing.
 * @param {Steps | undefined} kept
 * @param {(number: number) => any} piece
 * @returns {Past | null}
 */
export function fromSteps(kept, piece) {
  if (!kept) return null;
  /** @param {Numbers} numbers @param {any[] | undefined} from */
  const list = ([same, ...more], from) => {
    const found = more.map(piece);
    if (found.includes(undefined) || same > (from?.length ?? 0)) throw new RangeError("a piece is missing");
    // Unchanged lists must be the same object, which others use to detect changes.
    return from && same === from.length && !found.length ? from : [...(from ?? []).slice(0, same), ...found];
  };
  /** @type {Doc[]} */
  const states = [];
  try {
    for (const { layers, pictures, more } of kept.steps) {
      const before = /** @type {Doc | undefined} */ (states[states.length - 1]);
      const found = layers?.map((each) => {
        const id = typeof each === "number" ? each : each.id;
        const old = before?.layers.find((layer) => layer.id === id);
        if (typeof each !== "number") return { ...old, ...each.more, strokes: list(each.strokes, old?.strokes) };
        if (!old) throw new RangeError("a layer is missing");
        return old;
      });
      states.push(/** @type {Doc} */ ({ ...before, ...more, layers: found ?? before?.layers, pictures: list(pictures, before?.pictures) }));
    }
  } catch {
    return null; // damaged history; the document itself is stored separately
  }
  return states[kept.at] ? { states, at: kept.at } : null;
}

/** Maximum number of steps in a saved project, and maximum size of items that are no longer in the drawing. */
const [MOST_SAVED, MOST_LETTERS] = [100, 1_000_000];

/** Returns all items of a document, which number its history. @param {Doc} doc @returns {Piece[]} */
const piecesOf = ({ layers, pictures }) => [...layers.flatMap(({ strokes }) => strokes), ...pictures];

/**
 * Returns the history that is saved with a project: as many of the last steps as fit.
 * @param {Doc} doc the one at `past.at`
 * @param {Past} past
 * @returns {Steps & {pieces: Piece[]}} pieces: those no longer in the document
 */
export function savedSteps(doc, past) {
  for (let most = MOST_SAVED; ; most >>= 1) {
    const there = piecesOf(doc);
    const numbers = new Map(there.map((piece, i) => [piece, i]));
    /** @type {Piece[]} */
    const pieces = [];
    const steps = toSteps(past, Math.max(1, most), (piece) => {
      const number = numbers.get(piece) ?? there.length + pieces.push(piece) - 1;
      numbers.set(piece, number);
      return number;
    });
    const saved = { ...steps, pieces };
    if (most <= 1 || JSON.stringify(saved).length <= MOST_LETTERS) return saved;
  }
}

/**
 * Returns the history saved with a project; null if there is none or it is damaged.
 * @param {Doc} doc
 * @param {any} saved the contents of the project's file
 * @param {(state: unknown) => Doc} check throws if it is no document
 * @returns {Past | null}
 */
export function pastOf(doc, saved, check) {
  if (!Array.isArray(saved?.steps) || !Array.isArray(saved.pieces)) return null;
  const all = [...piecesOf(doc), ...saved.pieces];
  const past = fromSteps(saved, (number) => all[number]);
  /** @param {Doc} state */
  const content = ({ width, height, layers, pictures }) => JSON.stringify([
    width, height, pictures, ...layers.map(({ id, name, visible, strokes, hints, areas, mask, source, form }) => [id, name, visible, strokes, hints, areas, mask, source, form]),
  ]);
  try {
    // The history must lead to this drawing.
    const states = past?.states.map(check) ?? [];
    if (!past || content(states[past.at]) !== content(doc)) return null;
    return { states, at: past.at };
  } catch {
    return null; // only the history is damaged
  }
}
