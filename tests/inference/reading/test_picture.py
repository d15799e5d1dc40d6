"""Pictures as they come: read right, or refused in one sentence before they fill the memory."""

import io
import struct
import sys
import tracemalloc
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from normalgan.decoding.decoders.opening import RefusedError
from normalgan.decoding.decoders.pictures import decode
from normalgan.errors import InputError
from normalgan.inference.inputs import as_picture
from normalgan.inference.reading.drawings import read_pixels
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
        (b"\x89PNG\r\n\x1a\n", "it starts like a PNG but is truncated or damaged"),
        (saved(Image.fromarray(GREY), "GIF")[:9], "cannot be read as an image: it starts like a GIF"),
        (saved(Image.fromarray(GREY), "JPEG")[:900], "cannot be read as an image: the file is incomplete"),
        (saved(Image.fromarray(GREY), "PNG")[:900], "cannot be read as an image: the file is incomplete"),
        (saved(Image.fromarray(GREY), "PNG")[:20], "cannot be read as an image: the file is incomplete"),
        (bomb(300, 200), "cannot be read as an image"),
    ],
    ids=[
        "empty",
        "a signature",
        "the head of a GIF",
        "half a JPEG",
        "half a PNG",
        "the head of a PNG",
        "too few pixels",
    ],
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


def levels_png(levels: np.ndarray, kind: int, *more: bytes) -> bytes:
    """Return a PNG of 16 bits a channel, big-endian, with chunks before its pixels."""
    header = struct.pack(">IIBBBBB", levels.shape[1], levels.shape[0], 16, kind, 0, 0, 0)
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in levels)
    parts = chunk(b"IHDR", header), *more, chunk(b"IDAT", zlib.compress(rows)), chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


DEEP = GREY.astype(np.uint16) * 257 // 8 * 8  # so that some levels are not used
COLOURS = np.stack([DEEP, DEEP, DEEP], axis=-1)


def test_a_transparent_grey_of_16_bits_clips_nothing() -> None:
    unused = levels_png(DEEP, 0, chunk(b"tRNS", struct.pack(">H", 3)))
    assert np.abs(read(unused) - GREY).max() < 1
    assert read_picture(Path("a"), unused).alpha is None
    paper = int(DEEP[2, 2])
    seen = read_picture(Path("a"), levels_png(DEEP, 0, chunk(b"tRNS", struct.pack(">H", paper))))
    assert seen.alpha is not None
    assert (seen.alpha == (paper != DEEP)).all()
    ink = paper != DEEP
    assert np.abs(255 * seen.colour.mean(-1) - GREY)[ink].max() < 1.1


def test_a_transparent_colour_of_16_bits_clips_nothing() -> None:
    unused = levels_png(COLOURS, 2, chunk(b"tRNS", struct.pack(">HHH", 3, 30_000, 50_001)))
    assert np.abs(read(unused) - GREY).max() < 1.1
    paper = [int(each) for each in COLOURS[2, 2]]
    seen = read_picture(Path("a"), levels_png(COLOURS, 2, chunk(b"tRNS", struct.pack(">HHH", *paper))))
    assert seen.alpha is not None
    assert seen.alpha[2, 2] == 0
    assert seen.alpha[GREY < 20].min() == 1


@pytest.mark.parametrize("bits", [8, 10, 12, 14])
def test_fewer_bits_in_16_are_as_bright_as_all(bits: int) -> None:
    levels = np.rint(GREY / 255 * (2**bits - 1)).astype(np.uint16)
    assert np.abs(read(saved(Image.fromarray(levels), "PNG")) - GREY).max() < 1
    assert np.abs(read(saved(Image.fromarray(levels.astype(np.int32)), "TIFF")) - GREY).max() < 1


@pytest.mark.parametrize("white", [1.0, 255.0, 65535.0])
@pytest.mark.parametrize("kind", ["float32", "float64"])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_tiffs_of_floats_are_read(kind: str, channels: int, white: float) -> None:
    grey = np.asarray(GREY / 255 * white, kind)
    levels = (
        grey if channels == 1 else np.stack([grey] * 3 + [np.full_like(grey, white)] * (channels - 3), -1)
    )
    done, content = cv2.imencode(".tiff", levels)
    assert done
    assert np.abs(read(content.tobytes()) - GREY).max() < 0.01
    drawing = 255 * (1 - read_pixels(Path("a"), content.tobytes(), grey=True).pixels / white)
    assert np.abs(drawing - (255 - GREY)).max() < 0.01


@pytest.mark.parametrize(
    "exif", [b"Exif\0\0II*\0\xff\xff\xff\xff", b"II*", b"\0", b"Exif\0\0" + b"\xff" * 40]
)
@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_a_sound_picture_with_damaged_notes_is_read(kind: str, exif: bytes) -> None:
    image = Image.fromarray(GREY).convert("RGB")
    settings = {"quality": 100} if kind == "JPEG" else {"lossless": True} if kind == "WEBP" else {}
    content = saved(image, kind, exif=exif, **settings)
    assert np.abs(read(content) - GREY).max() < 4
    if kind == "JPEG":  # Pillow warns of it as it opens one
        return
    opened = Image.open(io.BytesIO(content))
    assert np.abs(255 * as_picture(opened).colour.mean(-1) - GREY).max() < 4


def test_avif_and_heic_are_read() -> None:
    image = Image.fromarray(GREY).convert("RGB")
    assert np.abs(read(saved(image, "AVIF", quality=100)) - GREY).mean() < 2
    heif = pytest.importorskip("pillow_heif", reason="the extra heic is not installed")
    file = io.BytesIO()
    heif.from_pillow(image).save(file, quality=100)
    assert np.abs(read(file.getvalue()) - GREY).mean() < 3


def test_what_is_not_installed_is_told_with_a_way_out(monkeypatch: pytest.MonkeyPatch) -> None:
    head = b"\0\0\0\x18ftypheic\0\0\0\0mif1heic"
    monkeypatch.setitem(sys.modules, "pillow_heif", None)
    with pytest.raises(RefusedError, match=r"is a HEIC; run `pip install 'normalgan\[heic\]'` .* as PNG"):
        decode(head, 8, 64, 64, 0, False, [])


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


@pytest.mark.parametrize("channels", [3, 4])
def test_a_pixel_is_as_dark_as_its_darkest_colour(channels: int) -> None:
    values = np.random.default_rng(1).random((6, 7, channels)).astype(np.float32)
    found = Picture(values[..., :3], None).darkness()
    expected = [[1 - min(map(float, pixel)) for pixel in row] for row in values[..., :3]]
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, atol=1e-6)
