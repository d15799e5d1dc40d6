from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.reading.hint_files import load_hints


def painted(path: Path, colour: tuple[int, int, int], at: tuple[int, int] = (10, 20)) -> Path:
    image = Image.new("RGBA", (32, 32), (0, 0, 0, 0))
    image.putpixel(at, (*colour, 255))
    image.save(path)
    return path


def test_hints_are_read_where_they_are_painted(tmp_path: Path) -> None:
    hints = load_hints(painted(tmp_path / "hints.png", (255, 128, 128)), (32, 32))
    assert hints.points.tolist() == [[10.5, 20.5]]
    assert np.allclose(hints.normals, [(1, 0, 0)], atol=0.01)


def test_bad_hints_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\[255, 255, 255\] at x 10, y 20 of .* length 1, not 1.73"):
        load_hints(painted(tmp_path / "white.png", (255, 255, 255)), (32, 32))
    with pytest.raises(InputError, match="32 × 32 pixels, but their sketch 64 × 16"):
        load_hints(tmp_path / "white.png", (16, 64))
    Image.new("RGB", (32, 32)).save(tmp_path / "opaque.png")
    with pytest.raises(InputError, match="have no transparency"):
        load_hints(tmp_path / "opaque.png", (32, 32))
