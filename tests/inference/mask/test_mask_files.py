"""One rule for a mask: opaque on nothing, whatever its colour; else white on black."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.inputs import as_mask
from normalgan.inference.mask.mask_files import load_mask
from normalgan.studio.drawings.drawing_request import DrawingRequest

OBJECT = np.zeros((30, 40), bool)
OBJECT[8:20, 10:30] = True


def pictured(colour: int, opaque: NDArray[np.bool_], inside: NDArray[np.bool_] = OBJECT) -> Image.Image:
    """Return ``colour`` inside, black elsewhere, with an opacity."""
    grey = np.where(inside, colour, 0).astype(np.uint8)
    return Image.fromarray(np.dstack([grey, grey, grey, np.where(opaque, 255, 0).astype(np.uint8)]))


EVERYWHERE = np.ones_like(OBJECT)
SEEN = [
    pytest.param(pictured(255, EVERYWHERE).convert("L"), id="white on black"),
    pytest.param(pictured(255, EVERYWHERE), id="white on black, with opacity that says nothing"),
    pytest.param(pictured(255, OBJECT), id="white on nothing"),
    pytest.param(pictured(0, OBJECT), id="black on nothing"),
    pytest.param(pictured(90, OBJECT), id="grey on nothing"),
]


@pytest.mark.parametrize("image", SEEN)
def test_every_door_takes_a_mask_for_the_same(image: Image.Image, tmp_path: Path) -> None:
    image.save(tmp_path / "mask.png")
    Image.new("L", (40, 30), 255).save(tmp_path / "sketch.png")
    request = DrawingRequest((tmp_path / "sketch.png").read_bytes(), (tmp_path / "mask.png").read_bytes())
    given = [load_mask(tmp_path / "mask.png", (30, 40)), as_mask(image, (30, 40)), request.read_lines()[1]]
    for mask in given:
        np.testing.assert_array_equal(mask, OBJECT)


@pytest.mark.parametrize(
    "image", [pictured(0, EVERYWHERE), pictured(255, ~EVERYWHERE)], ids=["black", "clear"]
)
def test_an_empty_mask_is_refused_at_every_door(image: Image.Image, tmp_path: Path) -> None:
    image.save(tmp_path / "mask.png")
    Image.new("L", (40, 30), 255).save(tmp_path / "sketch.png")
    request = DrawingRequest((tmp_path / "sketch.png").read_bytes(), (tmp_path / "mask.png").read_bytes())
    with pytest.raises(InputError, match=r"^the mask .*mask\.png is empty; paint the object white"):
        load_mask(tmp_path / "mask.png", (30, 40))
    with pytest.raises(InputError, match=r"^the mask is empty; paint the object white"):
        request.read_lines()
    with pytest.raises(InputError, match=r"^the mask is empty; paint the object white"):
        as_mask(image, (30, 40))


def test_a_mask_of_zeros_and_ones_is_told_how_dark_it_is() -> None:
    with pytest.raises(InputError, match=r"^the mask is empty: its brightest pixel is 1 of 255; paint the"):
        as_mask(Image.fromarray(OBJECT.astype(np.uint8)), (30, 40))
