/** Findings: messages about a map; findings with a place show it on the drawing. */

import { MOST_LAYERS } from "../drawing/document.js";
import { make } from "../elements/dom.js";
import { say, sentence, text } from "../text/text.js";

/**
 * @typedef {{code: string, places?: [number, number][], count?: number, total?: number, share?: number, layer?: string,
 *   words?: string, outlines?: import("../drawing/lasso.js").Lasso[]}} Finding places: in pixels of the drawing; count of
 *   total: of how many it is true; layer: its name, where there are several; words: in English, where the page has none of
 *   its own; outlines: around each of separate figures
 */

/** @param {number | undefined} share */
const percent = (share) => ({ share: Math.round(100 * (share ?? 0)) });

/** @type {Record<string, (finding: Finding) => string>} */
const WORDS = {
  edge: () => text.foundEdge,
  empty_mask: () => text.foundEmptyMask,
  figures: ({ count = 2 }) => say("foundFigures", { count }),
  guessed: () => text.foundGuessed,
  hints: ({ count = 1, total = 1 }) => (count === 1 ? text.foundPoint : say("foundPoints", { count, total })),
  no_lines: () => text.foundNoLines,
  no_object: () => text.foundNoObject,
  regions: ({ count = 1 }) => (count === 1 ? text.foundRegion : say("foundRegions", { count })),
  unseen: ({ share }) => say("foundUnseen", percent(share)),
};

/** Milliseconds for which a place is shown after its message was pressed. */
const STAYS = 4000;

/** Returns the message of a finding. @param {Finding} finding */
export function wordsOfFinding(finding) {
  const words = WORDS[finding.code]?.(finding) ?? sentence(finding.words ?? "");
  return finding.layer ? `${finding.layer}: ${words}` : words;
}

/** Returns the messages of findings. @param {Finding[]} findings */
export const wordsOfFindings = (findings) => findings.map(wordsOfFinding).join(" ");

/**
 * Shows findings in an element. A ring on the drawing marks a finding's place while the pointer is over its message, and
 * for some seconds after a press.
 * @param {HTMLElement} element
 * @param {import("../drawing/editor.js").Editor} editor
 * @param {(outlines: import("../drawing/lasso.js").Lasso[]) => void} part gives each of separate figures its own layer
 * @returns {(findings: Finding[]) => void} shows others
 */
export function followFindings(element, editor, part) {
  let shown = "";
  let timer = 0;
  /** @param {[number, number][]} places */
  const ring = (places) => {
    clearTimeout(timer);
    timer = 0;
    if (!places.length && !editor.ringed.length) return;
    editor.ringed = places;
    editor.mark();
  };
  /** @param {Finding} finding */
  const line = (finding) => {
    const words = wordsOfFinding(finding);
    const { places } = finding;
    if (!places?.length) return make("span", { text: words });
    const button = make("button", { type: "button", text: words, title: text.showPlace });
    for (const event of ["pointerenter", "focus"]) button.addEventListener(event, () => ring(places));
    for (const event of ["pointerleave", "blur"]) button.addEventListener(event, () => { timer ||= setTimeout(() => ring([])); });
    button.addEventListener("click", () => {
      ring(places);
      timer = setTimeout(() => ring([]), STAYS);
    });
    return button;
  };
  /** @param {Finding} finding what can be done about it */
  const ways = ({ code, outlines = [] }) => {
    if (code !== "figures") return [];
    // The first figure stays where it is. Of more figures than layers no outlines are sent.
    if (!outlines.length || editor.doc.layers.length + outlines.length - 1 > MOST_LAYERS) return [make("span", { text: text.figuresByHand })];
    const button = make("button", { type: "button", class: "way", text: text.figuresApart });
    button.addEventListener("click", () => part(outlines));
    return [button];
  };
  return (findings) => {
    const json = JSON.stringify(findings);
    if (json === shown) return; // keeps the focus
    shown = json;
    ring([]);
    element.replaceChildren(...findings.flatMap((each) => [line(each), ...ways(each)]));
    element.hidden = !findings.length;
  };
}
