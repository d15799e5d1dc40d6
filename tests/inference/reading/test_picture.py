"""Pictures as they come: read right, or refused in one sentence before they fill the memory."""

import io
import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.reading.picture import Picture, read_picture
from pens import blob, outline

GREY = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def bomb(width: int, height: int) -> bytes:
    """Return a PNG of a few bytes that claims to be as large."""
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    pixels = zlib.compress(bytes(1000))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")


def saved(image: Image.Image, kind: str, **settings: object) -> bytes:
    file = io.BytesIO()
    image.save(file, kind, **settings)
    return file.getvalue()


def read(content: bytes) -> np.ndarray:
    """Return how bright what was read is, (H, W) from 0 to 255."""
    return np.asarray(255 * read_picture(Path("a"), content).colour.mean(-1))


@pytest.mark.parametrize("side", [8193, 60_000, 2**31 - 1])
def test_a_picture_that_claims_to_be_huge_is_refused_before_it_is_unpacked(side: int) -> None:
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as refused:
            read_picture(Path("bomb.png"), bomb(side, side))
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()
    assert "bomb.png" in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "is not an image that can be read"),
        (b"\x89PNG\r\n\x1a\n", "it begins as a PNG and is cut short or damaged"),
        (saved(Image.fromarray(GREY), "GIF")[:9], "cannot be read as an image: it begins as a GIF"),
        (saved(Image.fromarray(GREY), "JPEG")[:900], "cannot be read as an image"),
        (saved(Image.fromarray(GREY), "PNG")[:900], "cannot be read as an image"),
        (bomb(300, 200), "cannot be read as an image"),
    ],
    ids=["empty", "a signature", "the head of a GIF", "half a JPEG", "half a PNG", "too few pixels"],
)
def test_a_broken_file_is_refused(content: bytes, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        read_picture(Path("a.png"), content)


def test_of_an_animation_the_first_picture_is_taken() -> None:
    first, second = Image.fromarray(GREY), Image.new("L", (300, 200), 0)
    content = saved(first, "GIF", save_all=True, append_images=[second], duration=50)
    assert np.abs(read(content) - GREY).max() < 3


def test_colours_for_print_are_read() -> None:
    content = saved(Image.fromarray(GREY).convert("CMYK"), "JPEG", quality=95)
    assert np.abs(read(content) - GREY).mean() < 2


def test_a_palette_and_its_transparent_colour_are_read() -> None:
    image = Image.fromarray(GREY).convert("RGB").quantize(16)
    assert np.abs(read(saved(image, "PNG")) - GREY).mean() < 6
    paper = image.getpixel((2, 2))
    picture = read_picture(Path("a"), saved(image, "PNG", transparency=paper))
    assert picture.alpha is not None
    assert picture.alpha[2, 2] == 0
    assert picture.alpha[GREY < 20].min() == 1


def test_sixteen_bits_are_read() -> None:
    assert np.abs(read(saved(Image.fromarray(GREY.astype(np.uint16) * 257), "PNG")) - GREY).max() < 1


@pytest.mark.parametrize("turn", range(1, 9))
def test_a_camera_that_was_turned_is_turned_back(turn: int) -> None:
    undo = {
        2: Image.Transpose.FLIP_LEFT_RIGHT, 3: Image.Transpose.ROTATE_180, 4: Image.Transpose.FLIP_TOP_BOTTOM,
        5: Image.Transpose.TRANSPOSE, 6: Image.Transpose.ROTATE_90, 7: Image.Transpose.TRANSVERSE,
        8: Image.Transpose.ROTATE_270,
    }  # fmt: skip
    image, exif = Image.fromarray(GREY), Image.Exif()
    exif[0x0112] = turn
    stored = image.transpose(undo[turn]) if turn > 1 else image
    assert (read(saved(stored, "PNG", exif=exif)).round() == GREY).all()


def test_a_picture_without_opacity_is_resized_as_one_that_is_opaque_everywhere() -> None:
    colour = np.random.default_rng(1).random((60, 40, 3)).astype(np.float32)
    for shape in ((30, 20), (47, 31), (90, 60)):
        found = Picture(colour, None).resized(shape)
        opaque = Picture(colour, np.ones((60, 40), np.float32)).resized(shape)
        assert found.alpha is None
        np.testing.assert_allclose(found.colour, opaque.colour, atol=1e-6)
