"""Attacks on configurations: what a safe one may name, and files in place of values that want too much."""

import os
import sys
from pathlib import Path

import pytest
import yaml
from attacked_checkpoints import EVIL
from attacked_configs import NESTED, UNSAFE
from hostile import laughs
from jsonargparse import get_loader

from normalgan.cli.config_files import ConfigCheck, load_bounded
from normalgan.cli.discovery import is_safe, settings_of_classes
from normalgan.errors import InputError

CONFIGS = Path(__file__).parents[2] / "configs"
SECTIONS = ("trainer", "model", "data", "checkpoint", "pictures", "report", "output")


def safe() -> ConfigCheck:
    return ConfigCheck(SECTIONS, settings_of_classes(), is_safe)


@pytest.mark.parametrize("kind", UNSAFE)
def test_a_safe_configuration_names_known_classes_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    (tmp_path / f"{EVIL}.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    for name, content in NESTED.items():
        (tmp_path / name).write_text(content)
    config = tmp_path / "config.yaml"
    config.write_text(yaml.safe_dump(UNSAFE[kind]))
    with pytest.raises(InputError, match="--safe-config does not allow") as refusal:
        safe().check(config)
    assert "\n" not in str(refusal.value)
    ConfigCheck(SECTIONS, settings_of_classes()).check(config)  # a trusted one is the program that it is
    assert EVIL not in sys.modules


@pytest.mark.parametrize(
    "path", sorted({*CONFIGS.glob("**/*.yaml")} - {*CONFIGS.glob("benchmark/*")}), ids=lambda path: path.name
)
def test_our_own_configurations_are_safe(path: Path) -> None:
    safe().check(path)


def test_names_of_files_are_no_modules(tmp_path: Path) -> None:
    (tmp_path / "split.json").write_text("{}")
    config = tmp_path / "config.yaml"
    config.write_text("data: {meshes: [horse.obj, split.json], split: split.json, cache: ./json.cache}\n")
    safe().check(config)


@pytest.mark.parametrize(
    "section", ["data: bomb.yaml", "model: {generator: bomb.yaml}", "data.lines: bomb.yaml"]
)
def test_a_bomb_in_another_file_is_refused(tmp_path: Path, section: str) -> None:
    (tmp_path / "bomb.yaml").write_text(laughs(9))
    (tmp_path / "config.yaml").write_text(section)
    with pytest.raises(InputError, match=r"bomb\.yaml stands for more than 100000 values"):
        ConfigCheck(SECTIONS, settings_of_classes()).check(tmp_path / "config.yaml")
    with pytest.raises(InputError, match=r"bomb\.yaml stands for more than 100000 values"):
        ConfigCheck(SECTIONS, settings_of_classes()).check_arguments(["--data", str(tmp_path / "bomb.yaml")])


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names are those of Unix")
def test_a_pipe_or_a_device_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "zero").symlink_to("/dev/zero")
    for text in ("data: pipe.yaml", "model: {generator: zero}", "data: {split: pipe.yaml}"):
        (tmp_path / "config.yaml").write_text(text)
        with pytest.raises(InputError, match="which is no file"):
            ConfigCheck(SECTIONS, settings_of_classes()).check(tmp_path / "config.yaml")
    with pytest.raises(InputError, match="is no file but a pipe or a device"):
        ConfigCheck(SECTIONS).check(tmp_path / "pipe.yaml")
    with pytest.raises(InputError, match="which is no file"):
        ConfigCheck(SECTIONS).check_arguments(["--data", str(tmp_path / "zero")])


def test_a_large_file_for_a_section_is_not_read(tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(2**40)  # sparse
    (tmp_path / "config.yaml").write_text("data: large\n")
    with pytest.raises(InputError, match="has more than 262144 bytes"):
        ConfigCheck(SECTIONS).check(tmp_path / "config.yaml")


def test_a_file_that_names_itself_is_read_once(tmp_path: Path) -> None:
    (tmp_path / "config.yaml").write_text("data: config.yaml\n")
    ConfigCheck(SECTIONS).check(tmp_path / "config.yaml")


def test_a_text_is_loaded_within_bounds_wherever_it_is_met() -> None:
    load = get_loader("yaml")
    assert load_bounded("1e-3", load) == load("1e-3") == 0.001
    for text, words in (
        (laughs(9), "stands for more than 100000 values"),
        ("a: &a [*a]", "contains itself"),
        ("[" * 200 + "]" * 200, "nested more than 50 deep"),
        ("x" * 2**19, "has more than 262144 bytes"),
    ):
        with pytest.raises(InputError, match=words):
            load_bounded(text, load)
