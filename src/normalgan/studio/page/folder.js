/** Folder: drawings that lie side by side on the disk, as a gallery to open them from. */

import { imported } from "./api.js";
import { $ } from "./dom.js";
import { drawDocument, drawFitted, showTiles } from "./gallery.js";
import { say, text } from "./text.js";

const PROJECT = ".normalgan";

/** Returns the files that lie in a dropped folder, not those of folders within it. @param {FileSystemDirectoryEntry} folder @returns {Promise<File[]>} */
async function filesIn(folder) {
  const reader = folder.createReader();
  /** @type {File[]} */
  const files = [];
  for (;;) {
    // Chromium gives a hundred at a time.
    const entries = await new Promise((resolve, reject) => { reader.readEntries(resolve, reject); });
    if (!entries.length) return files;
    for (const entry of entries) if (entry.isFile) files.push(await new Promise((resolve, reject) => { entry.file(resolve, reject); }));
  }
}

export class Folder {
  /** @param {import("./importing.js").Importing} importing @param {import("./projects.js").Projects} projects */
  constructor(importing, projects) {
    this.importing = importing;
    this.projects = projects;
    this.endings = /** @type {HTMLInputElement} */ ($("import-file")).accept.split(",").filter((each) => each.startsWith("."));
    /** @type {HTMLInputElement} */
    const chosen = $("open-folder");
    // Phones cannot choose folders.
    $("open-folder-button").hidden = !("webkitdirectory" in chosen);
    $("open-folder-button").addEventListener("click", () => chosen.click());
    chosen.addEventListener("change", () => {
      const files = [...chosen.files ?? []];
      chosen.value = "";
      if (files.length) this.show(files, files[0].webkitRelativePath.split("/")[0]);
    });
  }

  /** Shows what was dropped, if it is a folder or several files. @param {DataTransfer} dropped @returns {boolean} */
  take(dropped) {
    const entry = dropped.items[0]?.webkitGetAsEntry?.();
    if (entry?.isDirectory) {
      filesIn(/** @type {FileSystemDirectoryEntry} */ (entry)).then((files) => this.show(files, entry.name)).catch((error) => this.projects.status.fail(error));
    } else if (dropped.files.length > 1) {
      this.show([...dropped.files], "");
    } else return false;
    return true;
  }

  /** @param {File[]} files @param {string} name of the folder, "" if they are of none */
  show(files, name) {
    const drawings = files.filter((file) => this.#kind(file)).sort((a, b) => a.name.localeCompare(b.name, undefined, { numeric: true }));
    const title = $("folder-title");
    title.hidden = false;
    title.textContent = !name ? text.drawings : say(drawings.length ? "folderOf" : "folderNone", { name });
    showTiles($("folder-list"), drawings.map((file) => ({
      name: file.name, key: `${file.name} ${file.lastModified} ${file.size}`,
      draw: (canvas) => this.#draw(file, canvas), open: () => this.#open(file),
    })));
    /** @type {HTMLDialogElement} */
    const dialog = $("open-dialog");
    if (!dialog.open) this.projects.choose();
    title.scrollIntoView({ block: "start" });
  }

  /** @param {File} file @returns {"project" | "picture" | ""} */
  #kind({ name, type }) {
    const ending = name.slice(name.lastIndexOf(".")).toLowerCase();
    if (ending === PROJECT) return "project";
    return !name.startsWith(".") && (type.startsWith("image/") || this.endings.includes(ending)) ? "picture" : "";
  }

  /** @param {File} file @param {HTMLCanvasElement} canvas */
  async #draw(file, canvas) {
    if (this.#kind(file) === "project") {
      await drawDocument(canvas, JSON.parse(await file.text()));
      return;
    }
    // What the browser cannot read the server can.
    const bitmap = await createImageBitmap(file).catch(() => null);
    if (bitmap) {
      drawFitted(canvas, bitmap);
      bitmap.close();
      return;
    }
    const image = new Image();
    image.src = `data:image/png;base64,${(await imported(file)).picture}`;
    await image.decode();
    drawFitted(canvas, image);
  }

  /** @param {File} file */
  #open(file) {
    /** @type {HTMLDialogElement} */ ($("open-dialog")).close();
    if (this.#kind(file) === "project") this.projects.openFile(file);
    else this.importing.open(file);
  }
}
