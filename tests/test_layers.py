"""The picture of the package in docs: an arrow only points down, and neighbours do not know one another."""

import ast
import re
from pathlib import Path

import pytest

from interpreter import loaded

SOURCE = Path(__file__).parents[1] / "src" / "normalgan"
LAYERS = (
    {"errors", "batch", "old_names"},
    {"files", "registry", "line_widths", "contracts"},
    {"metrics", "normals", "predictions", "seeds", "progress", "decoding", "warning_filters"},
    {"rendering", "hints", "models", "objectives", "gallery", "checkpoints"},
    {"animals"},
    {"painting", "weights"},
    {"saved_model"},
    {"data", "gan", "optimizers"},
    {"callbacks", "plugins", "testing"},
    {"cli"},
    {"benchmark", "exporting", "studio"},
    {"__main__"},
)
"""The rooms of the package, from the cellar up; within a layer no one imports a neighbour."""
PARTS = {
    "painting": ("reading", "cleaning", "network", "mask", "jobs", "heights", "outputs", "composites"),
    "data": ("store", "jobs", "loading", "sources"),
}
"""The parts of the large rooms, likewise; what lies loose beside them may be above or below any."""
LIGHT = (
    *("errors", "normals", "registry", "rendering", "animals", "decoding"),
    *("gallery", "cli", "painting", "studio"),
)
"""Rooms that never import torch, but for the modules in `HEAVY`."""
HEAVY = {"cli/parser.py", "cli/training.py", "inference/network/torch_backend.py"}
"""The exceptions, which no light module imports until it needs them."""
TRAINING = {"torch", "lightning", "torchmetrics", "kornia"}
"""The libraries that take seconds to import."""


def room(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imported(path: Path) -> set[str]:
    """Return the modules that a file imports, wherever in it."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            found.add(node.module or "")
            if node.module == "normalgan":
                found |= {f"normalgan.{alias.name}" for alias in node.names if alias.name.islower()}
    return found


FILES = [path for path in sorted(SOURCE.rglob("*.py")) if path != SOURCE / "__init__.py"]


def test_every_room_has_its_layer() -> None:
    assert {room(path) for path in FILES} == set().union(*LAYERS)
    assert sum(map(len, LAYERS)) == len(set().union(*LAYERS))


def test_the_docs_show_these_layers() -> None:
    page = (SOURCE.parents[1] / "docs" / "design.md").read_text(encoding="utf-8")
    shown: list[set[str]] = []
    for layer, modules in re.findall(r"^\| (\d*) ?\| (`[\w`, ]+`) \|", page, re.MULTILINE):
        if layer:
            assert int(layer) == len(LAYERS) - 1 - len(shown)
            shown.append(set())
        shown[-1] |= set(re.findall(r"\w+", modules))
    assert shown == list(reversed(LAYERS))


@pytest.mark.parametrize("here", sorted(set().union(*LAYERS)))
def test_imports_point_down(here: str) -> None:
    below = set().union(*(LAYERS[i] for i in range(len(LAYERS)) if here not in set().union(*LAYERS[: i + 1])))
    wrong = {}
    for path in (path for path in FILES if room(path) == here):
        ours = {name.split(".")[1] for name in imported(path) if name.startswith("normalgan.")}
        wrong[path] = ours - {here, "__version__"} - below
    assert not {path: names for path, names in wrong.items() if names}


@pytest.mark.parametrize("here", PARTS)
def test_imports_point_down_between_the_parts_of_a_room(here: str) -> None:
    parts = PARTS[here]
    assert set(parts) == {path.parent.name for path in FILES if path.parent.parent == SOURCE / here}
    for path in (path for path in FILES if path.parent.parent == SOURCE / here):
        above = {f"normalgan.{here}.{part}" for part in parts[parts.index(path.parent.name) + 1 :]}
        assert not {".".join(name.split(".")[:3]) for name in imported(path)} & above, path


@pytest.mark.parametrize("here", LIGHT)
def test_light_rooms_do_not_name_torch(here: str) -> None:
    for path in (path for path in FILES if room(path) == here):
        heavy = {name.split(".")[0] for name in imported(path)} & TRAINING
        assert bool(heavy) == (path.relative_to(SOURCE).as_posix() in HEAVY), path


def test_light_rooms_do_not_load_torch() -> None:
    light = [path.relative_to(SOURCE) for path in FILES if room(path) in LIGHT]
    modules = [".".join(path.with_suffix("").parts) for path in light if path.as_posix() not in HEAVY]
    seen = loaded("; ".join(f"import normalgan.{name.removesuffix('.__init__')}" for name in modules))
    assert "numpy" in seen
    assert not seen & TRAINING


@pytest.mark.parametrize(
    "arguments",
    [["--help"], [], ["--version"], ["ftt"], ["fit", "--help"], ["fit", "-h=mod"]],
    ids=["help", "nothing", "version", "typo", "help of fit", "typo in help"],
)
def test_the_front_door_opens_at_once(arguments: list[str]) -> None:
    seen = loaded(f"from normalgan.__main__ import main; main({arguments})")
    assert not seen & {"numpy", "torch", "lightning", "trimesh", "jsonargparse"}


def test_generate_begins_without_scipy() -> None:
    # To import it takes a quarter of the time in which a drawing is painted, and only other maps need it.
    assert "scipy" not in loaded("import normalgan.cli.generate")
