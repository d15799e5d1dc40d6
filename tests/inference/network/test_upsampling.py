import cv2
import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.inference.network.framing import Frame
from normalgan.inference.network.upsampling import CELL, Coarse, Refiner, enlarge, planes, upsampler
from normalgan.inference.preparation import Prepared
from normalgan.normals import normalize

SIZE = 64
refine = upsampler(refined=True)


def sphere(side: int) -> tuple[Floats, Floats]:
    """Return the normals (side, side, 3) of a ball in a picture of so many pixels, and its mask."""
    along = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(along / 0.8, -along / 0.8)
    inside = (np.hypot(x, y) < 1).astype(np.float32)
    z = np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))
    return (np.stack([x, y, z], -1) * inside[..., None]).astype(np.float32), inside


def roof(side: int) -> tuple[Floats, Floats]:
    """Return the normals of a ridge that runs down the picture, and the mask of the roof."""
    normals = np.zeros((side, side, 3), np.float32)
    normals[:, : side // 2], normals[:, side // 2 :] = (-0.7, 0, 0.714), (0.7, 0, 0.714)
    mask = np.zeros((side, side), np.float32)
    mask[side // 8 : -side // 8, side // 8 : -side // 8] = 1
    return normalize(normals), mask


def given(truth: Floats, mask: Floats, ink: Floats, size: int = SIZE) -> tuple[Coarse, Prepared]:
    """Return a map of a network's size, as blurred as a network's own, and the drawing it is of."""
    side = mask.shape[0]
    frame = Frame(mask.shape, 0, 0, side, size)
    small = cv2.resize(
        cv2.GaussianBlur(truth, (0, 0), 1.2 * side / size), (size, size), interpolation=cv2.INTER_AREA
    )
    there = frame.shrink(mask) > 0.5
    coarse = Coarse(normalize(np.asarray(small, np.float32)), there, frame.shrink(mask) > 0)
    return coarse, Prepared(mask.shape, ink, mask > 0.5, None, frame, frame.cut(ink), None)


def rim_of(mask: Floats, width: int = 3) -> Floats:
    contour = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    return np.asarray(cv2.dilate(contour, np.ones((width, width), np.uint8)), np.float32)


def error(normals: Floats, truth: Floats, where: Floats) -> float:
    cosine = (normalize(normals) * truth).sum(-1)
    return float(np.rad2deg(np.arccos(np.clip(cosine, -1, 1)))[where > 0].mean())


@pytest.mark.parametrize("side", [SIZE * 2, SIZE * 4, SIZE * 6])
def test_a_ball_turns_away_at_its_rim(side: int) -> None:
    truth, mask = sphere(side)
    contour = rim_of(mask)
    coarse, prepared = given(truth, mask, contour)
    rim = (mask > 0) & (cv2.erode(mask, np.ones((2 * side // 40 + 1,) * 2)) == 0)
    before, after = (step(coarse, prepared, mask > 0) for step in (enlarge, refine))
    assert error(after, truth, rim) < 0.8 * error(before, truth, rim)


def test_a_ridge_keeps_its_edge_on_its_line() -> None:
    side = SIZE * 4
    truth, mask = roof(side)
    ink = rim_of(mask)
    ink[side // 8 : -side // 8, side // 2 - 1 : side // 2 + 2] = 1
    coarse, prepared = given(truth, mask, ink)
    beside = np.zeros_like(mask)
    beside[side // 4 : -side // 4, side // 2 - 8 : side // 2 + 8] = 1
    before, after = (step(coarse, prepared, mask > 0) for step in (enlarge, refine))
    assert error(after, truth, beside) < error(before, truth, beside)


def test_a_map_of_the_networks_size_stays_as_it_was_painted() -> None:
    truth, mask = sphere(SIZE)
    coarse, prepared = given(truth, mask, rim_of(mask))
    assert (refine(coarse, prepared, mask > 0) == enlarge(coarse, prepared, mask > 0)).all()


def test_any_shape_is_mended_and_only_about_the_object() -> None:
    truth, mask = sphere(SIZE * 3)
    mask, truth = np.roll(mask, 5, 1)[:-3, :-2], np.roll(truth, 5, 1)[:-3, :-2]
    truth, mask = np.ascontiguousarray(truth), np.ascontiguousarray(mask)
    coarse, prepared = given(truth, mask, rim_of(mask))
    before, after = (step(coarse, prepared, mask > 0) for step in (enlarge, refine))
    assert after.shape == truth.shape
    assert np.isfinite(after).all()
    assert (after != before).any(-1)[mask > 0].mean() > 0.9
    assert (after[:8] == before[:8]).all()


def test_what_it_is_shown_ends_at_the_pictures_edge() -> None:
    shown = planes(
        np.zeros((CELL, 12, 3), np.float32), np.zeros((CELL, 12), np.float32), np.ones((CELL, 12), bool)
    )
    assert shown.shape == (6, CELL, 12)
    assert shown[5, 0, 6] == pytest.approx(1 / 16, abs=0.01)
    assert shown[5, 2, 6] > shown[5, 0, 6]


def test_threads_change_nothing() -> None:
    truth, mask = sphere(SIZE * 4)
    coarse, prepared = given(truth, mask, rim_of(mask))
    one, two = (Refiner(threads=threads)(coarse, prepared, mask > 0) for threads in (1, 2))
    assert (one == two).all()
