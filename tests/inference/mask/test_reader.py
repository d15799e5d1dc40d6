"""The reader: holes, gaps, grounds and figures on pages as people make them; on the weights that ship."""

import cv2
import numpy as np
import pytest

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.jobs.plan import OUTLINE, READER
from normalgan.inference.mask.reader import drop_ground, read, vote
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import Picture

SIDE = 256


def picture_of(grey: Floats) -> Picture:
    return Picture(np.repeat(grey[..., None], 3, axis=-1).astype(np.float32), None)


def paper() -> Floats:
    return np.ones((SIDE, SIDE), np.float32)


def iou(found: BoolMask | None, wanted: BoolMask) -> float:
    assert found is not None
    return float((found & wanted).sum() / (found | wanted).sum())


def figure(gap: int = 0) -> tuple[Floats, BoolMask]:
    """Return a snowman of two circles with eyes, its lower one open, and where it is."""
    page, solid = paper(), np.zeros((SIDE, SIDE), np.uint8)
    for centre, radius in (((128, 170), 62), ((128, 76), 40)):
        cv2.circle(page, centre, radius, 0, 3, cv2.LINE_AA)
        cv2.circle(solid, centre, radius + 1, 1, -1)
    for x in (114, 142):
        cv2.circle(page, (x, 68), 4, 0, -1, cv2.LINE_AA)
    if gap:
        page[225:, 128 - gap // 2 : 128 + gap // 2] = 1
    return page, solid > 0


def mug() -> tuple[Floats, BoolMask, BoolMask]:
    """Return a mug, where it is, and the hole of its handle."""
    page = paper()
    solid, hole = np.zeros((SIDE, SIDE), np.uint8), np.zeros((SIDE, SIDE), np.uint8)
    cv2.ellipse(page, (172, 132), (48, 48), 0, 0, 360, 0, 3, cv2.LINE_AA)
    cv2.ellipse(page, (172, 132), (32, 32), 0, 0, 360, 0, 3, cv2.LINE_AA)
    page[50:215, 55:160] = 1
    cv2.rectangle(page, (56, 60), (160, 210), 0, 3, cv2.LINE_AA)
    cv2.ellipse(page, (108, 60), (52, 14), 0, 0, 360, 0, 3, cv2.LINE_AA)
    cv2.ellipse(solid, (172, 132), (48, 48), 0, 0, 360, 1, -1)
    cv2.ellipse(hole, (172, 132), (28, 28), 0, 0, 360, 1, -1)
    hole[:, :164] = 0
    cv2.rectangle(solid, (56, 60), (160, 210), 1, -1)
    cv2.ellipse(solid, (108, 60), (52, 14), 0, 0, 360, 1, -1)
    return page, (solid > 0) & (hole == 0), hole > 0


def test_a_closed_outline_is_its_inside_as_without_the_reader() -> None:
    page, solid = figure()
    read_mask = prepare(picture_of(page), SIDE, source=READER).mask
    assert iou(read_mask, solid) > 0.95
    plain = prepare(picture_of(page), SIDE).mask
    assert plain is not None
    assert iou(read_mask, plain) > 0.99


def test_the_hole_of_a_handle_is_none_of_the_object() -> None:
    page, solid, hole = mug()
    mask = prepare(picture_of(page), SIDE, source=READER).mask
    assert mask is not None
    assert mask[hole].mean() < 0.1
    assert iou(mask, solid) > 0.9


@pytest.mark.parametrize("gap", [6, 14])
def test_an_open_outline_is_closed(gap: int) -> None:
    page, solid = figure(gap)
    assert iou(prepare(picture_of(page), SIDE, source=READER).mask, solid) > 0.93


def test_rules_of_the_paper_are_no_lines() -> None:
    page, solid = figure()
    ruled = page.copy()
    ruled[12::16] = np.minimum(ruled[12::16], 0.75)
    assert iou(prepare(picture_of(ruled), SIDE, source=READER).mask, solid) > 0.9


def test_a_sprite_on_a_flat_ground_is_cut_out() -> None:
    page = np.zeros((SIDE, SIDE, 3), np.float32)
    page[:] = 1.0, 0.0, 1.0
    solid = np.zeros((SIDE, SIDE), np.uint8)
    for centre, radius, colour in (((128, 170), 62, (0.9, 0.8, 0.6)), ((128, 76), 40, (0.9, 0.4, 0.3))):
        cv2.circle(page, centre, radius, colour, -1, cv2.LINE_AA)
        cv2.circle(page, centre, radius, (0.1, 0.1, 0.1), 3, cv2.LINE_AA)
        cv2.circle(solid, centre, radius, 1, -1)
    assert iou(prepare(Picture(page, None), SIDE, source=READER).mask, solid > 0) > 0.9


def test_separate_figures_are_not_joined_across_air() -> None:
    page = np.ones((120, 480), np.float32)
    for x in range(60, 480, 90):
        cv2.circle(page, (x, 30), 14, 0, 2, cv2.LINE_AA)
        cv2.ellipse(page, (x, 76), (20, 30), 0, 100, 440, 0, 2, cv2.LINE_AA)
    mask = prepare(picture_of(page), SIDE, source=READER).mask
    assert mask is not None
    for x in range(105, 440, 90):
        assert not mask[:, x - 10 : x + 10].any()


def test_a_given_mask_and_the_outline_are_not_voted_on() -> None:
    page, _, hole = mug()
    given = np.ones((SIDE, SIDE), bool)
    kept = prepare(picture_of(page), SIDE, given, source=READER).mask
    assert kept is not None
    assert np.array_equal(kept, given)
    by_outline = prepare(picture_of(page), SIDE, source=OUTLINE).mask
    assert by_outline is not None
    assert by_outline[hole].mean() > 0.9


def test_a_region_is_decided_as_a_whole_and_its_doubt_is_told() -> None:
    ink = np.zeros((100, 100), np.float32)
    ink[10:90, 10:90] = 1
    ink[12:50, 12:88] = ink[52:88, 12:88] = 0
    filled = np.pad(np.ones((80, 80), bool), 10)
    presence = np.zeros((100, 100), np.float32)
    presence[12:50, 12:60] = 1  # 63 % of the upper one
    found = vote(ink, filled, presence)
    assert found.mask[30, 80]
    assert not found.mask[70, 50]
    assert "a region may be object or hole, at x " in found.unsure
    presence[12:50] = 1
    presence[:, :12] = presence[:, 88:] = 0
    assert vote(ink, filled, presence).unsure == ""


def test_an_eye_is_no_hole_however_it_is_voted_on() -> None:
    ink = np.zeros((200, 200), np.float32)
    cv2.rectangle(ink, (20, 20), (180, 180), 1, 2)
    cv2.circle(ink, (100, 100), 6, 1, 2)
    cv2.circle(ink, (100, 150), 20, 1, 2)
    filled = np.pad(np.ones((160, 160), bool), 20)
    presence = filled.astype(np.float32)
    for centre, radius in (((100, 100), 6), ((100, 150), 20)):
        cv2.circle(presence, centre, radius, 0, -1)
    mask = vote(ink, filled, presence).mask
    assert mask[100, 100]
    assert not mask[150, 100]


def test_a_caption_is_left_out() -> None:
    page, _ = figure()
    page = np.vstack([page, np.ones((40, SIDE), np.float32)])
    words = np.zeros(page.shape, np.uint8)
    cv2.putText(words, "fig. 12, after Mo", (60, 276), cv2.FONT_HERSHEY_SIMPLEX, 0.45, 255, 1, cv2.LINE_AA)
    page = (page - words.astype(np.float32) / 255).astype(np.float32)
    ink = (1 - page).astype(np.float32)
    kept = drop_ground(ink, read(picture_of(page)))
    assert kept[262:].sum() < 0.3 * ink[262:].sum()
    assert np.array_equal(kept[:240], ink[:240])
