"""A normal map as arrays and as files."""

from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import cv2
import numpy as np
import pytest

from normal_pngs import read_png
from normalgan.errors import InputError
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs import Normal
from normalgan.normals import Green, encode
from onnx_models import ramp


def tilted() -> NormalMap:
    """A ramp on a square."""
    mask = np.zeros((64, 64), bool)
    mask[10:50, 20:60] = True
    normals = np.ascontiguousarray(ramp(64).transpose(1, 2, 0))
    return NormalMap(normals, mask, mask.astype(np.float32), np.zeros((32, 32), np.float32), None, ())


def test_normals_are_unit_on_the_object_and_zero_off_it() -> None:
    preds = tilted()
    length = np.linalg.norm(preds.normal, axis=-1)
    np.testing.assert_allclose(length[preds.mask], 1, atol=1e-6)
    assert not length[~preds.mask].any()


def test_the_height_rises_where_normals_lean_away() -> None:
    # A bulge: normals lean to the right on its right, so that it is highest where they face the viewer.
    preds = tilted()
    height = preds.height()
    assert height[32, 40] < height[32, 32] > height[32, 22]
    assert not height[~preds.mask].any()


@pytest.mark.parametrize(("name", "atol"), [("a.png", 0.01), ("b/c.tiff", 1e-6), ("d.exr", 1e-6)])
def test_a_map_is_saved_as_its_path_ends(tmp_path: Path, name: str, atol: float) -> None:
    preds = tilted()
    preds.save(tmp_path / name)
    if name.endswith(".exr"):
        import OpenEXR

        pixels = OpenEXR.File(str(tmp_path / name)).channels()["RGB"].pixels
    else:
        raw: Any = cv2.imread(str(tmp_path / name), cv2.IMREAD_UNCHANGED)
        pixels = raw[..., ::-1] / (255 if raw.dtype == np.uint8 else 1)
    flat = np.where(preds.mask[..., None], preds.normal, [0, 0, 1])
    np.testing.assert_allclose(2 * pixels - 1, flat, atol=atol)


@pytest.mark.parametrize("inside", ["a ring", "nothing"])
@pytest.mark.parametrize("y", get_args(Green))
@pytest.mark.parametrize("opacity", [False, True])
def test_each_pixel_has_the_colour_of_its_normal_or_is_flat(inside: str, y: Green, opacity: bool) -> None:
    rows, columns = np.indices((64, 64))
    away = np.hypot(rows - 30, columns - 35)
    alpha = np.clip(20 - np.abs(away - 15) * 4, 0, 1).astype(np.float32) * (inside != "nothing")
    whole = tilted()
    preds = replace(whole, mask=alpha > 0.5, alpha=alpha)
    there = alpha > 0 if opacity else preds.mask
    normals = np.where(there[..., None], whole.extended, np.array([0, 0, 1], np.float32))
    wanted = encode(normals * np.array([1, 1 if y == "up" else -1, 1], np.float32))
    pixels = preds.pixels(y, opacity)
    np.testing.assert_array_equal(pixels[..., :3], wanted)
    if opacity:
        np.testing.assert_array_equal(pixels[..., 3], np.rint(alpha * 255))


def test_green_opacity_and_depth_are_as_asked_for(tmp_path: Path) -> None:
    preds = tilted()
    preds.save(tmp_path / "up.png", bits=16, alpha=True)
    preds.save(tmp_path / "down.png", y="down")
    up, alpha = read_png(tmp_path / "up.png")
    np.testing.assert_array_equal(alpha > 0.5, preds.mask)
    np.testing.assert_allclose(up[preds.mask], preds.normal[preds.mask], atol=1e-4)
    down, _ = read_png(tmp_path / "down.png")
    np.testing.assert_allclose(down[preds.mask][:, 1], -preds.normal[preds.mask][:, 1], atol=0.01)


@pytest.mark.parametrize(
    ("name", "settings", "sentence"),
    [
        ("a.jpg", {}, r"a\.jpg must end in one of \.png \.exr \.tif \.tiff\."),
        ("a.exr", {"bits": 16}, r"16 bits are not supported for .*a\.exr; a PNG has 8 or 16"),
        ("a.png", {"bits": 12}, r"12 bits are not supported for .*a\.png"),
        ("a.png", {"y": "left"}, r"y is up or down, not 'left'"),
    ],
)
def test_what_cannot_be_saved_is_refused(
    tmp_path: Path, name: str, settings: dict[str, Any], sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        tilted().save(tmp_path / name, **settings)
    assert not list(tmp_path.iterdir())


def test_a_notebook_shows_it() -> None:
    assert tilted()._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize("how", ["bilinear", "mipmap"])
def test_padding_keeps_the_rim_as_it_is_where_engines_blend(how: str) -> None:
    preds = tilted()
    lean = np.array([0.8, 0, 0.6], np.float32)
    whole = replace(preds, extended=np.broadcast_to(lean, (64, 64, 3)).copy())

    def sampled(pad: int | None) -> Any:
        levels: Any = cv2.imdecode(
            np.frombuffer(whole.encode(alpha=True, pad=pad), np.uint8), cv2.IMREAD_UNCHANGED
        )
        normals = levels[..., 2::-1].astype(np.float32) / 127.5 - 1
        if how == "mipmap":
            small = cv2.resize(normals, (4, 4), interpolation=cv2.INTER_AREA)
            seen = small[cv2.resize(levels[..., 3], (4, 4), interpolation=cv2.INTER_AREA) > 0]
        else:  # half-way between the rim and what is transparent
            rows = np.linspace(12, 48, 30, dtype=np.float32)[:, None]
            seen = cv2.remap(normals, np.full_like(rows, 59.5), rows, cv2.INTER_LINEAR).reshape(-1, 3)
        cosines = seen @ lean / np.linalg.norm(seen, axis=-1)
        return np.asarray(np.degrees(np.arccos(np.clip(cosines, -1, 1))))

    assert sampled(None).max() < 1
    assert sampled(0).max() > 10  # flat beside the rim: it is lit as if it faced the viewer
    beside = whole.pixels(alpha=True)
    assert (beside[~preds.mask][:, 3] == 0).all()


def test_no_padding_is_written_where_the_background_is_seen() -> None:
    preds = tilted()
    assert preds.encode() == preds.encode(pad=0)
    assert preds.encode() != preds.encode(pad=1)
    assert Normal(engine="unity").encode(preds) == {"_normal.png": preds.encode(pad=16)}
