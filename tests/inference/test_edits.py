import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.inference.edits import brush, carve, enforce_pins, polygon, smooth, stroke, tilt

SIDE = 128


def sphere() -> tuple[Floats, np.ndarray[tuple[int, int], np.dtype[np.bool_]]]:
    y, x = (np.mgrid[:SIDE, :SIDE] + 0.5 - SIDE / 2) / 50
    mask = x**2 + y**2 < 1
    z = np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))
    normals = np.where(mask[..., None], np.dstack([x, -y, z]), [0, 0, 1]).astype(np.float32)
    return normals, mask


def degrees(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))))


def test_the_map_at_each_pin_is_the_pins_normal_and_far_from_all_it_is_untouched() -> None:
    normals, _ = sphere()
    chance = np.random.default_rng(0)
    points = np.floor(chance.uniform(30, 98, (40, 2))).astype(np.float32) + 0.5
    points = np.unique(points, axis=0)
    wanted = chance.normal(size=(len(points), 3)).astype(np.float32)
    wanted[:, 2] = np.abs(wanted[:, 2])
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    reaches = chance.uniform(3, 12, len(points)).astype(np.float32)
    held = enforce_pins(normals, points, wanted, reaches)
    columns, rows = points.astype(int).T
    assert degrees(held[rows, columns], wanted).max() < 0.5
    np.testing.assert_allclose(np.linalg.norm(held, axis=-1), 1, atol=1e-4)
    y, x = np.mgrid[:SIDE, :SIDE] + 0.5
    away = np.hypot(x[..., None] - points[:, 0], y[..., None] - points[:, 1]).min(-1)
    assert np.array_equal(held[away > 14], normals[away > 14])


def test_pins_work_alike_wherever_they_lie_on_a_map() -> None:
    normals, _ = sphere()
    # At corners, beyond the map, in the middle; the first two reach over its edge.
    points = np.array([[0.5, 1.5], [127.5, 120.5], [-3, 70], [60.5, 64.5], [66.5, 64.5]], np.float32)
    wanted = np.array([[0.6, 0, 0.8], [0, 0.6, 0.8], [0, 0, 1], [0.8, 0, 0.6], [-0.8, 0, 0.6]], np.float32)
    reaches = np.array([9, 14.5, 6, 30, 0], np.float32)
    held = enforce_pins(normals, points, wanted, reaches)
    inside = np.clip(points, 0, SIDE - 0.5)
    room = 40
    larger = np.pad(normals, ((room, room), (room, room), (0, 0)), mode="edge")
    shifted = enforce_pins(larger, inside + room, wanted, reaches)
    np.testing.assert_allclose(held, shifted[room:-room, room:-room], atol=1e-5)
    columns, rows = inside.astype(int).T
    np.testing.assert_allclose(held[rows, columns], wanted, atol=1e-3)


@pytest.mark.parametrize("apart", [1, 4, 16])
def test_opposed_pins_hold_however_near_they_are(apart: int) -> None:
    normals, _ = sphere()
    points = np.array([[60.5, 64.5], [60.5 + apart, 64.5]], np.float32)
    wanted = np.array([[-1, 0, 0], [1, 0, 0]], np.float32)
    held = enforce_pins(normals, points, wanted, np.array([26, 26], np.float32))
    assert degrees(held[64, [60, 60 + apart]], wanted).max() < 0.5


def test_of_two_pins_in_one_pixel_the_last_counts() -> None:
    normals, _ = sphere()
    points = np.array([[60.5, 64.5], [60.5, 64.5]], np.float32)
    wanted = np.array([[-0.6, 0, 0.8], [0.6, 0, 0.8]], np.float32)
    held = enforce_pins(normals, points, wanted, np.array([9, 9], np.float32))
    np.testing.assert_allclose(held[64, 60], wanted[1], atol=1e-3)


def test_a_flat_wall_is_tilted_as_a_whole_and_stays_flat() -> None:
    flat = np.zeros((SIDE, SIDE, 3), np.float32)
    flat[..., 2] = 1
    corners = np.array([[20, 20], [100, 20], [100, 100], [20, 100]], np.float32)
    area = polygon((SIDE, SIDE), corners, 2)
    wanted = np.array([0.6, 0, 0.8], np.float32)
    tilted = tilt(flat, np.ones((SIDE, SIDE), bool), area, wanted)
    assert degrees(tilted[25:95, 25:95], wanted).max() < 0.1
    assert np.array_equal(tilted[:10], flat[:10])


def test_what_is_bent_stays_bent_when_it_is_tilted() -> None:
    normals, mask = sphere()
    area = polygon((SIDE, SIDE), np.array([[40, 40], [88, 40], [88, 88], [40, 88]], np.float32), 1)
    wanted = np.array([0.3, 0, np.sqrt(0.91)], np.float32)
    tilted = tilt(normals, mask, area, wanted)
    inside = np.s_[44:84, 44:84]
    mean = tilted[inside].mean((0, 1))
    assert degrees(mean / np.linalg.norm(mean), wanted) < 2
    before, after = (degrees(each[64, 50], each[64, 78]) for each in (normals, tilted))
    assert abs(before - after) < 1


def test_the_brush_turns_its_middle_wholly_and_nothing_beyond_it() -> None:
    normals, _ = sphere()
    wanted = np.array([0, 0.6, 0.8], np.float32)
    area = stroke((SIDE, SIDE), np.array([[40, 64], [88, 64]], np.float32), 20, 0.5)
    brushed = brush(normals, area, wanted)
    assert degrees(brushed[64, 45:85], wanted).max() < 6
    assert np.array_equal(brushed[:44], normals[:44])
    point = stroke((SIDE, SIDE), np.array([[64, 64]], np.float32), 20, 0.5)
    assert point[64, 64] == 1


@pytest.mark.parametrize("soft", [0.0, 0.5, 1.0])
def test_a_softer_brush_fades_out_within_the_same_width(soft: float) -> None:
    area = stroke((64, 64), np.array([[-20, 32], [90, 32]], np.float32), 20, soft)
    profile = area[32:, 32]
    assert profile[0] > 0.98
    assert (profile[10:] == 0).all()  # its radius
    assert profile[5] == pytest.approx({0.0: 1, 0.5: 0.97, 1.0: 0.43}[soft], abs=0.02)
    assert np.array_equal(area, area[:, ::-1])


def test_smoothing_averages_what_is_under_the_brush_and_only_the_object() -> None:
    chance = np.random.default_rng(0)
    normals, mask = sphere()
    rough = normals + chance.normal(0, 0.2, normals.shape).astype(np.float32)
    rough[..., 2] = np.abs(rough[..., 2])
    rough /= np.linalg.norm(rough, axis=-1, keepdims=True)
    rough[~mask] = [1, 0, 0]  # of no account
    area = stroke((SIDE, SIDE), np.array([[30, 64], [98, 64]], np.float32), 24, 0.3)
    smoothed = smooth(rough, mask, area, 24)
    middle = np.s_[62:66, 40:88]
    assert (
        degrees(smoothed[middle], normals[middle]).mean()
        < 0.4 * degrees(rough[middle], normals[middle]).mean()
    )
    assert np.array_equal(smoothed[area < 1e-3], rough[area < 1e-3])
    assert np.array_equal(smoothed[~mask], rough[~mask])
    half = smooth(rough, mask, area * np.float32(0.5), 24)
    assert degrees(half[middle], rough[middle]).mean() < 0.8 * degrees(smoothed[middle], rough[middle]).mean()
    assert smooth(rough, mask, np.zeros_like(area), 24) is rough


@pytest.mark.parametrize("height", [0.6, -0.6])
def test_a_carved_line_is_a_ridge_or_a_groove_as_wide_as_the_line_and_has_its_slope(height: float) -> None:
    flat = np.zeros((SIDE, SIDE, 3), np.float32)
    flat[..., 2] = 1
    mask = np.ones((SIDE, SIDE), bool)
    mask[:, 100:] = False
    line, widths = np.array([[20, 64], [110, 64]], np.float32), np.array([40, 40], np.float32)
    carved = flat.copy()
    carve(carved, mask, line, widths, height)
    away = np.arange(SIDE) + 0.5 - 64
    inside = np.abs(away) < 20
    # The derivative of 20 height (1 - (d / 20)^2)^2.
    slope = np.where(inside, -4 * height * (away / 20) * (1 - (away / 20) ** 2), 0)
    wanted = np.stack([np.zeros(SIDE), slope, np.ones(SIDE)], -1)
    wanted /= np.linalg.norm(wanted, axis=-1, keepdims=True)
    assert degrees(carved[:, 60], wanted.astype(np.float32)).max() < 2  # a difference is no derivative
    assert np.array_equal(carved[:, 101:], flat[:, 101:])
    assert np.array_equal(carved[:43], flat[:43])


def test_a_carved_line_stands_on_the_surface_and_tapers() -> None:
    normals, mask = sphere()
    line, widths = np.array([[40, 50], [90, 50]], np.float32), np.array([2, 20], np.float32)
    carved = normals.copy()
    carve(carved, mask, line, widths, 0.5)
    changed = degrees(carved, normals) > 2
    assert changed[:, 86].sum() > 2 * changed[:, 50].sum() > 0
    beside = normals.copy()
    carve(beside, mask, line + 500, widths, 0.5)
    assert np.array_equal(beside, normals)
