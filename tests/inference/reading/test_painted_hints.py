from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.reading.hint_files import read_hints


def painted(path: Path, colour: tuple[int, int, int], at: tuple[int, int] = (10, 20)) -> Path:
    image = Image.new("RGBA", (32, 32), (0, 0, 0, 0))
    image.putpixel(at, (*colour, 255))
    image.save(path)
    return path


def test_hints_are_read_where_they_are_painted(tmp_path: Path) -> None:
    normals, where = read_hints(painted(tmp_path / "hints.png", (255, 128, 128)), (32, 32))
    assert where.sum() == 1
    assert where[20, 10]
    assert np.allclose(normals[20, 10], (1, 0, 0), atol=0.01)
    assert np.abs(normals).sum() == pytest.approx(np.abs(normals[20, 10]).sum())


def test_bad_hints_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\[255, 255, 255\] at x 10, y 20 of .* length 1, not 1.73"):
        read_hints(painted(tmp_path / "white.png", (255, 255, 255)), (32, 32))
    with pytest.raises(InputError, match="32 × 32 pixels, but their sketch 64 × 16"):
        read_hints(tmp_path / "white.png", (16, 64))
    Image.new("RGB", (32, 32)).save(tmp_path / "opaque.png")
    with pytest.raises(InputError, match="have no transparency"):
        read_hints(tmp_path / "opaque.png", (32, 32))
