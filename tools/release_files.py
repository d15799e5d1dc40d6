#!/usr/bin/env python3
"""Makes the releases other than wheel and sdist: zips of add-ons, the model with its card, a conda recipe.

    tools/release_files.py [FOLDER]      FOLDER: the folder with the sdist, by default dist

It needs only the standard library. Each file is identical from run to run.
"""

import hashlib
import re
import shutil
import sys
import tomllib
import zipfile
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ADD_ONS = ROOT / "integrations"
GIMP = {"gimp2": "normalgan_gimp2", "gimp3": "normalgan_gimp3"}
"""The plug-ins for GIMP's versions. GIMP looks for a program in a folder of the same name."""
COMMAND = "normalgan_command.py"
PAGES = "../../"
CARD_FRONT = """---
license: mit
library_name: normalgan
pipeline_tag: image-to-image
tags:
- normal-map
- sketch
- onnx
model-index:
- name: normalgan
  results:
{results}---
"""
RESULT = """  - task: {{type: image-to-image, name: normal map of a sketch}}
    dataset: {{type: meshes, name: "{name}"}}
    metrics:
    - {{type: angular-error, name: mean angular error without hints in degrees, value: {without}}}
    - {{type: angular-error, name: mean angular error with 15 hints in degrees, value: {with_}}}
    - {{type: iou, name: intersection over union of the mask, value: {iou}}}
"""


def version() -> str:
    """Return the version in pyproject.toml."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return str(project["version"])


def add_ons() -> dict[str, dict[str, Path]]:
    """Return the files of each add-on by their names in its zip."""
    licence = ROOT / "LICENSE"

    def under(folder: str, to: str) -> dict[str, Path]:
        files = [path for path in sorted((ADD_ONS / folder).rglob("*")) if path.is_file()]
        kept = [path for path in files if "__pycache__" not in path.parts and path.name != COMMAND]
        return {f"{to}{path.relative_to(ADD_ONS / folder).as_posix()}": path for path in kept}

    command = ADD_ONS / COMMAND
    return {
        "blender": {
            **under("blender/normalgan_blender", ""),
            "blender_manifest.toml": ADD_ONS / "blender" / "blender_manifest.toml",
            COMMAND: command,
            "LICENSE": licence,
        },
        "krita": {
            **under("krita/normalgan_krita", "normalgan_krita/"),
            "normalgan_krita.desktop": ADD_ONS / "krita" / "normalgan_krita.desktop",
            f"normalgan_krita/{COMMAND}": command,
            "normalgan_krita/LICENSE": licence,
        },
        **{
            name: {
                f"{folder}/{folder}.py": ADD_ONS / name / f"{folder}.py",
                f"{folder}/{COMMAND}": command,
                f"{folder}/LICENSE": licence,
            }
            for name, folder in GIMP.items()
        },
        "inkscape": {
            **under("inkscape", "normalgan/"),
            f"normalgan/{COMMAND}": command,
            "normalgan/LICENSE": licence,
        },
        **{
            name: {
                **under(f"{name}/addons", "addons/"),
                "addons/normalgan/LICENSE": licence,
                "addons/normalgan/README.md": ROOT / "docs" / "integrations.md",
            }
            for name in ("godot3", "godot4")
        },
        "comfyui": {
            **under("comfyui/normalgan_nodes", "normalgan_nodes/"),
            "normalgan_nodes/pyproject.toml": ADD_ONS / "comfyui" / "pyproject.toml",
            "normalgan_nodes/LICENSE": licence,
        },
        "aseprite": {**under("aseprite", ""), "LICENSE": licence},
    }


def write_zip(path: Path, files: Mapping[str, Path]) -> None:
    """Write files into a zip, with GIMP's plug-ins executable."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, source in sorted(files.items()):
            entry = zipfile.ZipInfo(name)  # dated 1980, so that two builds are identical
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if source.stem in GIMP.values() else 0o644) << 16
            archive.writestr(entry, source.read_bytes())


def model_card() -> str:
    """Return the model card for the Hugging Face hub, with its figures as YAML at the top."""
    text = (ROOT / "docs" / "model_card.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([^|]+: [^|]+) \| ([\d.]+)° \| ([\d.]+)° \| ([\d.]+) \|$", text, re.MULTILINE)
    if not rows:
        raise SystemExit("docs/model_card.md has no table of errors.")
    results = "".join(RESULT.format(name=n, without=a, with_=b, iou=c) for n, a, b, c in rows)
    # The hub has no pages or pictures: pictures are removed, and links become plain text.
    text = re.sub(r"^!\[[^\]]*\]\([^)]*\)\n+", "", text, flags=re.MULTILINE)
    text = re.sub(r"\[([^\]]*)\]\((?!https?://)[^)]*\)", r"\1", text)
    use = (
        "```sh\npip install normalgan\nnormalgan generate drawing.png -o drawing_normal.png\n```\n\n"
        "`model.onnx` is this model. `normalgan models` names the one that comes with the package.\n"
    )
    title, _, rest = text.partition("\n\n")
    return f"{CARD_FRONT.format(results=results)}\n{title}\n\n{use}\n{rest}"


def recipe(sdist: Path) -> str:
    """Return the conda recipe for an sdist."""
    text = (ROOT / "packaging" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    digest = hashlib.sha256(sdist.read_bytes()).hexdigest()
    return text.replace("@VERSION@", version()).replace("@SHA256@", digest)


def main(folder: Path) -> None:
    """Write all files, and the hashes of everything in the folder."""
    now = version()
    sdist = folder / f"normalgan-{now}.tar.gz"
    if not sdist.is_file():
        sys.exit(f"there is no {sdist}; run tools/check_packages.sh {folder} first.")
    for name, files in add_ons().items():
        ending = "aseprite-extension" if name == "aseprite" else "zip"
        write_zip(folder / "add-ons" / f"normalgan-{name}-{now}.{ending}", files)
    hub, weights = folder / "hub", ROOT / "src" / "normalgan" / "weights"
    hub.mkdir(parents=True, exist_ok=True)
    (hub / "README.md").write_text(model_card(), encoding="utf-8")
    shutil.copyfile(weights / "ours.onnx", hub / "model.onnx")
    (folder / "conda").mkdir(exist_ok=True)
    (folder / "conda" / "recipe.yaml").write_text(recipe(sdist), encoding="utf-8")
    shutil.copyfile(ROOT / "CITATION.cff", folder / "CITATION.cff")
    sums = folder / "SHA256SUMS"
    published = [path for path in sorted(folder.rglob("*")) if path.is_file() and path != sums]
    lines = [
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}"
        for path in published
    ]
    sums.write_text("\n".join(lines) + "\n", encoding="utf-8")
    for path in published:
        print(f"{path.stat().st_size / 1e6:8.2f} MB  {path.relative_to(folder)}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "dist").resolve())
