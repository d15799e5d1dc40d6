"""Attacks on configurations: what is read in place of one, and how much one may stand for."""

import sys
from base64 import b64encode
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
import yaml
from attacked_checkpoints import EVIL
from hostile import laughs
from jsonargparse import get_loader

from normalgan.cli.config_files import load_bounded
from normalgan.cli.training import run
from normalgan.errors import InputError

COMMAND = ("fit", "--trainer.default_root_dir", "run", "--trainer.fast_dev_run", "true", "--print_config")
CALLBACKS = f"callbacks: {{class_path: {EVIL}.Foo}}\n"
URLS = (
    f"data://text/yaml;base64,{b64encode(CALLBACKS.encode()).decode()}",
    "local://{folder}/trainer.yaml",
    "http://127.0.0.1:{port}/trainer.yaml",
    "simplecache::http://127.0.0.1:{port}/trainer.yaml",
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A working directory with a module that tells that it was imported, and settings that name it."""
    (tmp_path / f"{EVIL}.py").write_text("from lightning.pytorch import Callback\nclass Foo(Callback): ...\n")
    (tmp_path / "trainer.yaml").write_text(CALLBACKS)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    sys.modules.pop(EVIL, None)


def test_a_configuration_is_a_program(folder: Path) -> None:
    (folder / "config.yaml").write_text("trainer: trainer.yaml")
    assert run([*COMMAND, "--config", "config.yaml"]) == 0
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


@pytest.mark.slow  # parses twelve command lines
@pytest.mark.parametrize("url", URLS, ids=lambda url: url.partition("/")[0])
def test_no_configuration_is_read_from_a_url(folder: Path, server: tuple[int, list[str]], url: str) -> None:
    port, asked = server
    given = url.format(folder=folder.as_posix(), port=port)
    for content in ({"trainer": given}, {"trainer": {"callbacks": [given]}}, {"model": {"generator": given}}):
        (folder / "config.yaml").write_text(yaml.safe_dump(content))
        with pytest.raises(InputError):
            run([*COMMAND, "--config", "config.yaml"])
    assert EVIL not in sys.modules
    assert asked == []


@pytest.mark.parametrize(
    "section", ["data: bomb.yaml", "model: {generator: bomb.yaml}", "data.lines: bomb.yaml"]
)
def test_a_bomb_in_another_file_is_refused(folder: Path, section: str) -> None:
    (folder / "bomb.yaml").write_text(laughs(9))
    (folder / "config.yaml").write_text(section)
    for given in (["--config", "config.yaml"], ["--data", "bomb.yaml"]):
        with pytest.raises(InputError, match="stands for more than 100000 values"):
            run([*COMMAND, *given])


def test_a_file_that_names_itself_is_refused(folder: Path) -> None:
    (folder / "config.yaml").write_text("data: config.yaml\n")
    with pytest.raises(InputError, match="loop"):
        run([*COMMAND, "--config", "config.yaml"])


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
