import numpy as np
import pytest
from numpy.typing import NDArray

from normalgan.inference.structures import KINDS, Kind, Placement, Tile, impress, make_heights, read_tile
from normalgan.inference.unrolling import unroll

SIDE = 96


def flat(side: int = SIDE) -> NDArray[np.float32]:
    return np.dstack([np.zeros((side, side)), np.zeros((side, side)), np.ones((side, side))]).astype(
        np.float32
    )


def impressed(kind: Kind, placement: Placement, side: int = SIDE) -> NDArray[np.floating]:
    whole = np.ones((side, side), np.float32)
    return impress(flat(side), whole > 0, whole, read_tile(kind), placement)


@pytest.mark.parametrize("kind", KINDS)
def test_a_structure_repeats_without_a_seam(kind: Kind) -> None:
    heights = make_heights(kind)
    for axis in (0, 1):
        steps = np.abs(np.diff(heights, axis=axis, append=np.take(heights, [0], axis)))
        seam = np.take(steps, -1, axis)
        assert seam.mean() < 2 * steps.mean()
        assert seam.max() <= steps.max() + 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_all_structures_are_equally_steep(kind: Kind) -> None:
    slopes = read_tile(kind).levels[0]
    assert np.sqrt((slopes**2).sum(-1).mean()) == pytest.approx(0.6, rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_smaller_map_shows_the_same_structure(kind: Kind) -> None:
    large = impressed(kind, Placement(256, x=3, y=5), 256)
    small = impressed(kind, Placement(128, x=1.5, y=2.5), 128)
    mean = large.reshape(128, 2, 128, 2, 3).mean((1, 3))
    for axis in (0, 1):
        assert np.corrcoef(mean[..., axis].ravel(), small[..., axis].ravel())[0, 1] > 0.85
    assert 0.7 < np.abs(small[..., :2]).mean() / np.abs(mean[..., :2]).mean() < 1.25


def test_a_turned_and_mirrored_structure_is_the_structure_turned_and_mirrored() -> None:
    plain = impressed("stone", Placement(48))
    # Tiles about the paper's upper right corner, clockwise.
    turned = impressed("stone", Placement(48, np.pi / 2, x=SIDE))
    wanted = np.rot90(plain, -1)
    assert np.allclose(turned, np.dstack([wanted[..., 1], -wanted[..., 0], wanted[..., 2]]), atol=1e-4)
    flipped = impressed("stone", Placement(48, x=SIDE, flipped=True))
    assert np.allclose(flipped, plain[:, ::-1] * [-1, 1, 1], atol=1e-4)


def test_a_structure_stands_on_a_leaning_surface_where_it_is_covered() -> None:
    leaning = np.broadcast_to(np.array([0.6, 0, 0.8], np.float32), (SIDE, SIDE, 3)).copy()
    cover = np.zeros((SIDE, SIDE), np.float32)
    cover[:, 16:], cover[:, 64:] = 0.5, 1
    mask = np.ones((SIDE, SIDE), bool)
    mask[80:] = False
    found = impress(leaning, mask, cover, read_tile("scales"), Placement(48))
    assert np.array_equal(found[:, :16], leaning[:, :16])
    assert np.array_equal(found[80:], leaning[80:])
    assert np.linalg.norm(found, axis=-1) == pytest.approx(1, abs=1e-5)
    assert np.degrees(np.arccos(found[:80, 16:].mean((0, 1)) @ [0.6, 0, 0.8])) < 15
    half, full = (np.abs(found[:80, part] - leaning[0, 0]).mean() for part in (np.s_[16:64], np.s_[64:]))
    assert 0.3 * full < half < 0.8 * full


def test_an_even_picture_is_no_structure() -> None:
    whole = np.ones((SIDE, SIDE), np.float32)
    tile = Tile.of(np.full((64, 64), 0.3, np.float32))
    assert np.array_equal(impress(flat(), whole > 0, whole, tile, Placement(32)), flat())


def cylinder(side: int) -> NDArray[np.float32]:
    x = np.tile((np.arange(side) + 0.5) / side * 2 - 1, (side, 1))
    return np.dstack([x, np.zeros_like(x), np.sqrt(1 - x**2)]).astype(np.float32)


def test_a_structure_narrows_towards_the_rim() -> None:
    side, period = 512, 16
    ribs = np.tile(np.sin(np.arange(64) * 2 * np.pi / 64), (64, 1)).astype(np.float32)
    whole = np.ones((side, side), np.float32)
    found = impress(cylinder(side), whole > 0, whole, Tile.of(ribs), Placement(period))
    leaning = np.arctan2(found[side // 2, :, 0], found[side // 2, :, 2])
    ribbed = leaning - np.arcsin((np.arange(side) + 0.5) / side * 2 - 1)
    begins = np.flatnonzero((ribbed[:-1] < 0) & (ribbed[1:] >= 0))
    angles = np.degrees(np.arcsin((begins + 0.5) / side * 2 - 1))
    seen = angles[np.abs(angles) < 65]  # nearer to the rim they are not told apart
    assert len(seen) > 30
    # Equally long on the surface: an arc of a period, as seen from the front.
    assert np.diff(seen) == pytest.approx(np.degrees(2 * period / side), abs=0.8)


def test_a_larger_map_is_unrolled_alike() -> None:
    mask = np.zeros((128, 128), bool)
    mask[20:110, 10:100] = True
    small, large = unroll(cylinder(128), mask), unroll(cylinder(256), mask.repeat(2, 0).repeat(2, 1))
    assert np.abs(small).max() > 5
    halved = large.reshape(128, 2, 128, 2, 2).mean((1, 3)) / 2
    assert halved[mask] == pytest.approx(small[mask], abs=0.25)
