/** Layers: the traced picture's opacity and whether it shows. */

import { withLayers } from "./document.js";
import { $ } from "./dom.js";

/**
 * Wires the panel of the traced picture.
 * @param {import("./editor.js").Editor} editor
 * @param {import("./importing.js").Importing} importing
 */
export function followLayer(editor, importing) {
  /** @param {Partial<import("./document.js").Layer>} change */
  const changed = (change) => withLayers(editor.history.state, editor.doc.layers.map((layer) => ({ ...layer, ...change })));
  /** @type {HTMLInputElement} */
  const opacity = $("layer-opacity");
  /** @type {HTMLInputElement} */
  const visible = $("layer-visible");
  opacity.addEventListener("input", () => editor.preview(changed({ opacity: opacity.valueAsNumber / 100 })));
  opacity.addEventListener("change", () => editor.commit(changed({ opacity: opacity.valueAsNumber / 100 })));
  visible.addEventListener("change", () => editor.commit(changed({ visible: visible.checked })));
  $("layer-remove").addEventListener("click", () => editor.commit(withLayers(editor.doc, [])));
  $("layer-choose").addEventListener("click", () => importing.pick("traced"));
  const show = () => {
    const [layer] = editor.doc.layers;
    $("layer-none").hidden = Boolean(layer);
    for (const each of document.querySelectorAll(".with-layer")) /** @type {HTMLElement} */ (each).hidden = !layer;
    if (!layer) return;
    opacity.value = String(Math.round(layer.opacity * 100));
    visible.checked = layer.visible;
  };
  editor.addEventListener("change", show);
  show();
}
