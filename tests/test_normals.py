import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from normal_pngs import read_png
from normalgan import normals
from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.reading.drawings import read_normals
from normalgan.normals import Bits

angles = st.floats(-np.pi, np.pi)


def hemisphere(size: int = 64) -> Floats:
    y, x = (1 - 2 * np.mgrid[:size, :size][0] / (size - 1)), 2 * np.mgrid[:size, :size][1] / (size - 1) - 1
    z = np.sqrt(np.clip(1 - x**2 - y**2, 0, None))
    return normals.normalize(np.stack([x, y, z], -1))


@given(angles, angles)
def test_decoding_undoes_encoding(azimuth: float, elevation: float) -> None:
    n = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    for bits, tolerance in ((8, 0.5), (16, 0.002)):
        back = normals.decode(normals.encode(n, bits))  # type: ignore[arg-type]
        assert np.rad2deg(np.arccos(np.clip(back @ n, -1, 1))) < tolerance + 0.03  # float32 arccos


def test_flat_is_128_and_zero_too() -> None:
    assert normals.encode(np.array([0.0, 0.0, 1.0])).tolist() == [128, 128, 255]
    assert normals.encode(np.zeros(3), 16).tolist() == [32768] * 3


@pytest.mark.parametrize("bits", [8, 16])
def test_each_level_begins_where_exact_arithmetic_says(bits: Bits) -> None:
    top = 2**bits - 1
    # The floats of single precision about each boundary, (k + ½) / top.
    boundaries = ((2 * np.arange(top) + 1) / top - 1).astype(np.float32)
    near = [boundaries]
    for towards in (-2, 2):
        moved = boundaries
        for _ in range(3):
            moved = np.nextafter(moved, np.float32(towards))
            near.append(moved)
    chosen = np.stack(near)[:, :: 1 if bits == 8 else 97]  # fractions are slow
    chosen[np.abs(chosen) < 1e-15] = 0  # what is less does not change 1
    # Only 0 lies on a boundary, and its level is the even one of both, the upper.
    exact = [
        [math.floor((Fraction(float(value)) + 1) * top / 2 + Fraction(1, 2)) for value in row]
        for row in chosen
    ]
    assert normals.encode(chosen, bits).tolist() == exact
    assert normals.encode(np.array([-2.0, -1, 1, 2]), bits).tolist() == [0, 0, top, top]


def test_all_strips_of_a_large_map_are_encoded() -> None:
    large = np.random.default_rng(1).uniform(-1, 1, (301, 257, 3)).astype(np.float32)
    assert len(list(normals.strips(large.shape))) > 2
    assert (normals.encode(large) == np.stack([normals.encode(row) for row in large])).all()


def test_opacity_is_the_last_channel_of_pixels_and_red_or_blue_the_first() -> None:
    red, alpha = np.array([[[1.0, 0, 0]]]), np.array([[0.2]])
    assert normals.pixels_of(red, 8, alpha).tolist() == [[[255, 128, 128, 51]]]
    assert normals.pixels_of(red, 16, blue_first=True).tolist() == [[[32768, 32768, 65535]]]


def test_axes_are_opengl() -> None:
    colours = normals.encode(np.eye(3))
    assert colours.tolist() == [[255, 128, 128], [128, 255, 128], [128, 128, 255]]


@pytest.mark.parametrize("bits", [8, 16])
def test_files_keep_normals(tmp_path: Path, bits: Bits) -> None:
    truth = hemisphere()
    (tmp_path / "map.png").write_bytes(normals.encode_png(truth, bits))
    back, alpha = read_png(tmp_path / "map.png")
    angle = np.rad2deg(np.arctan2(np.linalg.norm(np.cross(truth, back), axis=-1), (truth * back).sum(-1)))
    assert angle.max() < (0.5 if bits == 8 else 0.002)
    assert (alpha == 1).all()


def test_channels_are_in_order_for_other_programs(tmp_path: Path) -> None:
    red = np.broadcast_to(np.array([1.0, 0.0, 0.0]), (4, 4, 3))
    (tmp_path / "map.png").write_bytes(normals.encode_png(red))
    with Image.open(tmp_path / "map.png") as image:
        assert image.mode == "RGB"
        assert image.getpixel((0, 0)) == (255, 128, 128)


def test_alpha_is_read(tmp_path: Path) -> None:
    Image.new("RGBA", (4, 4), (128, 128, 255, 51)).save(tmp_path / "map.png")
    flat, alpha = read_png(tmp_path / "map.png")
    assert np.allclose(flat, (0, 0, 1), atol=0.01)
    assert np.allclose(alpha, 0.2)


def test_green_flips_to_directx_and_back() -> None:
    n = hemisphere()
    assert (normals.flip_green(n)[..., 1] == -n[..., 1]).all()
    assert (normals.flip_green(normals.flip_green(n)) == n).all()


def test_flat_is_painted_off_the_object_alone() -> None:
    mask = np.array([[True, False]])
    painted = normals.paint_flat(np.array([[[1.0, 0, 0], [0, 0, 0]]], np.float32), mask)
    assert painted.tolist() == [[[1, 0, 0], [0, 0, 1]]]


@pytest.mark.parametrize(
    ("content", "message"), [(b"", "not an image"), (b"hello", "not an image"), (None, "there is no file")]
)
def test_bad_files_are_said(tmp_path: Path, content: bytes | None, message: str) -> None:
    if content is not None:
        (tmp_path / "map.png").write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_normals(tmp_path / "map.png")


def test_a_grey_picture_is_no_normal_map(tmp_path: Path) -> None:
    Image.new("L", (8, 8)).save(tmp_path / "map.png")
    with pytest.raises(InputError, match="is grey; a normal map needs three channels"):
        read_normals(tmp_path / "map.png")
