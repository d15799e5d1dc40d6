from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from normalgan.__main__ import main
from normalgan.files.writing import write_bytes
from normalgan.inference.reading.drawings import read_normals
from normalgan.normals import angles, encode_grey, encode_png, normalize

ALONG = (np.arange(64, dtype=np.float32) - 31.5) / 32
X, Y = np.meshgrid(ALONG, -ALONG)
HEIGHT = np.asarray(8 * np.exp(-3 * (X**2 + Y**2)), np.float32)
"""A hill of 8 pixels; its slopes are those of pixels."""
NORMALS = normalize(np.stack([6 * X * HEIGHT / 32, 6 * Y * HEIGHT / 32, np.ones_like(X)], axis=-1))


@pytest.fixture
def hill(tmp_path: Path) -> Path:
    path = tmp_path / "hill.png"
    write_bytes(path, encode_png(NORMALS, 16))
    return path


def off(path: Path, truth: np.ndarray, green: str = "up") -> float:
    """Return the largest angle in degrees between a map in a file and the truth, off the border."""
    found = normalize(read_normals(path, green)[0])  # type: ignore[arg-type]
    return float(np.max(np.asarray(angles(found, truth))[2:-2, 2:-2]))


@pytest.mark.parametrize("name", ["a.png", "a.exr", "a.tiff"])
def test_green_bits_and_format_change_and_the_surface_does_not(hill: Path, tmp_path: Path, name: str) -> None:
    down = tmp_path / name
    assert main(["convert", str(hill), "-o", str(down), "--y", "down"]) == 0
    assert off(down, NORMALS, "down") < 0.7
    assert off(down, NORMALS, "up") > 10
    back = tmp_path / "back.png"
    assert main(["convert", str(down), "-o", str(back), "--from-y", "down", "--bits", "16"]) == 0
    assert off(back, NORMALS) < 0.7


def test_normals_and_heights_are_turned_into_each_other(hill: Path, tmp_path: Path) -> None:
    height, normals = tmp_path / "height.tiff", tmp_path / "normal.png"
    assert main(["convert", str(hill), "-o", str(height), "--to", "height"]) == 0
    found = cv2.imread(str(height), cv2.IMREAD_UNCHANGED)
    assert found is not None
    assert np.abs((found - found.mean()) - (HEIGHT - HEIGHT.mean())).max() < 0.4
    assert main(["convert", str(height), "-o", str(normals), "--from", "height", "--scale", "1"]) == 0
    assert off(normals, NORMALS) < 1.5
    grey = tmp_path / "grey.png"
    write_bytes(grey, encode_grey((HEIGHT / 8).astype(np.float32), ".png", 16))
    assert main(["convert", str(grey), "-o", str(normals), "--from", "height", "--scale", "8"]) == 0
    assert off(normals, NORMALS) < 1.5


@pytest.mark.parametrize("nothing", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("vectors", [True, False], ids=["vectors", "colours"])
def test_pixels_that_are_not_finite_are_transparent_and_the_others_stay(
    tmp_path: Path, nothing: float, vectors: bool
) -> None:
    there = X**2 + Y**2 < 0.5
    held = np.where(there[..., None], NORMALS if vectors else (NORMALS + 1) / 2, nothing).astype(np.float32)
    cv2.imwrite(str(tmp_path / "pass.tiff"), held[..., ::-1])
    out = tmp_path / "out.png"
    assert main(["convert", str(tmp_path / "pass.tiff"), "-o", str(out), "--bits", "16"]) == 0
    found, alpha = read_normals(out)
    np.testing.assert_array_equal(alpha, there)
    assert np.asarray(angles(normalize(found)[there], NORMALS[there])).max() < 0.1


def test_a_map_without_a_finite_pixel_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cv2.imwrite(str(tmp_path / "pass.tiff"), np.full((16, 16, 3), np.nan, np.float32))
    assert main(["convert", str(tmp_path / "pass.tiff"), "-o", str(tmp_path / "out.png")]) == 2
    assert "pass.tiff has no pixel with finite numbers." in capsys.readouterr().err


@pytest.mark.parametrize("mode", ["L", "LA", "RGB"])
def test_a_grey_picture_is_not_a_normal_map(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], mode: str
) -> None:
    Image.fromarray(np.rint(30 * HEIGHT).astype(np.uint8)).convert(mode).save(tmp_path / "grey.png")
    assert main(["convert", str(tmp_path / "grey.png"), "-o", str(tmp_path / "out.png")]) == 2
    assert "grey.png is grey; a normal map needs three channels." in capsys.readouterr().err


@pytest.mark.parametrize("middle", [127, 128])
def test_the_heights_of_a_flat_area_are_level(tmp_path: Path, middle: int) -> None:
    flat = np.full((60, 300, 3), [255, middle, middle], np.uint8)  # blue first
    cv2.imwrite(str(tmp_path / "flat.png"), flat)
    height = tmp_path / "height.tiff"
    assert main(["convert", str(tmp_path / "flat.png"), "-o", str(height), "--to", "height"]) == 0
    found = cv2.imread(str(height), cv2.IMREAD_UNCHANGED)
    assert found is not None
    assert np.ptp(found) < 0.01


def test_a_detail_is_repeated_and_stands_on_the_surface(hill: Path, tmp_path: Path) -> None:
    tilt = np.broadcast_to(np.array([0.6, 0, 0.8], np.float32), (10, 10, 3))
    detail, out = tmp_path / "detail.png", tmp_path / "out.png"
    write_bytes(detail, encode_png(tilt, 16))
    arguments = ["convert", str(hill), "-o", str(out), "--detail", str(detail), "--bits", "16"]
    assert main(arguments) == 0
    found = normalize(read_normals(out)[0])
    # Everywhere the detail makes its own angle with the surface below it.
    turned = np.asarray(angles(found, NORMALS))
    np.testing.assert_allclose(turned, np.degrees(np.arccos(0.8)), atol=0.1)


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        (["-o", "x.jpg"], "x.jpg must end in one of .png .exr .tif .tiff"),
        (["-o", "x.exr", "--to", "height"], "the height map x.exr must end in .png, .tif or .tiff"),
        (
            ["-o", "x.png", "--from", "height"],
            "needs --scale: the pixels from black to white; 1 for a TIFF of heights in pixels",
        ),
        (["-o", "x.png", "--to", "height", "--bits", "16"], "--bits applies to an output normal map"),
        (
            ["-o", "x.tiff", "--to", "height", "--scale", "4"],
            "--scale applies to a PNG; x.tiff holds heights",
        ),
        (["-o", "x.png", "--scale", "4"], "--scale applies to a height map; add --from height"),
        (["-o", "x.png", "--detail-y", "down"], "--detail-y applies to the details; add --detail."),
        (["-o", ""], "--output is empty; name a file"),
        (["-o", "hill.png"], "hill.png is an input and would be overwritten"),
        (["-o", "x.png", "--detail", "gone.png"], "there is no file gone.png"),
    ],
)
def test_inputs_that_cannot_be_converted_are_one_sentence(
    hill: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    more: list[str],
    sentence: str,
) -> None:
    monkeypatch.chdir(hill.parent)
    assert main(["convert", "hill.png", *more]) == 2
    assert sentence in capsys.readouterr().err
    assert [path.name for path in hill.parent.iterdir()] == ["hill.png"]


def test_a_map_may_begin_with_a_dash(hill: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(hill.parent)
    dashed = hill.rename("-hill.png")
    assert main(["convert", dashed.name, "-o", "a.png", "--bits", "16"]) == 0
    assert main(["convert", "-o", "b.png", "--", dashed.name]) == 0
    assert off(Path("a.png"), NORMALS) < 0.7
    assert off(Path("b.png"), NORMALS) < 0.7


def test_the_map_of_details_is_not_overwritten(
    hill: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(hill.parent)
    skin = hill.with_name("skin.png")
    write_bytes(skin, encode_png(NORMALS))
    before = skin.read_bytes()
    assert main(["convert", "hill.png", "--detail", "skin.png", "-o", str(skin)]) == 2
    assert "skin.png is an input and would be overwritten" in capsys.readouterr().err
    assert skin.read_bytes() == before


@pytest.mark.parametrize(
    "more",
    [
        ["moves.webp"],
        ["moves.webp", "--from", "height", "--scale", "9"],
        ["hill.png", "--detail", "moves.webp"],
    ],
)
def test_a_map_of_several_pictures_is_refused(
    hill: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], more: list[str]
) -> None:
    monkeypatch.chdir(hill.parent)
    with Image.open("hill.png") as first:
        first.save("moves.webp", save_all=True, append_images=[first.rotate(90)], lossless=True)
    assert main(["convert", *more, "-o", "x.png"]) == 2
    assert "moves.webp has several pictures; give one" in capsys.readouterr().err
    assert not Path("x.png").exists()
