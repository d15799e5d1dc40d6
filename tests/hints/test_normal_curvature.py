import math

import pytest
import torch
from hint_scenes import sphere
from scipy import ndimage
from torch import Tensor

from normalgan.hints import curvature_map
from normalgan.hints.normal_curvature import Estimator


def slope(nx: float = 0.0, ny: float = 0.0) -> list[float]:
    return [nx, ny, math.sqrt(1 - nx * nx - ny * ny)]


def picture(rows: list[list[list[float]]]) -> Tensor:
    return torch.tensor(rows).permute(2, 0, 1)[None]


def test_roof_with_a_horizontal_ridge_is_convex_with_y_up() -> None:
    # The upper slope of a roof faces up (ny > 0) and is in row 0: rows grow downward, y upward.
    roof = picture([[slope(ny=0.6)] * 3, [slope()] * 3, [slope(ny=-0.6)] * 3])
    assert curvature_map(roof)[0, 0, 1, 1].item() == pytest.approx(+0.6)
    assert curvature_map(roof.flip(2))[0, 0, 1, 1].item() == pytest.approx(-0.6)


def test_ridge_facing_left_then_right_is_convex() -> None:
    ridge = picture([[slope(nx=-0.8), slope(), slope(nx=0.8)]] * 3)
    assert curvature_map(ridge)[0, 0, 1, 1].item() == pytest.approx(+0.8)


@pytest.mark.parametrize("estimator", ["central", "sobel"])
def test_sphere_has_two_over_radius(estimator: Estimator) -> None:
    normal, mask = sphere(64, radius=25)
    curvature = curvature_map(normal, estimator)
    inner = -torch.nn.functional.max_pool2d(-mask, 5, 1, 2) > 0  # the outline is a jump to the zero normal
    assert torch.allclose(curvature[inner], torch.tensor(2 / 25), atol=1e-6)
    assert inner.sum() > 1500


def test_sobel_is_scipys() -> None:
    normal = torch.rand(1, 3, 9, 11, generator=torch.Generator().manual_seed(0)) * 2 - 1
    nx, ny = normal[0, 0].numpy(), normal[0, 1].numpy()
    expected = (ndimage.sobel(nx, 1, mode="nearest") - ndimage.sobel(ny, 0, mode="nearest")) / 8
    assert torch.allclose(curvature_map(normal, "sobel")[0, 0], torch.tensor(expected), atol=1e-6)


def test_blur_is_scipys_gaussian() -> None:
    normal = torch.rand(1, 3, 20, 24, generator=torch.Generator().manual_seed(0)) * 2 - 1
    sharp = curvature_map(normal)[0, 0].numpy()
    expected = ndimage.gaussian_filter(sharp, 1.5, mode="nearest", radius=4)
    assert torch.allclose(curvature_map(normal, blur=1.5)[0, 0], torch.tensor(expected), atol=1e-6)


def test_unsigned_is_the_norm_of_the_gradient_and_blind_to_the_sign() -> None:
    roof = picture([[slope(ny=0.6)] * 3, [slope()] * 3, [slope(ny=-0.6)] * 3])
    valley = roof.flip(2)
    assert curvature_map(roof, signed=False)[0, 0, 1, 1].item() == pytest.approx(0.6)
    assert torch.equal(curvature_map(roof, signed=False), curvature_map(valley, signed=False).flip(2))


@pytest.mark.parametrize("estimator", ["central", "sobel"])
def test_turning_the_picture_by_a_quarter_turns_the_curvature(estimator: Estimator) -> None:
    normal = torch.rand(1, 3, 12, 12, generator=torch.Generator().manual_seed(1)) * 2 - 1
    turned = torch.rot90(normal, 1, (2, 3))  # counter-clockwise: (nx, ny) becomes (-ny, nx)
    turned = torch.stack([-turned[:, 1], turned[:, 0], turned[:, 2]], dim=1)
    expected = torch.rot90(curvature_map(normal, estimator), 1, (2, 3))
    assert torch.allclose(curvature_map(turned, estimator), expected, atol=1e-6)


def test_half_precision_is_computed_in_single() -> None:
    normal, _ = sphere(16, radius=6)
    assert curvature_map(normal.bfloat16()).dtype == torch.float32
    assert curvature_map(normal.double()).dtype == torch.float64
