"""The reader: holes, gaps, grounds and figures on pages as people make them; on the weights that ship."""

import cv2
import numpy as np
import pytest

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.mask.mask_files import OUTLINE, MaskSource
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
    read_mask = prepare(picture_of(page), SIDE).mask
    assert iou(read_mask, solid) > 0.95
    plain = prepare(picture_of(page), SIDE, mask=OUTLINE).mask
    assert plain is not None
    assert iou(read_mask, plain) > 0.99


def test_the_hole_of_a_handle_is_none_of_the_object() -> None:
    page, solid, hole = mug()
    mask = prepare(picture_of(page), SIDE).mask
    assert mask is not None
    assert mask[hole].mean() < 0.1
    assert iou(mask, solid) > 0.9


@pytest.mark.parametrize("corners", [3, 4, 40])
@pytest.mark.parametrize("radius", [50, 80, 105])
def test_a_plain_shape_is_no_hole(corners: int, radius: int) -> None:
    page, solid = paper(), np.zeros((SIDE, SIDE), np.uint8)
    around = np.linspace(0, 2 * np.pi, corners, endpoint=False) + np.pi / 4
    points = np.rint(128 + radius * np.stack([np.cos(around), np.sin(around)], 1)).astype(np.int32)
    cv2.polylines(page, [points], True, (0,), 2, cv2.LINE_AA)
    cv2.fillPoly(solid, [points], (1,))
    cv2.polylines(solid, [points], True, (1,), 2)
    assert iou(prepare(picture_of(page), SIDE).mask, solid > 0) > 0.93


@pytest.mark.parametrize(
    "inside",
    [
        [(200, 50), (200, 350)],
        [(60, 60), (200, 210), (340, 60)],
        [(200, 140), (240, 200), (200, 260), (160, 200), (200, 140)],
    ],
    ids=["window", "envelope", "card"],
)
@pytest.mark.parametrize("margin", [44, 60])
def test_a_rectangle_about_plain_lines_is_no_frame(inside: list[tuple[int, int]], margin: int) -> None:
    page, solid = np.ones((400, 400), np.float32), np.zeros((400, 400), bool)
    cv2.rectangle(page, (margin, margin), (399 - margin, 399 - margin), 0, 3, cv2.LINE_AA)
    cv2.polylines(page, [np.clip(inside, margin, 399 - margin).astype(np.int32)], False, (0,), 3, cv2.LINE_AA)
    solid[margin : 400 - margin, margin : 400 - margin] = True
    assert iou(prepare(picture_of(page), SIDE).mask, solid) > 0.93


@pytest.mark.parametrize("radius", [4, 8, 14])
def test_eyes_are_no_holes(radius: int) -> None:
    page, _ = figure()
    for x in (100, 156):
        cv2.circle(page, (x, 84), radius, 0, 2, cv2.LINE_AA)
    mask = prepare(picture_of(page), SIDE).mask
    assert mask is not None
    assert mask[84, [100, 156]].all()


@pytest.mark.parametrize("gap", [6, 14])
def test_an_open_outline_is_closed(gap: int) -> None:
    page, solid = figure(gap)
    assert iou(prepare(picture_of(page), SIDE).mask, solid) > 0.93


@pytest.mark.parametrize("corner", [(40, 30), (700, 900)])
def test_a_small_drawing_on_a_large_page_is_read_as_by_itself(corner: tuple[int, int]) -> None:
    page, _, _ = mug()
    alone = prepare(picture_of(page), SIDE).mask
    sheet, where = np.ones((1200, 1000), np.float32), np.zeros((1200, 1000), bool)
    x, y = corner
    inside = slice(y, y + SIDE), slice(x, x + SIDE)
    sheet[inside], where[inside] = page, alone
    assert iou(prepare(picture_of(sheet), 1200).mask, where) > 0.98


@pytest.mark.parametrize("source", [None, OUTLINE])
@pytest.mark.parametrize("shape", [(200, 1600), (100, 1200), (1600, 200)])
def test_a_long_closed_outline_is_its_inside(shape: tuple[int, int], source: MaskSource | None) -> None:
    page, solid = np.ones(shape, np.float32), np.zeros(shape, np.uint8)
    box = (10, 10), (shape[1] - 11, shape[0] - 11)
    cv2.rectangle(page, *box, 0, 4)
    cv2.rectangle(solid, *box, 1, 4)
    cv2.rectangle(solid, *box, 1, -1)
    assert iou(prepare(picture_of(page), SIDE, mask=source).mask, solid > 0) > 0.95


def test_rules_of_the_paper_are_no_lines() -> None:
    page, solid = figure()
    ruled = page.copy()
    ruled[12::16] = np.minimum(ruled[12::16], 0.75)
    assert iou(prepare(picture_of(ruled), SIDE).mask, solid) > 0.9


def test_a_sprite_on_a_flat_ground_is_cut_out() -> None:
    page = np.zeros((SIDE, SIDE, 3), np.float32)
    page[:] = 1.0, 0.0, 1.0
    solid = np.zeros((SIDE, SIDE), np.uint8)
    for centre, radius, colour in (((128, 170), 62, (0.9, 0.8, 0.6)), ((128, 76), 40, (0.9, 0.4, 0.3))):
        cv2.circle(page, centre, radius, colour, -1, cv2.LINE_AA)
        cv2.circle(page, centre, radius, (0.1, 0.1, 0.1), 3, cv2.LINE_AA)
        cv2.circle(solid, centre, radius, 1, -1)
    assert iou(prepare(Picture(page, None), SIDE).mask, solid > 0) > 0.9


def test_separate_figures_are_not_joined_across_air() -> None:
    page = np.ones((120, 480), np.float32)
    for x in range(60, 480, 90):
        cv2.circle(page, (x, 30), 14, 0, 2, cv2.LINE_AA)
        cv2.ellipse(page, (x, 76), (20, 30), 0, 100, 440, 0, 2, cv2.LINE_AA)
    mask = prepare(picture_of(page), SIDE).mask
    assert mask is not None
    for x in range(105, 440, 90):
        assert not mask[:, x - 10 : x + 10].any()


def test_a_given_mask_and_the_outline_are_not_voted_on() -> None:
    page, _, hole = mug()
    given = np.ones((SIDE, SIDE), bool)
    kept = prepare(picture_of(page), SIDE, given).mask
    assert kept is not None
    assert np.array_equal(kept, given)
    by_outline = prepare(picture_of(page), SIDE, mask=OUTLINE).mask
    assert by_outline is not None
    assert by_outline[hole].mean() > 0.9


def test_a_caption_is_left_out() -> None:
    page, _ = figure()
    page = np.vstack([page, np.ones((40, SIDE), np.float32)])
    words = np.zeros(page.shape, np.uint8)
    cv2.putText(words, "fig. 12, after Mo", (60, 276), cv2.FONT_HERSHEY_SIMPLEX, 0.45, 255, 1, cv2.LINE_AA)
    page = (page - words.astype(np.float32) / 255).astype(np.float32)
    ink = (1 - page).astype(np.float32)
    kept = prepare(picture_of(page), SIDE).ink
    assert kept[262:].sum() < 0.3 * ink[262:].sum()
    assert np.abs(kept[:240] - ink[:240]).mean() < 0.01


def photographed(
    shadow: float, edge: float, desk: tuple[float, float, float] | None
) -> tuple[Floats, BoolMask]:
    """Return a photo of a drawing (H, W, 3), its left in the light, its right in a shadow; and where that is.

    Args:
        shadow: the light that is left in it.
        edge: width of its edge, as a share of the picture.
        desk: its colour; None if the sheet fills the picture.
    """
    page, solid = figure()
    photo = np.array([0.93, 0.91, 0.86]) - np.multiply.outer(1 - page, [0.8, 0.78, 0.66])
    if desk is not None:
        room = ((44, 44), (44, 44))
        photo = np.stack([np.pad(photo[..., k], room, constant_values=desk[k]) for k in range(3)], axis=-1)
        solid = np.pad(solid, room)
    y, x = np.mgrid[: photo.shape[0], : photo.shape[1]] / max(photo.shape)
    light = 1 - (1 - shadow) * np.clip((0.9 * x + 0.3 * y - 0.6) / edge + 0.5, 0, 1)
    noise = np.random.default_rng(1).normal(0, 0.01, photo.shape)
    return np.clip(photo * light[..., None] + noise, 0, 1).astype(np.float32), solid


@pytest.mark.parametrize("desk", [None, (0.42, 0.28, 0.18), (0.4, 0.4, 0.4)], ids=["sheet", "wood", "grey"])
@pytest.mark.parametrize(("shadow", "edge"), [(1.0, 0.4), (0.5, 0.4), (0.5, 0.03)])
def test_a_drawing_is_found_on_a_desk_and_in_a_shadow(
    shadow: float, edge: float, desk: tuple[float, float, float] | None
) -> None:
    photo, solid = photographed(shadow, edge, desk)
    prepared = prepare(Picture(photo, None), SIDE)
    assert iou(prepared.mask, solid) > 0.93
    beyond = cv2.dilate(solid.astype(np.uint8), np.ones((15, 15), np.uint8)) == 0
    assert prepared.ink[beyond].mean() < 0.01


def test_an_object_before_scenery_is_found() -> None:
    page, solid = figure()
    ground = np.where(np.arange(SIDE)[:, None, None] < 150, (0.55, 0.75, 0.95), (0.35, 0.6, 0.25))
    colour = np.where(solid[..., None], (0.85, 0.5, 0.25), np.broadcast_to(ground, (SIDE, SIDE, 3)))
    colour = (colour * page[..., None]).astype(np.float32)
    assert iou(prepare(Picture(colour, None), SIDE).mask, solid) > 0.85
