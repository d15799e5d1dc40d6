"""Attacks on configurations: what a safe one may name, where it may write, and what is read in its place."""

import sys
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import jsonargparse
import pytest
import yaml
from attacked_checkpoints import EVIL
from attacked_configs import FIRST, FOREIGN, NESTED, UNSAFE, URLS
from hostile import laughs
from jsonargparse import get_loader

from normalgan.cli.parsing.config_files import load_bounded
from normalgan.cli.training.command import run
from normalgan.errors import InputError

CONFIGS = Path(__file__).parents[2] / "configs"
COMMAND = ("fit", "--trainer.default_root_dir", "run", "--trainer.fast_dev_run", "true")


@pytest.fixture(autouse=True)
def _imports_allowed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    # A process cannot take back what it has forbidden, so that the tests put the settings back themselves.
    common = jsonargparse._common
    monkeypatch.setattr(common, "parsing_settings", dict(common.parsing_settings))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A working directory and home, with files to name and a module that tells that it was imported."""
    (tmp_path / f"{EVIL}.py").write_text(
        "from lightning.pytorch import Callback\nclass Foo(Callback): ...\ndef run(x): ...\n"
    )
    for name, content in NESTED.items():
        (tmp_path / name).write_text(content)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    sys.modules.pop(EVIL, None)


def parsed(*arguments: str) -> int:
    """Parse options of fit and print the settings; jsonargparse parses nothing after ``--print_config``."""
    return run([*COMMAND, *arguments, "--print_config"])


def written(folder: Path, content: Any, port: int = 0) -> Path:
    """Return a configuration, in which ``{folder}`` and ``{port}`` are filled in."""
    text = yaml.safe_dump(content).replace("{folder}", folder.as_posix()).replace("{port}", str(port))
    (folder / "config.yaml").write_text(text)
    return folder / "config.yaml"


@pytest.mark.parametrize(
    "kind",
    # Each parses a command line: of each way in, one is in the default run.
    [pytest.param(kind, marks=() if kind in FIRST else pytest.mark.slow) for kind in UNSAFE],
)
def test_a_safe_configuration_names_known_classes_only(folder: Path, kind: str) -> None:
    config = written(folder, UNSAFE[kind])
    with pytest.raises(InputError) as refusal:
        parsed("--safe-config", "--config", str(config))
    assert "\n" not in str(refusal.value)
    assert EVIL not in sys.modules
    assert not (folder / "touched").exists()


def test_a_class_that_is_not_allowed_is_named(folder: Path) -> None:
    config = written(folder, {"trainer": {"callbacks": {"class_path": f"{EVIL}.Foo"}}})
    with pytest.raises(
        InputError, match=f'"trainer.callbacks": --safe-config does not allow {EVIL}.Foo; it only allows'
    ):
        parsed("--safe-config", "--config", str(config))
    assert EVIL not in sys.modules


def test_a_trusted_configuration_is_the_program_that_it_is(folder: Path) -> None:
    config = written(folder, {"trainer": {"callbacks": {"class_path": f"{EVIL}.Foo"}}})
    assert parsed("--config", str(config)) == 0
    assert EVIL in sys.modules


@pytest.fixture
def server(folder: Path) -> Iterator[tuple[int, list[str]]]:
    """A server of the folder: its port, and the paths that it was asked for."""
    asked: list[str] = []

    class Handler(SimpleHTTPRequestHandler):
        def log_message(self, format: str, *args: Any) -> None:
            asked.append(self.path)

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=folder)) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield server.server_port, asked
        server.shutdown()


@pytest.mark.slow  # parses fourteen command lines
@pytest.mark.parametrize("safe", [True, False])
def test_no_configuration_is_read_from_a_url(folder: Path, server: tuple[int, list[str]], safe: bool) -> None:
    port, asked = server
    nested = ({"trainer": {"callbacks": [URLS[-1]]}}, {"model": {"generator": URLS[-1]}})
    for content in (*({"trainer": url} for url in URLS), *nested):
        config = written(folder, content, port)
        with pytest.raises(InputError):
            parsed(*["--safe-config"] * safe, "--config", str(config))
    assert EVIL not in sys.modules
    assert asked == []


@pytest.mark.parametrize("name", FOREIGN)
def test_a_safe_configuration_does_not_say_where_is_written(folder: Path, name: str) -> None:
    config = written(folder, FOREIGN[name])
    # Without the folder of the run on the command line, which would win.
    with pytest.raises(InputError, match=f"a configuration sets {name}, which --safe-config only accepts"):
        run(["fit", "--trainer.fast_dev_run", "true", "--safe-config", "--config", str(config)])
    assert not (folder / "other").exists()


@pytest.mark.parametrize("given", [["--data", "section.yaml"], ["--data=section.yaml"]])
def test_a_file_for_one_section_does_not_say_where_is_written(folder: Path, given: list[str]) -> None:
    (folder / "section.yaml").write_text("cache: other\n")
    with pytest.raises(
        InputError, match=r"a configuration sets data\.cache, which --safe-config only accepts"
    ):
        run(["fit", "--trainer.fast_dev_run", "true", "--safe-config", *given])
    assert not (folder / "other").exists()


@pytest.mark.parametrize("value", ["logger.yaml", "[logger.yaml]"])
def test_a_file_for_the_logger_does_not_say_where_is_written(folder: Path, value: str) -> None:
    (folder / "logger.yaml").write_text("class_path: CSVLogger\ninit_args: {save_dir: other}\n")
    with pytest.raises(InputError, match=r"a configuration sets trainer\.logger"):
        run(["fit", "--trainer.fast_dev_run", "true", "--safe-config", "--trainer.logger", value])
    assert not (folder / "other").exists()


def test_the_command_line_says_where_is_written(folder: Path) -> None:
    given = ("--data.cache", "mine", "--output.folder=maps", "--trainer.logger", "CSVLogger")
    more = ("--trainer.logger.save_dir", "mine")
    assert parsed("--safe-config", *given, *more) == 0


def test_a_safe_configuration_does_not_name_a_cluster(folder: Path) -> None:
    config = written(folder, {"cluster": "local:1"})
    with pytest.raises(InputError, match="a configuration sets cluster, which --safe-config only accepts"):
        run(["render", "--safe-config", "--config", str(config)])


def test_our_own_configurations_are_safe(folder: Path) -> None:
    # The classes of each file are looked at when it is read: one run reads them all. Some are overlays, of
    # which two set what an optimiser takes, so the paper's configuration comes before each.
    paths = sorted({*CONFIGS.glob("**/*.yaml")} - {*CONFIGS.glob("benchmark/*")})
    assert len(paths) > 10
    given = [word for path in paths for word in ("--config", CONFIGS / "paper.yaml", "--config", path)]
    assert parsed("--safe-config", *map(str, given)) == 0


def test_a_safe_configuration_sets_everything_else(folder: Path) -> None:
    settings = {
        "groups": [{"meshes": "horse.obj"}],
        "reading": {"variation": {"scale": 0.1}},
        "views": {"perspective": 0.2},
        "hand": {"wobble": 0.001},
        "medium": {"noise": 0.01},
        "split": {"file": "split.json"},  # no import path
    }
    config = written(folder, {"data": settings, "trainer": {"default_root_dir": "theirs"}})
    assert parsed("--safe-config", "--config", str(config)) == 0


@pytest.mark.parametrize(
    "section", ["data: bomb.yaml", "model: {generator: bomb.yaml}", "data.lines: bomb.yaml"]
)
def test_a_bomb_in_another_file_is_refused(folder: Path, section: str) -> None:
    (folder / "bomb.yaml").write_text(laughs(9))
    (folder / "config.yaml").write_text(section)
    for given in (["--config", "config.yaml"], ["--data", "bomb.yaml"]):
        with pytest.raises(InputError, match="stands for more than 100000 values"):
            parsed(*given)


def test_a_file_that_names_itself_is_refused(folder: Path) -> None:
    (folder / "config.yaml").write_text("data: config.yaml\n")
    with pytest.raises(InputError, match="loop"):
        parsed("--config", "config.yaml")


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
