/** Paper: the panel for the paper's size and reference pictures. */

import { withPictures } from "../drawing/document.js";
import { onPaper, trimmedTo } from "../drawing/moving.js";
import { drawnBox } from "../drawing/paper_tone.js";
import { $, field, label, make, open } from "../elements/dom.js";
import { icon } from "../elements/icons.js";
import { say, text } from "../text/text.js";

/**
 * Sets up the panel.
 * @param {import("../drawing/editor.js").Editor} editor
 * @param {import("../files/importing.js").Importing} importing
 */
export function followPaper(editor, importing) {
  const changed = (/** @type {number} */ index, /** @type {Partial<import("../drawing/document.js").Picture>} */ change) =>
    withPictures(editor.history.state, editor.doc.pictures.map((picture, i) => (i === index ? { ...picture, ...change } : picture)));

  /** @param {number} i @returns {HTMLElement} */
  const row = (i) => {
    const opacity = make("input", { type: "range", min: "5", max: "100", "aria-label": say("opacityOf", { number: i + 1 }) });
    const visible = make("input", { type: "checkbox", "aria-label": say("visibleOf", { number: i + 1 }) });
    const remove = make("button", { type: "button" }, icon("remove"));
    label(remove, say("removeOf", { number: i + 1 }));
    opacity.addEventListener("input", () => editor.preview(changed(i, { opacity: opacity.valueAsNumber / 100 })));
    opacity.addEventListener("change", () => editor.commit(changed(i, { opacity: opacity.valueAsNumber / 100 })));
    visible.addEventListener("change", () => editor.commit(changed(i, { visible: visible.checked })));
    remove.addEventListener("click", () => editor.commit(withPictures(editor.doc, editor.doc.pictures.filter((_, k) => k !== i))));
    return make("li", {}, visible, make("label", { text: String(i + 1) }, opacity), remove);
  };

  const show = () => {
    const { pictures, width, height } = editor.doc;
    $("picture-none").hidden = pictures.length > 0;
    $("picture-place").hidden = !pictures.length;
    $("paper-size").textContent = say("pixels", { width, height });
    const list = $("picture-list");
    // A slider must not be replaced while it is dragged.
    if (list.children.length !== pictures.length) list.replaceChildren(...pictures.map((_, i) => row(i)));
    pictures.forEach((picture, i) => {
      const [visible, opacity] = list.children[i].querySelectorAll("input");
      visible.checked = picture.visible;
      opacity.value = String(Math.round(picture.opacity * 100));
    });
  };
  $("picture-choose").addEventListener("click", () => importing.pick("traced"));
  $("paper-resize").addEventListener("click", () => resize(editor));
  $("paper-trim").addEventListener("click", () => trim(editor, importing.status));
  editor.addEventListener("change", show);
  show();
}

/** Asks for the paper's size. @param {import("../drawing/editor.js").Editor} editor */
async function resize(editor) {
  const { width, height } = editor.doc;
  [field("paper-width").value, field("paper-height").value] = [String(width), String(height)];
  if (!(await open(/** @type {HTMLDialogElement} */ ($("paper-dialog"))))) return;
  const along = field("paper-along").checked;
  editor.commit(onPaper(editor.doc, field("paper-width").valueAsNumber, field("paper-height").valueAsNumber, along));
}

/** Trims the paper to the drawing. @param {import("../drawing/editor.js").Editor} editor @param {import("../elements/status.js").Status} status */
function trim(editor, status) {
  const box = drawnBox(editor.doc);
  if (!box) {
    status.say(text.trimNothing, "warning");
    return;
  }
  const doc = trimmedTo(editor.doc, box);
  if (doc.width === editor.doc.width && doc.height === editor.doc.height) {
    status.say(text.trimmedAlready);
    return;
  }
  editor.commit(doc);
  status.say(say("trimmed", { size: say("pixels", { width: doc.width, height: doc.height }) }));
}
