"""What tests of several folders share; being here, it also lets them import the modules beside it."""

import os
import shutil
import signal
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from made_once import made_once
from needs import SHARED_SKETCHES, not_tested
from normalgan.cli.late_imports import gc_paused

# Fixtures that several files share; a conftest in their folder would be a second module of this name.
pytest_plugins = [
    "chromium",
    "fixtures_of_commands",
    "plugin_packages",
    "pytester",
    "s3_server",
    "studio_page",
    "studio_process",
]

# The same examples each time, lest a change be refused for one that it has nothing to do with;
# --hypothesis-profile=default tries others.
settings.register_profile("steady", derandomize=True, deadline=None)
settings.load_profile("steady")

# Networks and pictures this small are slower with more threads, above all where tests run side by side.
# Libraries look at this when they are loaded, which is later.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# A shell that starts the tests in the background has Ctrl-C ignored, and what they start inherits that.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def signal_handlers_end_with_the_test() -> Iterator[None]:
    """Restore what training replaces; with Ctrl-C ignored, a later test of Ctrl-C would fail."""
    signals = [signal.SIGINT, signal.SIGTERM, *([signal.SIGUSR1] if hasattr(signal, "SIGUSR1") else [])]
    before = {each: signal.getsignal(each) for each in signals}
    yield
    for each, handler in before.items():
        signal.signal(each, handler)


@pytest.fixture(scope="session")
def meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of five meshes of different formats."""
    from five_meshes import write_meshes  # here: most tests need no trimesh

    return made_once(tmp_path_factory, "meshes", write_meshes)


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder where all tests of this process may keep rendered samples, so that each is rendered once."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="session")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model that paints a ramp and, at hints, what they say."""

    def write(folder: Path) -> None:
        from onnx_models import write_model

        write_model(folder / "ramp.onnx")

    return made_once(tmp_path_factory, "ramp", write) / "ramp.onnx"


@pytest.fixture
def here(model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working directory but for that model, model.onnx."""
    monkeypatch.chdir(tmp_path)
    shutil.copyfile(model, "model.onnx")
    return tmp_path


@pytest.fixture
def shared_sketches() -> list[Path]:
    """Drawings by people."""
    folder = Path(__file__).parents[2] / "shared" / "sketches"
    found = [path for path in sorted(folder.rglob("*")) if path.suffix in {".png", ".svg"}]
    if not found:
        pytest.skip(SHARED_SKETCHES.reason("there are no drawings in it"))
    return found


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Look for no garbage while tests are collected, which imports the package and all that it needs."""
    with gc_paused():
        return (yield)


@pytest.hookimpl(tryfirst=True)  # before the slow ones are left out
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that hold slow tests, so that at the end no process waits long for another."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        slow = {item.path for item in items if item.get_closest_marker("slow")}
        items.sort(key=lambda item: item.path not in slow)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say at the end what this machine lacks, what was not tested for that, and how to get it."""
    reports = terminalreporter.getreports("skipped")
    for line in not_tested(report.longrepr[2] for report in reports if isinstance(report.longrepr, tuple)):
        terminalreporter.write_line(line, yellow=True)
