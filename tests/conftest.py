"""What tests of several folders share; being here, it also lets them import the modules beside it."""

import signal
from pathlib import Path

import pytest
from hypothesis import settings

# The same examples each time, lest a change be refused for one that it has nothing to do with;
# --hypothesis-profile=default tries others.
settings.register_profile("steady", derandomize=True)
settings.load_profile("steady")

# A shell that starts the tests in the background has Ctrl-C ignored, and what they start inherits that.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of five meshes of different formats."""
    from small import write_meshes  # here: most tests need no lightning, which takes seconds to import

    folder = tmp_path_factory.mktemp("meshes")
    write_meshes(folder)
    return folder


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder where all tests may keep rendered samples, so that each is rendered once."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A model that paints a ramp and, at hints, what they say."""
    from onnx_models import write_model

    return write_model(tmp_path / "ramp.onnx")


@pytest.fixture
def shared_sketches() -> list[Path]:
    """Drawings by people."""
    folder = Path(__file__).parents[2] / "shared" / "sketches"
    found = [path for path in sorted(folder.rglob("*")) if path.suffix in {".png", ".svg"}]
    if not found:
        pytest.skip("there are no drawings in ../shared/sketches")
    return found
