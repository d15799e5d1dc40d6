"""The decision: regions by their votes, flips, warnings; on readings made by hand."""

import cv2
import numpy as np
import pytest

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.reader import Reading
from normalgan.inference.mask.decision import decide

SIDE = 256


def ring() -> tuple[Floats, BoolMask, BoolMask]:
    """Return the lines of a disc with a round hole and an eye, the disc, and the hole."""
    ink, disc, hole = (np.zeros((SIDE, SIDE), np.float32) for _ in range(3))
    for centre, radius in (((128, 128), 100), ((128, 100), 40), ((128, 190), 5)):
        cv2.circle(ink, centre, radius, 1, 2)
    cv2.circle(disc, (128, 128), 100, 1, -1)
    cv2.circle(hole, (128, 100), 36, 1, -1)
    return ink, disc > 0, hole > 0


def reading(presence: Floats) -> Reading:
    return Reading(np.ones_like(presence), presence, np.zeros((2, *presence.shape), np.float32))


@pytest.mark.parametrize(("vote", "share"), [(0.1, 0.0), (0.55, 1.0), (0.9, 1.0)])
def test_a_region_is_object_or_hole_as_a_whole(vote: float, share: float) -> None:
    ink, disc, hole = ring()
    # Half of the hole is seen as object, more or less.
    presence = np.where(disc, 0.95, 0.02).astype(np.float32)
    presence[hole] = np.where(np.arange(SIDE) < 128, vote + 0.05, vote - 0.05)[None].repeat(SIDE, 0)[hole]
    found = decide(ink, reading(presence))
    assert found.mask[hole].mean() == share
    assert found.mask[disc & ~hole].mean() > 0.95
    assert not found.mask[~cv2.dilate(disc.astype(np.uint8), np.ones((5, 5))).astype(bool)].any()


def test_a_point_flips_the_region_around_it_both_ways() -> None:
    ink, disc, hole = ring()
    presence = np.where(disc & ~hole, 0.95, 0.02).astype(np.float32)
    assert not decide(ink, reading(presence)).mask[hole].any()
    assert decide(ink, reading(presence), [(128, 100)]).mask[hole].all()
    solid = decide(ink, None)
    assert solid.mask[hole].all()
    flipped = decide(ink, None, [(128, 100)])
    assert not flipped.mask[hole].any()
    # On the line about the hole it is still the hole, the nearest enclosed region, or the body.
    assert decide(ink, None, [(128, 100), (128, 190)]).mask[190, 128] == 0


def test_a_point_is_in_pixels_of_a_large_drawing() -> None:
    ink, _, _ = ring()
    large = np.asarray(cv2.resize(ink, (1024, 1024), interpolation=cv2.INTER_LINEAR), np.float32)
    assert not decide(large, None, [(512, 400)]).mask[400, 512]


@pytest.mark.parametrize("point", [(5.0, 5.0), (-3.0, 40.0), (128.0, 900.0)])
def test_a_point_off_all_enclosed_regions_is_refused(point: tuple[float, float]) -> None:
    with pytest.raises(InputError, match=r"no enclosed region lies at x .*, y .*; give a point inside"):
        decide(ring()[0], None, [point])


def test_a_large_region_of_which_the_reader_is_unsure_is_told_until_it_is_flipped() -> None:
    ink, disc, hole = ring()
    presence = np.where(disc, 0.95, 0.02).astype(np.float32)
    presence[hole] = 0.5
    found = decide(ink, reading(presence))
    (said,) = found.unsure
    assert (said.code, said.count) == ("regions", 1)
    ((x, y),) = said.places
    assert hole[round(y), round(x)]
    assert not decide(ink, reading(presence), [(128, 100)]).unsure
    presence[hole] = 0.9
    assert not decide(ink, reading(presence)).unsure


@pytest.mark.parametrize(("vote", "elsewhere", "solid"), [(0.4, False, 1), (0.1, False, 0), (0.4, True, 0)])
def test_a_lone_circle_of_which_the_reader_is_unsure_is_the_object(
    vote: float, elsewhere: bool, solid: int
) -> None:
    ink, inside = np.zeros((2, SIDE, SIDE), np.float32)
    cv2.circle(ink, (170, 160), 30, 1, 3)
    cv2.circle(inside, (170, 160), 32, 1, -1)
    presence = np.where(inside > 0, vote, 0.02).astype(np.float32)
    if elsewhere:  # a body with an open outline, of which this may be the handle
        presence[60:200, 20:120] = 0.9
    found = decide(ink, reading(presence))
    assert found.mask[160, 170] == solid
    assert any(each.code == "regions" for each in found.unsure) == elsewhere
    assert decide(ink, reading(presence), [(170, 160)]).mask[160, 170] != solid


@pytest.mark.parametrize(("gap", "told"), [(60, True), (20, False)])
def test_an_edge_without_a_line_is_told_with_its_place(gap: int, told: bool) -> None:
    ink, disc, _ = ring()
    large = np.asarray(cv2.resize(ink, (1024, 1024), interpolation=cv2.INTER_LINEAR), np.float32)
    large[800:, 512 - 4 * gap : 512 + 4 * gap] = 0
    found = decide(large, reading(np.where(disc, 0.95, 0.02).astype(np.float32))).unsure
    assert [each.code for each in found] == ["edge"] * told
    for ((x, y),) in (each.places for each in found):
        assert 500 <= x < 600
        assert 900 <= y < 1000


def test_what_the_pictures_border_cuts_off_needs_no_line_there() -> None:
    ink, disc, _ = ring()
    below = np.where(disc, 0.95, 0.02).astype(np.float32)[:160]
    assert not decide(ink[:160], reading(below)).unsure


def test_presence_closes_an_open_outline_and_nothing_else() -> None:
    ink, disc, _ = ring()
    ink[200:, 108:148] = 0  # far too wide for a gap
    assert decide(ink, None).mask[disc].mean() < 0.6
    found = decide(ink, reading(np.where(disc, 0.95, 0.02).astype(np.float32)))
    assert found.mask[disc].mean() > 0.97


def test_stages_explain_the_mask() -> None:
    ink, disc, hole = ring()
    presence = np.where(disc & ~hole, 0.95, 0.02).astype(np.float32)
    stages = decide(ink, reading(presence)).explain()
    assert list(stages) == ["regions", "presence"]
    red, green, _ = stages["regions"][110, 110].astype(int)
    assert red > green + 100  # a hole
    red, green, _ = stages["regions"][128, 190].astype(int)
    assert green > red + 50
    assert list(decide(ink, None).explain()) == ["regions"]
