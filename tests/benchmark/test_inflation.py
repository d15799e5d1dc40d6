from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from normalgan.benchmark.inflation import inflate, inflated_normals

Array = NDArray[Any]


def ellipse(size: int, a: float, b: float) -> tuple[Array, Array, Array]:
    """Return a filled ellipse's mask, and x to the right and y upwards from its centre."""
    centres = np.arange(size) + 0.5 - size / 2
    x, y = np.meshgrid(centres, -centres)
    return (x / a) ** 2 + (y / b) ** 2 < 1, x, y


def angles(normals: Array, truth: Array) -> Array:
    truth = truth / np.linalg.norm(truth, axis=-1, keepdims=True)
    angle: Array = np.rad2deg(np.arccos(np.clip((normals * truth).sum(-1), -1, 1)))
    return angle


@pytest.mark.parametrize(("a", "b"), [(50, 50), (55, 25), (20, 50)])
def test_an_ellipse_becomes_an_ellipsoid(a: float, b: float) -> None:
    mask, x, y = ellipse(128, a, b)
    # Δ(k (1 - x²/a² - y²/b²)) = -4 for k = 2 a² b² / (a² + b²); the root of it is an ellipsoid.
    k = 2 * a**2 * b**2 / (a**2 + b**2)
    h = np.clip(k * (1 - (x / a) ** 2 - (y / b) ** 2), 0, None)
    normals = inflated_normals(mask)
    error = angles(normals, np.stack([k * x / a**2, k * y / b**2, np.sqrt(h)], axis=-1))
    assert error[mask].mean() < 1.5
    assert error[mask & (h > 0.3 * k)].max() < 2  # away from the outline, whose pixels are stairs
    assert np.abs(inflate(mask) - h)[mask].max() < 0.05 * k


def test_a_disc_becomes_a_hemisphere_at_256_pixels_too() -> None:
    mask, _, _ = ellipse(256, 110, 110)
    height = np.sqrt(inflate(mask))
    assert height.max() == pytest.approx(110, rel=0.01)
    assert (inflated_normals(mask)[mask][:, 2] > 0).all()


def test_y_is_up_and_x_to_the_right() -> None:
    mask, x, y = ellipse(32, 12, 12)
    normals = inflated_normals(mask)
    assert (normals[..., 0][mask] * x[mask] >= 0).all()
    assert (normals[..., 1][mask] * y[mask] >= 0).all()
    assert np.linalg.norm(normals[mask], axis=-1) == pytest.approx(1, abs=1e-5)
    assert not normals[~mask].any()


def test_parts_do_not_know_one_another_and_the_border_is_an_outline() -> None:
    left, right = np.zeros((20, 40), bool), np.zeros((20, 40), bool)
    left[:, :18], right[3:9, 22:40] = True, True
    both = inflate(left | right)
    assert np.allclose(both, inflate(left) + inflate(right))
    assert np.allclose(inflate(left)[:, :18], inflate(left[:, :18]))


def test_an_empty_mask_has_no_height() -> None:
    assert not inflate(np.zeros((8, 8), bool)).any()
