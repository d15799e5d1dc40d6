"""Hook of the site: adds the studio without a server, a folder that predicts in the browser alone.

The page is the same that `normalgan studio` serves. The files in ``tools/static_studio``, the shipped model
and onnxruntime-web (MIT), which npm downloads, take the place of the server.
"""

import base64
import gzip
import hashlib
import io
import json
import logging
import shutil
import subprocess
import tarfile
from pathlib import Path
from types import ModuleType

import numpy as np
from mkdocs.config.defaults import MkDocsConfig

from normalgan.inference import edits, forms, normal_map, pipeline, regions, structures, suggestion, unrolling
from normalgan.inference.cleaning import ink, reader, silhouette
from normalgan.inference.composites import figures, islands, sheets
from normalgan.inference.mask import decision, edge
from normalgan.inference.network import extension, line_width, upsampling
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.reading import drawings
from normalgan.studio.drawings.limits import with_limits
from normalgan.studio.page_files import PAGE, markup
from normalgan.studio.predictions.exports import with_export_menu

ROOT = Path(__file__).parents[2]
BACKEND = ROOT / "tools" / "static_studio"
CLAY = ROOT / "src" / "normalgan" / "inference" / "outputs" / "clay.json"
WEIGHTS = ROOT / "src" / "normalgan" / "weights"
MODELS = (WEIGHTS / "ours.onnx", WEIGHTS / "refiner.onnx", WEIGHTS / "reader.onnx")
LOCK = ROOT / "examples" / "onnx_web" / "package-lock.json"
"""The lock file, which the example that predicts in the browser shares."""
CACHE = ROOT / "build" / "npm"
RUNTIME = ("ort.wasm.min.mjs", "ort-wasm-simd-threaded.mjs")
BINARY = "ort-wasm-simd-threaded.wasm"
"""Compressed in the site, 4 MB instead of 14, since not every host compresses; the worker unpacks it."""
CONSTANTS = "constants.js"
MODULES = (
    decision, drawings, edge, edits, extension, figures, forms, ink, islands, line_width, normal_map,
    pipeline, reader, regions, sheets, silhouette, suggestion, unrolling, upsampling,
)  # fmt: skip
"""Modules that the page's scripts reimplement with the same constants."""
SERVICE_WORKER = "service_worker.js"
FOLDER = "draw"
_ABOUT = '<p data-text="webAbout"></p>'
_LEFT_OUT = (
    "<!doctype html><html lang='en'><meta charset='utf-8'><title>normalgan studio</title>"
    "<p>This copy of the site was built without onnxruntime-web, and so without the studio in the browser. "
    "Install normalgan and run <code>normalgan studio</code>.</p></html>\n"
)


def on_post_build(config: MkDocsConfig) -> None:
    """Add the studio to the site, or a page that says that it was left out."""
    folder = Path(config.site_dir) / FOLDER
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    runtime = fetch_runtime()
    if runtime is None:
        (folder / "index.html").write_text(_LEFT_OUT, encoding="utf-8")
        # Not a warning, which would fail the build, since the rest of the site does not need the studio.
        logging.getLogger("mkdocs.hooks.static_studio").info(
            "npm could not download onnxruntime-web: the studio in the browser was left out."
        )
        return
    build(folder, runtime)


def fetch_runtime() -> bytes | None:
    """Return npm's package of onnxruntime-web; None if npm is missing or reaches no registry.

    Raises:
        ValueError: if it is not the package that the lock file names.
    """
    locked = json.loads(LOCK.read_text(encoding="utf-8"))["packages"]["node_modules/onnxruntime-web"]
    kept = CACHE / f"onnxruntime-web-{locked['version']}.tgz"
    if not kept.is_file():
        npm = shutil.which("npm")
        if npm is None:
            return None
        CACHE.mkdir(parents=True, exist_ok=True)
        named = f"onnxruntime-web@{locked['version']}"
        command = [npm, "pack", named, "--fetch-retries=1", "--loglevel=silent"]
        if (
            subprocess.run(command, cwd=CACHE, capture_output=True, check=False).returncode
            or not kept.is_file()
        ):
            return None
    content = kept.read_bytes()
    if locked["integrity"] != "sha512-" + base64.b64encode(hashlib.sha512(content).digest()).decode():
        kept.unlink()
        raise ValueError(
            f"{kept.name} is not the package that {LOCK.name} names; it was deleted, build again."
        )
    return content


def build(folder: Path, runtime: bytes) -> None:
    """Write the studio into a folder.

    Args:
        folder: the folder to write.
        runtime: the package of onnxruntime-web.
    """
    page = folder / "page"
    shutil.copytree(PAGE, page)
    (page / "index.html").unlink()
    for path in BACKEND.glob("*.js"):
        if path.name != SERVICE_WORKER:
            shutil.copy(path, page)
    for path in (*MODELS, CLAY):
        shutil.copy(path, page)
    for kind in structures.KINDS:
        (page / structures.FILE.format(kind)).write_bytes(structures.tile_bytes(kind))
    lines = [
        f"export const {module.__name__.rpartition('.')[2].upper()} = {json.dumps(_constants(module))};\n"
        for module in MODULES
    ]
    (page / CONSTANTS).write_text("".join(lines), encoding="utf-8")
    # The browser's runtime cannot read the line widths.
    notes = {"line_widths": OnnxBackend(MODELS[0]).line_widths, "structures": structures.KINDS}
    (page / "model.json").write_text(json.dumps(notes) + "\n", encoding="utf-8")
    with tarfile.open(fileobj=io.BytesIO(runtime)) as packed:
        for name in (*RUNTIME, BINARY):
            member = packed.extractfile(f"package/dist/{name}")
            assert member is not None
            (page / name).write_bytes(member.read())
    binary = page / BINARY
    # Not .gz: with some hosts the browser would unpack it, and then the worker would try again.
    binary.with_name(f"{BINARY}.packed").write_bytes(gzip.compress(binary.read_bytes(), mtime=0))
    binary.unlink()
    (page / "onnxruntime-web.txt").write_text(
        "ort*.mjs and ort*.wasm.packed (gzip) are ONNX Runtime Web, (c) Microsoft Corporation, MIT License:\n"
        "https://github.com/microsoft/onnxruntime/blob/main/LICENSE\n",
        encoding="utf-8",
    )
    text = (PAGE / "index.html").read_text(encoding="utf-8").replace('"/page/', '"page/')
    first = '<script type="module" src="page/backend.js"></script>\n'
    main = '<script type="module" src="page/main.js"></script>'
    about = '<p id="about" class="quiet"></p>'
    assert main in text, "the page's script has another name"
    assert about in text, "the page's help has no line about itself"
    text = with_limits(with_export_menu(text))
    text = markup(text.replace(main, first + main).replace(about, _ABOUT + about), page)
    (folder / "index.html").write_text(text, encoding="utf-8")
    _write_service_worker(folder)


def _constants(module: ModuleType) -> dict[str, object]:
    """Return a module's constants that are numbers or short lists of numbers, private ones included.

    The page's scripts implement the same method again, so they need the private constants too.
    """
    named = {name.lstrip("_"): np.asarray(value) for name, value in vars(module).items() if name.isupper()}
    return {
        name: value.tolist() for name, value in named.items() if value.dtype.kind in "if" and value.ndim <= 1
    }


def _write_service_worker(folder: Path) -> None:
    """Write the service worker that caches the studio's files; any changed file gives a new version."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    version = hashlib.sha256()
    for path in files:
        version.update(hashlib.sha256(path.read_bytes()).digest())
    names = ["./", *(path.relative_to(folder).as_posix() for path in files)]
    built = json.dumps({"VERSION": version.hexdigest()[:16], "FILES": names})
    code = (BACKEND / SERVICE_WORKER).read_text(encoding="utf-8")
    # In the page's folder, since a service worker serves only what lies below it.
    (folder / SERVICE_WORKER).write_text(f"globalThis.BUILT = {built};\n{code}", encoding="utf-8")
