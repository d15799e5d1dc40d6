"""What docs/plugins.md tells a stranger to do can be read off the page, and is walked as in a terminal."""

import runpy
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from normalgan.benchmark.plan import read_plan

ROOT = Path(__file__).parents[1]
TOOL = runpy.run_path(str(ROOT / "tools" / "strangers_path.py"))
Stage, walk = TOOL["Stage"], TOOL["walk"]


@pytest.fixture(scope="module")
def told() -> dict[str, Any]:
    page = (ROOT / "docs" / "plugins.md").read_text(encoding="utf-8")
    return {stage.name.partition(" ")[2]: stage for stage in TOOL["stages"](page)}


def test_each_step_has_something_to_do(told: dict[str, Any]) -> None:
    assert list(told) == ["Install", "Write it", "Test it", "Train with it", "Compare it"]
    assert all(stage.files or stage.commands for stage in told.values())
    commands = "".join(stage.commands for stage in told.values())
    for word in ("pip install normalgan-*.whl", "pytest", "normalgan plugins", "normalgan fit", "benchmark"):
        assert word in commands


def test_package_names_the_class_that_is_written(told: dict[str, Any]) -> None:
    files = told["Write it"].files
    project = tomllib.loads(files["pyproject.toml"])["project"]
    (name, place) = project["entry-points"]["normalgan.hint_samplers"].popitem()
    module, _, attribute = place.partition(":")
    assert name == attribute
    assert f"class {attribute}(HintSampler):" in files[f"{module}.py"]
    assert f"from {module} import {attribute}" in told["Test it"].files[f"test_{module}.py"]


def test_plan_trains_from_the_settings_with_the_class(told: dict[str, Any], tmp_path: Path) -> None:
    for stage in told.values():
        for name, text in stage.files.items():
            (tmp_path / name).write_text(text)
    plan = read_plan(tmp_path / "plan.yaml")
    assert [row.label for row in plan.rows] == list(TOOL["ROWS"])
    assert all((tmp_path / config).is_file() for row in plan.rows for config in row.configs)
    settings = yaml.safe_load((tmp_path / "grid.yaml").read_text())
    assert settings["model"]["hint_sampler"]["class_path"] == "GridHints"


def test_steps_share_a_terminal(tmp_path: Path) -> None:
    folder = tmp_path / "empty"
    folder.mkdir()
    log = tmp_path / "log"
    clock, processor = walk(Stage("one", {"said.txt": "hello\n"}, "export WORD='two words'\n"), folder, log)
    assert clock > 0 <= processor
    walk(Stage("two", {}, 'cat said.txt\necho "$WORD"\n'), folder, log)
    assert log.read_text() == "hello\ntwo words\n"


def test_a_step_that_fails_stops_the_walk_and_shows_what_was_said(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="'bad' failed:\nno such thing"):
        walk(Stage("bad", {}, "echo no such thing\nfalse\necho after\n"), tmp_path, tmp_path / "log")
    assert "after" not in (tmp_path / "log").read_text()
