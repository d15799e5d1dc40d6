"""Configurations that come with the package are found by name, from any folder."""

import json
import re
import tomllib
from pathlib import Path

import pytest
import yaml

from normalgan.__main__ import main
from normalgan.cli.parsing.config_files import check_config
from normalgan.data.splits import split_by_file
from normalgan.errors import InputError
from normalgan.files.shipped_configs import find_config, shipped_folder, shipped_names
from normalgan.rendering.mesh_files import read_orientations

ROOT = Path(__file__).parents[2]


def test_every_configuration_of_the_repository_has_a_name() -> None:
    assert {"paper", "ours", "cpu", "quickstart", "fourleg/meshes"} <= set(shipped_names())
    wanted = {path.relative_to(ROOT / "configs") for path in (ROOT / "configs").rglob("*.yaml")}
    assert {Path(f"{name}.yaml") for name in shipped_names()} == wanted
    packed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert packed["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"] == {
        "configs": "normalgan/configs"
    }


def test_a_file_of_that_name_wins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shipped = shipped_folder() / "paper.yaml"
    for given in ("paper", "paper.yaml", "configs/paper.yaml"):
        assert Path(find_config(given)).samefile(shipped)
    assert find_config("papier") == "papier"
    (tmp_path / "paper").write_text("data: {size: 64}")
    assert find_config("paper") == "paper"


def test_files_that_a_configuration_names_are_found_from_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They were looked up in the working directory alone, where a wheel's user has none."""
    monkeypatch.chdir(tmp_path)
    named = yaml.safe_load((shipped_folder() / "fourleg" / "meshes.yaml").read_text())["data"]
    wanted = json.loads((ROOT / "configs" / "fourleg" / "split.json").read_text())
    names = [name for part in wanted.values() for name in part]
    assert split_by_file(Path(named["split"]["file"]), names) == wanted
    assert read_orientations(named["reading"]["orientation"])
    own = tmp_path / named["split"]["file"]
    own.parent.mkdir(parents=True)
    own.write_text('{"train": ["a"], "val": [], "test": []}')
    assert split_by_file(Path(named["split"]["file"]), ["a"])["train"] == ["a"]  # a file of that name wins
    with pytest.raises(InputError, match=r"configs.fourleg.splits\.json"):
        split_by_file(Path("configs/fourleg/splits.json"), ["a"])


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("papr", "paper"),
        ("elsewhere/quikstart.yaml", "quickstart"),
        ("benchmark/animls.yaml", "benchmark/animals"),
    ],
)
def test_a_name_that_is_nearly_one_is_told(given: str, meant: str) -> None:
    told = rf"^there is no configuration file {re.escape(str(Path(given)))}\. Did you mean {meant}\?$"
    with pytest.raises(InputError, match=told):
        check_config(given)


def test_a_name_like_none_is_told_where_they_are_however_many_there_are() -> None:
    with pytest.raises(InputError) as told:
        check_config("zzzz.yaml")
    where = f"The shipped ones, such as paper and quickstart, are in {shipped_folder()}."
    assert str(told.value) == f"there is no configuration file zzzz.yaml. {where}"
    assert {"paper", "quickstart"} <= set(shipped_names())


def test_a_command_takes_names_in_any_spelling_and_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text("data: {batch_size: 3}")
    arguments = ["--config", "quickstart", "--config=cpu", "-c", "mine.yaml", "--print_config"]
    assert main(["fit", *arguments]) == 0
    printed = capsys.readouterr().out
    assert "default_root_dir: runs/quickstart" in printed
    assert "batch_size: 3" in printed


@pytest.mark.parametrize("plan", ["benchmark/embedded", "benchmark/users"])
def test_a_plan_is_no_configuration_of_a_command(plan: str, capsys: pytest.CaptureFixture[str]) -> None:
    """One has rows, the other the rows of another plan."""
    assert main(["fit", "--config", plan]) == 2
    said = capsys.readouterr().err
    told = f"{Path(plan)}.yaml is a benchmark plan; pass it to normalgan benchmark --config.\n"
    assert said.endswith(told)
