from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.reading import drawings
from normalgan.inference.reading.drawings import read_drawing, read_pixels
from normalgan.inference.reading.hint_files import load_hints


def cross(size: int = 32) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    """Black lines on white paper, (size, size)."""
    grey = np.full((size, size), 255, np.uint8)
    grey[size // 2, 4:-4] = grey[4:-4, size // 3] = 0
    return grey


def written(path: Path, mode: str) -> Path:
    grey = Image.fromarray(cross())
    ink = Image.fromarray(255 - cross())
    match mode:
        case "RGBA":  # black lines on nothing
            image = Image.new("RGBA", grey.size, (0, 0, 0, 0))
            image.putalpha(ink)
        case "P":
            image = grey.convert("P")
        case "P transparent":
            image = grey.convert("P")
            image.info["transparency"] = image.getpixel((0, 0))
        case "I;16":
            image = Image.fromarray(cross().astype(np.uint16) * 257)
        case "LA":
            image = Image.merge("LA", [Image.new("L", grey.size, 0), ink])
        case _:
            image = grey.convert("RGB").convert(mode)
    image.save(path)
    return path


@pytest.mark.parametrize(
    ("mode", "suffix"),
    [
        ("L", ".png"),
        ("RGB", ".png"),
        ("RGB", ".webp"),
        ("RGBA", ".png"),
        ("LA", ".png"),
        ("P", ".png"),
        ("P", ".gif"),
        ("P transparent", ".png"),
        ("1", ".png"),
        ("I;16", ".png"),
        ("CMYK", ".jpg"),
        ("RGB", ".jpg"),
    ],
)
def test_every_mode_reads_as_the_same_drawing(tmp_path: Path, mode: str, suffix: str) -> None:
    ink = read_drawing(written(tmp_path / f"cross{suffix}", mode))
    assert ink.shape == (32, 32)
    assert np.abs(ink - (1 - cross() / 255)).mean() < (0.06 if suffix in {".jpg", ".webp"} else 0.005)


def test_a_photo_is_turned_upright(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6  # the camera lay on its side
    Image.fromarray(cross()).save(tmp_path / "photo.jpg", exif=exif, quality=95)
    assert np.abs(read_drawing(tmp_path / "photo.jpg") - np.rot90(1 - cross() / 255, -1)).mean() < 0.06


def test_bad_drawings_are_named(tmp_path: Path) -> None:
    (tmp_path / "text.png").write_text("not a picture")
    (tmp_path / "empty.png").write_bytes(b"")
    Image.fromarray(cross(200)).save(tmp_path / "whole.png")
    (tmp_path / "half.png").write_bytes((tmp_path / "whole.png").read_bytes()[:150])
    Image.new("L", (1, 1)).save(tmp_path / "dot.png")
    Image.new("L", (64, 64), 255).save(tmp_path / "white.png")
    for name, message in {
        "text": "is not an image that can be read",
        "empty": "is not an image that can be read",
        "half": "cannot be read as an image",
        "dot": "is 1 × 1 pixels; a drawing has 8 to 8192 a side",
        "white": "is all white",
        "none": "there is no file",
    }.items():
        with pytest.raises(InputError, match=message) as error:
            read_drawing(tmp_path / f"{name}.png")
        assert f"{name}.png" in str(error.value)


def test_a_bomb_is_refused_by_its_size(tmp_path: Path) -> None:
    Image.new("1", (9_000, 9_000)).save(tmp_path / "bomb.png")
    with pytest.raises(InputError, match="9000 × 9000"):
        read_drawing(tmp_path / "bomb.png")


def test_a_file_of_no_drawings_size_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sparse = tmp_path / "sparse.png"
    with sparse.open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(InputError, match=r"sparse.png has more than 536870912 bytes; no file of its kind"):
        read_drawing(sparse)
    with pytest.raises(InputError, match=r"sparse.png has more than 536870912 bytes; no file of its kind"):
        load_hints(sparse, (32, 32))
    monkeypatch.setattr(drawings, "MOST_BYTES", 1000)
    with pytest.raises(InputError, match="stdin has more than 1000 bytes; a drawing is smaller"):
        read_pixels(Path("stdin"), bytes(1001))
