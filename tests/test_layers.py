"""The rings of the package as docs/design.md shows them: an inner one knows nothing of an outer one."""

import ast
import re
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from interpreter import loaded

SOURCE = Path(__file__).parents[1] / "src" / "normalgan"
RINGS = {
    "the ground": (
        {"errors", "batch", "arrays", "vectors", "version", "progress"},
        {"files", "registry", "line_widths", "contracts", "ranges", "records", "graphs"},
        {"normals", "commit", "seeds", "decoding", "warning_filters"},
    ),
    "the method": (
        {"metrics", "models", "rendering"},
        {"hints", "losses", "animals"},
        {"weights", "optimizers"},
        {"evaluation", "manual_optimization", "saved_settings"},
        {"gan"},
    ),
    "using a model": ({"inference"},),
    "its data": ({"data"}, {"callbacks"}),
    "the doors": ({"testing"}, {"cli"}, {"benchmark", "exporting", "studio"}, {"__main__"}),
}
"""The rings of the package and the rooms in each, from the inside out; rooms of a layer import no neighbour.

The data belongs to the method. It is listed outside `inference` because it prepares a pair of sketch and map
in the same way as `inference` prepares a drawing.
"""
LAYERS = tuple(layer for layers in RINGS.values() for layer in layers)
PARTS = {
    "inference": ("reading", "cleaning", "network", "mask", "heights", "outputs", "jobs", "composites"),
    "data": ("store", "jobs", "loading", "sources"),
    "studio": ("server", "drawings", "projects", "predictions"),
}
"""The parts of the large rooms, likewise; what lies loose beside them may be above or below any."""
PAGE_FOLDERS = ("text", "drawing", "server", "elements", "board", "result", "panels", "files", "")
"""The folders of the studio's page, likewise; the last is the page itself."""
LIGHT = (
    *("errors", "arrays", "version", "normals", "registry", "rendering", "animals", "decoding"),
    *("cli", "inference", "studio"),
)
"""Rooms that never import torch, but for the modules in `HEAVY`."""
HEAVY = {
    "cli/discovery.py",
    *(f"cli/training/{name}.py" for name in ("command", "parser", "trainer", "normal_map_writer")),
    *("cli/training/safe_config.py", "cli/training/saved_model.py", "cli/training/slurm.py"),
    "inference/network/torch_backend.py",
}
"""The exceptions, which no light module imports until it needs them."""
RELATIVE = "decoding/decoders"
"""The one package with relative imports: the program that decodes knows it by another name."""
TRAINING = {"torch", "lightning", "torchmetrics", "kornia"}
"""The libraries that take seconds to import."""


def modules() -> dict[str, Path]:
    """Return the modules of the package by their names in dots."""
    named = {".".join(path.relative_to(SOURCE.parent).with_suffix("").parts): path for path in FILES}
    return {name.removesuffix(".__init__"): path for name, path in named.items()} | {
        "normalgan": SOURCE / "__init__.py"
    }


def room(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def origin(node: ast.ImportFrom, path: Path) -> str:
    """Return the module that an import takes names from."""
    if node.level == 0:
        return node.module or ""
    assert SOURCE / RELATIVE in path.parents, f"{path} imports relatively"
    return ".".join((*path.parent.relative_to(SOURCE.parent).parts, node.module or ""))


@cache
def imports_in(path: Path) -> list[ast.Import | ast.ImportFrom]:
    """Return the imports of a file, wherever in it."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]


def imported(path: Path) -> set[str]:
    """Return the modules that a file imports."""
    found: set[str] = set()
    for node in imports_in(path):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        else:
            found.add(origin(node, path))
            if node.module == "normalgan":
                found |= {f"normalgan.{alias.name}" for alias in node.names if alias.name.islower()}
    return found


def targets(path: Path) -> set[str]:
    """Return the modules that a file imports, and not what it takes from them."""
    found: set[str] = set()
    for node in imports_in(path):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        else:
            within = {f"{origin(node, path)}.{alias.name}" for alias in node.names}
            found |= {name for name in within if is_module(name)} or {origin(node, path)}
    return found


@cache
def is_module(name: str) -> bool:
    path = SOURCE.parent / name.replace(".", "/")
    return path.with_suffix(".py").is_file() or (path / "__init__.py").is_file()


FILES = [path for path in sorted(SOURCE.rglob("*.py")) if path != SOURCE / "__init__.py"]


def test_every_room_has_its_layer() -> None:
    assert {room(path) for path in FILES} == set().union(*LAYERS)
    assert sum(map(len, LAYERS)) == len(set().union(*LAYERS))


def test_folders_of_the_page_import_only_those_inside_them() -> None:
    page = SOURCE / "studio" / "page"
    outward = []
    for path in page.rglob("*.js"):
        own = PAGE_FOLDERS.index(path.parent.relative_to(page).as_posix().strip("."))
        for name in re.findall(r'(?:from|import) "(\.[^"]+)"', path.read_text(encoding="utf-8")):
            folder = (path.parent / name).resolve().parent.relative_to(page).as_posix().strip(".")
            if PAGE_FOLDERS.index(folder) > own:
                outward.append((path.name, name))
    assert outward == []


def test_the_docs_show_these_rings() -> None:
    page = (SOURCE.parents[1] / "docs" / "design.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([\w ]*?) \| (\d+) \| (`[\w`, ]+`) \|", page, re.MULTILINE)
    shown: dict[str, list[set[str]]] = {}
    for ring, layer, names in rows:
        shown.setdefault(ring, []).insert(0, set(re.findall(r"\w+", names)))
        assert int(layer) == len(LAYERS) - sum(map(len, shown.values()))
    assert {ring: tuple(layers) for ring, layers in shown.items()} == RINGS


def test_no_modules_import_one_another_in_a_circle() -> None:
    known = modules()
    imports = {name: {other for other in targets(path) if other in known} for name, path in known.items()}
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        pytest.fail(" <- ".join(error.args[1]))


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
        assert not heavy or path.relative_to(SOURCE).as_posix() in HEAVY, path


def test_light_rooms_do_not_load_torch() -> None:
    light = [path.relative_to(SOURCE) for path in FILES if room(path) in LIGHT]
    modules = [".".join(path.with_suffix("").parts) for path in light if path.as_posix() not in HEAVY]
    seen = loaded("; ".join(f"import normalgan.{name.removesuffix('.__init__')}" for name in modules))
    assert "numpy" in seen
    assert not seen & TRAINING


@pytest.mark.slow  # imports torch
def test_workers_that_load_samples_do_not_load_what_trains() -> None:
    # Each of them is a process of its own, which would take twice as long to start.
    assert not loaded("import normalgan.data.loading.stream") & {"lightning", "torchmetrics"}


@pytest.mark.parametrize(
    "arguments",
    [["--help"], [], ["--version"], ["ftt"], ["fit", "--help"], ["fit", "-h=mod"]],
    ids=["help", "nothing", "version", "typo", "help of fit", "typo in help"],
)
def test_the_front_door_opens_at_once(arguments: list[str]) -> None:
    seen = loaded(f"from normalgan.__main__ import main; main({arguments})")
    assert not seen & {"numpy", "torch", "lightning", "trimesh", "jsonargparse"}


def test_generate_begins_without_scipy() -> None:
    # Importing it takes a quarter of the time of a prediction, and only other maps need it.
    assert "scipy" not in loaded("import normalgan.cli.generate.command")
