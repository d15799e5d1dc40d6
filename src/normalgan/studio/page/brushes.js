/** Brushes: what the direction brush does, how soft and strong it is, and which structure it gives; of the chosen stroke, or else of the next. */

import { context2d } from "./canvas.js";
import { OWN, changedArea, withStructures } from "./document.js";
import { $, field, label, make } from "./dom.js";
import { LIMITS } from "./limits.js";
import { decodeAll, decoded } from "./pictures.js";
import { followPicker } from "./sheets.js";
import { tileFrom } from "./structure_picture.js";
import { slopesAt, tileOf } from "./structures.js";
import { say, text, wordsOf } from "./text.js";
import { PERIODS } from "./toolbar.js";
import { DEFAULT_LIGHT } from "./viewer_input.js";
import { clayShader, normalised } from "./viewer_shading.js";

/** What structures are called. @type {Record<string, string>} */
const NAMES = { scales: "structureScales", fur: "structureFur", weave: "structureWeave", stone: "structureStone", bark: "structureBark", own: "structureOwn" };
/** How much a key changes softness or strength. */
const STEP = 0.1;
/** Pixels of a structure's picture a side, and of the tiles in it. */
const [SIDE, SHOWN] = [96, 112];

/** @typedef {"soft" | "strength"} Part @typedef {import("./document.js").Structure} Structure */

/**
 * Wires the brush's buttons and sliders.
 * @param {import("./editor.js").Editor} editor
 * @param {(file: File) => Promise<string | null>} read returns a picture as a data URL; null: it has said why not
 * @param {import("./status.js").Announce} announce
 * @returns {{turnTo: (works: "smooth" | "structure") => void, change: (part: Part, steps: number) => void, next: () => void}}
 *   turnTo: smooths or gives a structure, or no more; change: softer or stronger; next: the next structure
 */
export function followBrushes(editor, read, announce) {
  /** @type {Part[]} */
  const parts = ["soft", "strength"];
  /** The chosen stroke of the brush. */
  const chosen = () => {
    const area = editor.layer.areas[editor.area];
    return area?.size ? area : undefined;
  };
  /** @param {Part} part */
  const now = (part) => chosen()?.[part] ?? editor.brush[part];
  const structureNow = () => chosen()?.structure ?? editor.structure;

  /**
   * Changes the chosen stroke, if there is one.
   * @param {Partial<import("./document.js").Area>} change @param {boolean} ended @param {string} part presses of which that follow one another are one step
   * @param {import("./document.js").OwnStructure[]} [own] pictures that it needs
   */
  const edit = (change, ended, part, own = []) => {
    if (!chosen()) return;
    const whole = withStructures(editor.history.state, own);
    if (!whole) return announce(say("tooManyStructures", { most: LIMITS.structures }), "warning");
    const doc = changedArea(whole, editor.area, change);
    if (ended) editor.commit(doc, `${part} ${editor.area}`);
    else editor.preview(doc);
  };
  /** @param {Part} part @param {number} value @param {boolean} ended */
  const take = (part, value, ended) => {
    editor.set({ brush: { ...editor.brush, [part]: value } });
    edit({ [part]: value }, ended, part);
  };
  for (const part of parts) {
    const slider = field(`brush-${part}`);
    slider.addEventListener("input", () => take(part, slider.valueAsNumber / 100, false));
    slider.addEventListener("change", () => take(part, slider.valueAsNumber / 100, true));
  }

  /** @param {Partial<Structure>} change @param {boolean} [ended] @param {import("./document.js").OwnStructure[]} [own] */
  const takeStructure = (change, ended = true, own = []) => {
    const structure = { ...structureNow(), ...change };
    if (structure.kind !== OWN) delete structure.picture;
    // Only the chosen stroke lies where it was moved to.
    const { kind, period, turn, picture } = structure;
    editor.set({ structure: { kind, period, ...(turn && { turn }), ...(picture && { picture }) } });
    if (chosen()?.structure) edit({ structure }, ended, Object.keys(change).join(), own);
  };
  const [period, turn] = [field("structure-period"), field("structure-turn")];
  period.max = String(PERIODS.length - 1);
  for (const [event, ended] of /** @type {const} */ ([["input", false], ["change", true]])) {
    period.addEventListener(event, () => takeStructure({ period: PERIODS[period.valueAsNumber] }, ended));
    turn.addEventListener(event, () => takeStructure({ turn: (turn.valueAsNumber * Math.PI) / 180 }, ended));
  }

  /** All pictures that can be chosen as structures. */
  const pictures = () => {
    const { doc: { structures }, ownStructure: own } = editor;
    return own && !structures.some(({ id }) => id === own.id) ? [...structures, own] : structures;
  };
  /** Takes a structure that is built in, or a picture. @param {string} kind @param {import("./document.js").OwnStructure} [own] */
  const choose = (kind, own) => {
    if (own) editor.set({ ownStructure: own });
    takeStructure(own ? { kind, picture: own.id } : { kind }, true, own && [own]);
  };
  const fill = () => {
    const { kind: kindNow, picture: pictureNow } = structureNow();
    const all = [
      ...LIMITS.kinds.map((kind) => ({ kind, own: undefined, words: wordsOf(NAMES[kind]), pressed: kind === kindNow })),
      ...pictures().map((own, i) => ({ kind: OWN, own, words: say("structurePicture", { number: i + 1 }), pressed: own.id === pictureNow })),
    ];
    const buttons = all.map(({ kind, own, words, pressed }) => {
      const button = make("button", { type: "button", "aria-pressed": pressed }, pictureOf({ kind, period: SHOWN }, own), make("span", { text: words }));
      button.addEventListener("click", () => choose(kind, own));
      return button;
    });
    const more = make("button", { type: "button", class: "wide", text: text.structureOwn });
    more.addEventListener("click", () => $("structure-file").click());
    $("structure-card").replaceChildren(...buttons, more);
  };
  followPicker("structure-choose", fill);
  /** @type {HTMLInputElement} */
  const file = $("structure-file");
  file.addEventListener("change", async () => {
    const [given] = file.files ?? [];
    file.value = "";
    const url = given && (await read(given));
    if (!url) return;
    await decodeAll([url]);
    const picture = tileFrom(decoded(url));
    if (picture) choose(OWN, { id: hashOf(picture), picture });
    else announce(say("structureEven", { name: given.name }), "warning");
  });

  /** @param {"smooth" | "structure"} works */
  const turnTo = (works) => {
    const goes = editor.tool === "brush" && editor.brush.works === works;
    editor.set({ tool: "brush", brush: { ...editor.brush, works: goes ? "direction" : works }, area: -1 });
  };
  for (const works of /** @type {const} */ (["smooth", "structure"])) $(`brush-${works}`).addEventListener("click", () => turnTo(works));

  let drawn = "";
  const show = () => {
    $("brush-options").hidden = editor.tool !== "brush";
    const works = chosen()?.structure ? "structure" : editor.brush.works;
    for (const each of ["smooth", "structure"]) $(`brush-${each}`).setAttribute("aria-pressed", String(works === each));
    for (const part of parts) field(`brush-${part}`).value = String(Math.round(100 * now(part)));
    for (const each of ["choose", "period-label", "turn-label"]) $(`structure-${each}`).hidden = works !== "structure";
    const structure = structureNow();
    const at = PERIODS.findIndex((each) => each >= structure.period);
    period.value = String(at < 0 ? PERIODS.length - 1 : at);
    period.setAttribute("aria-valuetext", say("widthValue", { width: Math.round(structure.period) }));
    turn.value = String(Math.round((Math.atan2(Math.sin(structure.turn ?? 0), Math.cos(structure.turn ?? 0)) * 180) / Math.PI));
    const own = pictures().find(({ id }) => id === structure.picture);
    const name = own ? say("structurePicture", { number: pictures().indexOf(own) + 1 }) : wordsOf(NAMES[structure.kind]);
    label($("structure-choose"), `${text.structureChoose}: ${name}`);
    const wanted = `${structure.kind} ${own?.id}`;
    if (works !== "structure" || drawn === wanted) return;
    drawn = wanted;
    $("structure-choose").replaceChildren(pictureOf({ kind: structure.kind, period: SHOWN }, own));
  };
  editor.addEventListener("change", show);
  editor.addEventListener("state", show);
  show();
  return {
    turnTo,
    change: (part, steps) => {
      if (editor.tool === "brush") take(part, Math.round(100 * Math.max(0, Math.min(1, now(part) + steps * STEP))) / 100, true);
    },
    next: () => {
      if (editor.tool !== "brush" || editor.brush.works !== "structure") return;
      const all = [...LIMITS.kinds.map((kind) => ({ kind, own: undefined })), ...pictures().map((own) => ({ kind: OWN, own }))];
      const { kind, picture } = structureNow();
      const at = all.findIndex((each) => each.kind === kind && each.own?.id === picture);
      const { kind: next, own } = all[(at + 1) % all.length];
      choose(next, own);
    },
  };
}

/** Returns a number by which pictures are told apart (FNV-1a). @param {string} picture */
function hashOf(picture) {
  let hash = 0x811c9dc5;
  for (let i = 0; i < picture.length; i++) hash = Math.imul(hash ^ picture.charCodeAt(i), 0x01000193);
  return (hash >>> 0).toString(16).padStart(8, "0");
}

/** Returns a picture of a structure in the light, which comes once its tile is there. @param {Structure} structure @param {import("./document.js").OwnStructure} [own] */
function pictureOf(structure, own) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [SIDE, SIDE];
  canvas.setAttribute("aria-hidden", "true");
  tileOf(structure.kind, own?.picture.split(",")[1]).then((tile) => {
    const [at, shade] = [slopesAt(tile, structure), clayShader(normalised(DEFAULT_LIGHT))];
    const image = new ImageData(SIDE, SIDE);
    image.data.fill(255);
    const slope = [0, 0];
    for (let y = 0, i = 0; y < SIDE; y++) {
      for (let x = 0; x < SIDE; x++, i += 4) {
        at(x + 0.5, y + 0.5, slope);
        const length = Math.hypot(slope[0], slope[1], 1);
        shade(-slope[0] / length, slope[1] / length, 1 / length, image.data, i);
      }
    }
    context2d(canvas).putImageData(image, 0, 0);
  }).catch(() => {}); // its name is there; a stroke with it says what is wrong
  return canvas;
}
