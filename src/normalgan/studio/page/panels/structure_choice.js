/** Structure choice: the brush's structure, its size and rotation; either built-in or a picture of the user. */

import { context2d } from "../drawing/canvas.js";
import { OWN } from "../drawing/document.js";
import { LIMITS } from "../drawing/limits.js";
import { decodeAll, decoded } from "../drawing/pictures.js";
import { tileFrom } from "../drawing/structure_picture.js";
import { slopesAt, tileOf } from "../drawing/structures.js";
import { $, field, label, make } from "../elements/dom.js";
import { followPicker } from "../elements/sheets.js";
import { DEFAULT_LIGHT } from "../result/viewer_input.js";
import { clayShader, normalised } from "../result/viewer_shading.js";
import { say, text, wordsOf } from "../text/text.js";
import { PERIODS } from "./toolbar.js";

/** Names of the structures. @type {Record<string, string>} */
const NAMES = { scales: "structureScales", fur: "structureFur", weave: "structureWeave", stone: "structureStone", bark: "structureBark", own: "structureOwn" };
/** Side in pixels of a structure's picture, and of the tiles in it. */
const [SIDE, SHOWN] = [96, 112];

/** @typedef {import("../drawing/document.js").Structure} Structure @typedef {import("../drawing/document.js").OwnStructure} OwnStructure */

/** The button that shows the structure, its card, its sliders, and the file that a picture comes from. */
export class StructureChoice {
  /** The structure that the button shows. */
  #pictured = "";

  /**
   * @param {import("../drawing/editor.js").Editor} editor
   * @param {import("./brushes.js").ChosenStroke} stroke
   * @param {(file: File) => Promise<string | null>} read returns a picture as a data URL, or null after announcing an error
   * @param {import("../elements/status.js").Announce} announce
   */
  constructor(editor, stroke, read, announce) {
    this.editor = editor;
    this.stroke = stroke;
    this.read = read;
    this.announce = announce;
    this.period = field("structure-period");
    this.turn = field("structure-turn");
    this.file = field("structure-file");
    this.period.max = String(PERIODS.length - 1);
    for (const [event, ended] of /** @type {const} */ ([["input", false], ["change", true]])) {
      this.period.addEventListener(event, () => this.#take({ period: PERIODS[this.period.valueAsNumber] }, ended));
      this.turn.addEventListener(event, () => this.#take({ turn: (this.turn.valueAsNumber * Math.PI) / 180 }, ended));
    }
    followPicker("structure-choose", () => this.#fill());
    this.file.addEventListener("change", () => this.#takeFile());
  }

  /** Selects the next structure. */
  next() {
    const { kind, picture } = this.#now();
    const all = this.#all();
    const at = all.findIndex((each) => each.kind === kind && each.own?.id === picture);
    const next = all[(at + 1) % all.length];
    this.#choose(next.kind, next.own);
  }

  /** Shows the current choice. @param {boolean} used whether the brush currently applies structures */
  show(used) {
    for (const each of ["choose", "period-label", "turn-label"]) $(`structure-${each}`).hidden = !used;
    const structure = this.#now();
    const at = PERIODS.findIndex((each) => each >= structure.period);
    const turn = structure.turn ?? 0;
    this.period.value = String(at < 0 ? PERIODS.length - 1 : at);
    this.period.setAttribute("aria-valuetext", say("widthValue", { width: Math.round(structure.period) }));
    this.turn.value = String(Math.round((Math.atan2(Math.sin(turn), Math.cos(turn)) * 180) / Math.PI));
    const { own, words } = this.#all().find((each) => each.own?.id === structure.picture && each.kind === structure.kind) ?? { words: wordsOf(NAMES[structure.kind]) };
    label($("structure-choose"), `${text.structureChoose}: ${words}`);
    const wanted = `${structure.kind} ${own?.id}`;
    if (!used || this.#pictured === wanted) return;
    this.#pictured = wanted;
    $("structure-choose").replaceChildren(pictureOf({ kind: structure.kind, period: SHOWN }, own));
  }

  /** The structure of the selected stroke, or else of the next one. */
  #now() {
    return this.stroke.area?.structure ?? this.editor.structure;
  }

  /** All available structures: the built-in ones, the drawing's pictures, and the last chosen picture. @returns {{kind: string, own?: OwnStructure, words: string}[]} */
  #all() {
    const { doc: { structures }, ownStructure: last } = this.editor;
    const pictures = last && !structures.some(({ id }) => id === last.id) ? [...structures, last] : structures;
    return [
      ...LIMITS.kinds.map((kind) => ({ kind, words: wordsOf(NAMES[kind]) })),
      ...pictures.map((own, i) => ({ kind: OWN, own, words: say("structurePicture", { number: i + 1 }) })),
    ];
  }

  /** @param {string} kind @param {OwnStructure} [own] the picture */
  #choose(kind, own) {
    if (own) this.editor.set({ ownStructure: own });
    this.#take(own ? { kind, picture: own.id } : { kind }, true, own && [own]);
  }

  /** @param {Partial<Structure>} change @param {boolean} ended @param {OwnStructure[]} [own] */
  #take(change, ended, own = []) {
    const structure = { ...this.#now(), ...change };
    if (structure.kind !== OWN) delete structure.picture;
    // Only the selected stroke keeps its own offset.
    const { kind, period, turn, picture } = structure;
    this.editor.set({ structure: { kind, period, ...(turn && { turn }), ...(picture && { picture }) } });
    if (this.stroke.area?.structure) this.stroke.change({ structure }, ended, Object.keys(change).join(), own);
  }

  async #takeFile() {
    const { file } = this;
    const [given] = file.files ?? [];
    file.value = "";
    const url = given && (await this.read(given));
    if (!url) return;
    await decodeAll([url]);
    const picture = tileFrom(decoded(url));
    if (picture) this.#choose(OWN, { id: hashOf(picture), picture });
    else this.announce(say("structureEven", { name: given.name }), "warning");
  }

  /** Fills the card. */
  #fill() {
    const now = this.#now();
    const buttons = this.#all().map(({ kind, own, words }) => {
      const pressed = own ? own.id === now.picture : kind === now.kind;
      const button = make("button", { type: "button", "aria-pressed": pressed }, pictureOf({ kind, period: SHOWN }, own), make("span", { text: words }));
      button.addEventListener("click", () => this.#choose(kind, own));
      return button;
    });
    const more = make("button", { type: "button", class: "wide", text: text.structureOwn });
    more.addEventListener("click", () => this.file.click());
    $("structure-card").replaceChildren(...buttons, more);
  }
}

/** Returns a hash of a picture (FNV-1a). @param {string} picture */
function hashOf(picture) {
  let hash = 0x811c9dc5;
  for (let i = 0; i < picture.length; i++) hash = Math.imul(hash ^ picture.charCodeAt(i), 0x01000193);
  return (hash >>> 0).toString(16).padStart(8, "0");
}

/** Returns a lit picture of a structure, drawn once its tile has loaded. @param {Structure} structure @param {import("../drawing/document.js").OwnStructure} [own] */
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
  }).catch(() => {}); // the name is shown; a stroke with it reports the error
  return canvas;
}
