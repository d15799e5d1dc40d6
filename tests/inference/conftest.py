"""What tests of inference share."""

from pathlib import Path

import pytest


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A model that paints a ramp and, at hints, what they say."""
    from onnx_models import write_model

    return write_model(tmp_path / "ramp.onnx")


@pytest.fixture
def shared_sketches() -> list[Path]:
    """Drawings by people."""
    folder = Path(__file__).parents[3] / "shared" / "sketches"
    found = [path for path in sorted(folder.rglob("*")) if path.suffix in {".png", ".svg"}]
    if not found:
        pytest.skip("there are no drawings in ../shared/sketches")
    return found
