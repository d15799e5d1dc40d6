"""What is published beside wheel and sdist: manifests, versions, files."""

import ast
import hashlib
import json
import re
import runpy
import shutil
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[1]
TOOL = runpy.run_path(str(ROOT / "tools" / "release_files.py"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
VERSION = PROJECT["version"]


@pytest.fixture(scope="module", name="dist")
def make_dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    (folder / f"normalgan-{VERSION}.tar.gz").write_bytes(b"sdist")
    TOOL["main"](folder)
    return folder


def archive(dist: Path, name: str) -> zipfile.ZipFile:
    (path,) = (dist / "add-ons").glob(f"normalgan-{name}-{VERSION}.*")
    return zipfile.ZipFile(path)


def test_blender_gets_an_extension(dist: Path) -> None:
    with archive(dist, "blender") as held:
        assert {"__init__.py", "normalgan_command.py", "blender_manifest.toml"} <= set(held.namelist())
        manifest = tomllib.loads(held.read("blender_manifest.toml").decode())
    # As https://docs.blender.org/manual/en/latest/advanced/extensions/getting_started.html demands.
    assert manifest["schema_version"] == "1.0.0"
    assert manifest["version"] == VERSION
    assert manifest["type"] == "add-on"
    assert manifest["license"] == ["SPDX:MIT"]
    for text in (manifest["tagline"], *manifest["permissions"].values()):
        assert len(text) <= 64
        assert text[-1].isalnum()
    assert set(manifest["permissions"]) <= {"files", "network", "clipboard", "camera", "microphone"}


def test_krita_finds_the_module_that_its_desktop_file_names(dist: Path) -> None:
    with archive(dist, "krita") as held:
        text = held.read("normalgan_krita.desktop").decode()
        module, manual = (
            re.search(rf"^{key}=(.+)$", text, re.MULTILINE) for key in ("X-KDE-Library", "X-Krita-Manual")
        )
        assert module is not None
        assert manual is not None
        assert f"{module[1]}/__init__.py" in held.namelist()
        assert f"{module[1]}/{manual[1]}" in held.namelist()


@pytest.mark.parametrize("name", ["gimp2", "gimp3"])
def test_gimp_may_run_its_program(dist: Path, name: str) -> None:
    folder = f"normalgan_{name}"
    with archive(dist, name) as held:
        entry = held.getinfo(f"{folder}/{folder}.py")
        assert entry.external_attr >> 16 & 0o111 == 0o111
        assert f"{folder}/normalgan_command.py" in held.namelist()


@pytest.mark.parametrize("name", ["godot3", "godot4"])
def test_godot_finds_the_script_that_its_manifest_names(dist: Path, name: str) -> None:
    with archive(dist, name) as held:
        assert all(file.startswith("addons/normalgan/") for file in held.namelist())
        assert {"addons/normalgan/LICENSE", "addons/normalgan/README.md"} <= set(held.namelist())
        settings = dict(
            re.findall(r'^(\w+)="(.*)"$', held.read("addons/normalgan/plugin.cfg").decode(), re.MULTILINE)
        )
        assert settings["version"] == VERSION
        assert f"addons/normalgan/{settings['script']}" in held.namelist()


def test_comfyui_has_what_its_registry_reads(dist: Path) -> None:
    with archive(dist, "comfyui") as held:
        assert "normalgan_nodes/__init__.py" in held.namelist()
        manifest = tomllib.loads(held.read("normalgan_nodes/pyproject.toml").decode())
    assert manifest["project"]["version"] == VERSION
    assert set(manifest["tool"]["comfy"]) >= {"PublisherId", "DisplayName"}


def test_aseprite_gets_an_extension(dist: Path) -> None:
    with archive(dist, "aseprite") as held:
        package = json.loads(held.read("package.json"))
        assert package["version"] == VERSION
        assert {script["path"].removeprefix("./") for script in package["contributes"]["scripts"]} <= set(
            held.namelist()
        )


def test_every_add_on_of_the_installer_is_published_with_all_that_it_calls(
    dist: Path, tmp_path: Path
) -> None:
    installer: dict[str, Any] = runpy.run_path(str(ROOT / "integrations" / "install.py"))
    assert set(TOOL["add_ons"]()) == set(installer["ADD_ONS"])
    for name in installer["ADD_ONS"]:
        with archive(dist, name) as held:
            assert "__pycache__" not in " ".join(held.namelist())
            assert [file for file in held.namelist() if file.endswith("LICENSE")]
            for file in held.namelist():
                if file.endswith(".py"):
                    ast.parse(held.read(file))
            # What the installer copies is what the zip holds.
            files = {Path(file).name for file in held.namelist()}
        installer["install"](name, tmp_path / name, "")
        assert {path.name for path in (tmp_path / name).rglob("*") if path.is_file()} <= files


def test_the_hub_reads_the_card(dist: Path) -> None:
    text = (dist / "hub" / "README.md").read_text(encoding="utf-8")
    huggingface_hub = pytest.importorskip("huggingface_hub")
    card = huggingface_hub.ModelCard(text)
    assert card.data.license == "mit"
    results = card.data.eval_results
    sets = list((ROOT / "docs" / "results").glob("shipped_*.json"))
    assert len(results) == 3 * len(sets)  # without hints, with 15, and the mask
    assert all(float(result.metric_value) > 0 for result in results)
    assert not re.search(r"\]\((?!https?://)", text)  # the pages are not there
    shipped = ROOT / "src" / "normalgan" / "weights" / "ours.onnx"
    assert (dist / "hub" / "model.onnx").read_bytes() == shipped.read_bytes()


CONDA = {
    "PyYAML": "pyyaml",
    "docstring-parser": "docstring_parser",
    "OpenEXR": "openexr-python",
    "opencv-python-headless": "py-opencv",
    "jsonargparse[signatures]": "jsonargparse",
}
"""Names that conda-forge has for packages of PyPI, where they differ."""


def test_the_conda_recipe_asks_for_what_the_package_does(dist: Path) -> None:
    content = yaml.safe_load((dist / "conda" / "recipe.yaml").read_text(encoding="utf-8"))
    assert content["context"]["version"] == VERSION
    assert content["source"]["sha256"] == hashlib.sha256(b"sdist").hexdigest()
    asked = dict(line.split(" ", 1) if " " in line else (line, "") for line in content["requirements"]["run"])
    assert asked.pop("python") == PROJECT["requires-python"]
    for requirement in PROJECT["dependencies"]:
        name, bound = re.fullmatch(r"([\w\[\]-]+)(.*)", requirement).groups()  # type: ignore[union-attr]
        assert asked.pop(CONDA.get(name, name)) == bound.removesuffix(".84"), name
    assert set(asked) == {"typeshed-client"}


def test_all_say_the_same_version(dist: Path) -> None:
    assert yaml.safe_load((dist / "CITATION.cff").read_text(encoding="utf-8"))["version"] == VERSION
    text = (ROOT / "integrations" / "blender" / "normalgan_blender" / "__init__.py").read_text(
        encoding="utf-8"
    )
    assert f'"version": ({VERSION.replace(".", ", ")})' in text


def test_the_hashes_are_those_of_the_files_and_two_builds_are_the_same(dist: Path, tmp_path: Path) -> None:
    shutil.copy(dist / f"normalgan-{VERSION}.tar.gz", tmp_path)
    TOOL["main"](tmp_path)
    assert (tmp_path / "SHA256SUMS").read_bytes() == (dist / "SHA256SUMS").read_bytes()
    for line in (dist / "SHA256SUMS").read_text().splitlines():
        digest, name = line.split("  ")
        assert hashlib.sha256((dist / name).read_bytes()).hexdigest() == digest


def test_the_image_runs_the_studio_as_the_dockerfile_says(tmp_path: Path) -> None:
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    (entry,) = re.findall(r"^ENTRYPOINT (.+)$", text, re.MULTILINE)
    (command,) = re.findall(r"^CMD (.+)$", text, re.MULTILINE)
    from normalgan.studio.command import build_parser

    words: list[str] = [*json.loads(entry), *json.loads(command)]
    program, verb, *options = words
    assert (program, verb) == ("normalgan", "studio")
    settings = build_parser().parse_args(options)
    assert settings.address == "0.0.0.0"
    assert f"EXPOSE {settings.port}" in text
    assert re.search(r"^USER (?!root)", text, re.MULTILINE)
