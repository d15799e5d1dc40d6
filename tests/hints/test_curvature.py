from typing import Any

import numpy as np
import pytest
import torch
from hint_scenes import beast, seeded, sphere
from scipy import ndimage
from torch import Tensor

from normalgan.errors import InputError
from normalgan.hints import CurvatureHints

Scene = tuple[Tensor, Tensor]


@pytest.fixture(scope="module", name="quadruped")
def _quadruped() -> Scene:
    return beast(256)


def level_map(normal: Tensor, gain: float) -> np.ndarray[Any, Any]:
    """The 8-bit curvature map written the slow way, pixel by pixel, from the two neighbours each way."""
    nx, ny = (np.pad(normal[0, c].double().numpy(), 1, mode="edge") for c in (0, 1))
    levels = np.zeros(normal.shape[2:], dtype=int)
    for row, column in np.ndindex(*levels.shape):
        r, c = row + 1, column + 1
        red = (nx[r, c + 1] - nx[r, c - 1]) / 2
        green = (ny[r - 1, c] - ny[r + 1, c]) / 2
        levels[row, column] = int(np.clip(np.floor(255 * (0.5 + gain * (red + green)) + 0.5), 0, 255))
    return levels


@pytest.mark.parametrize("gain", [0.05, 1.0])
def test_selection_is_the_exclusive_or_of_two_thresholds(gain: float) -> None:
    normal, mask = beast(128)
    levels = level_map(normal, gain)
    expected = np.logical_xor(levels > 127, levels > 126) & (mask[0, 0].numpy() > 0)
    selected = CurvatureHints(gain=gain).select(normal, mask)[0, 0].numpy()
    assert expected.any()
    assert (selected != expected).sum() <= 1  # float32 may fall on the other side of a level's edge


def test_defaults_select_mild_concavities_inside_the_object(quadruped: Scene) -> None:
    normal, mask = quadruped
    sampler = CurvatureHints()
    selected = sampler.select(normal, mask)[0, 0].numpy()
    depth = ndimage.distance_transform_edt(mask[0, 0].numpy())
    assert 200 <= selected.sum() <= 800
    assert (mask[0, 0].numpy()[selected] == 1).all()
    assert (depth[selected] <= 2).mean() < 0.3
    # One threshold alone is mostly the outline, the complaint of the paper.
    dark = (sampler.levels(normal)[0, 0].numpy() <= 126) & (mask[0, 0].numpy() > 0)
    assert (depth[dark] <= 2).mean() > 0.6


def test_flat_is_128_rounded_and_127_floored() -> None:
    plane = torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1).expand(1, 3, 8, 8)
    assert CurvatureHints().levels(plane).eq(128).all()
    assert CurvatureHints(rounding="floor").levels(plane).eq(127).all()


def test_noise_of_interpolated_normals_stays_flat() -> None:
    plane = torch.tensor([0.3, 0.2, 0.93]).view(1, 3, 1, 1) + 3e-7 * torch.randn(
        1, 3, 64, 64, generator=seeded()
    )
    assert CurvatureHints(gain=1.0).levels(plane.double()).eq(128).all()


def test_floored_flat_selects_the_background(quadruped: Scene) -> None:
    normal, mask = quadruped
    selected = CurvatureHints(gain=1.0, rounding="floor", object_only=False).select(normal, mask)
    assert selected.float().mean() > 0.6
    assert (selected & (mask > 0)).sum() < 0.01 * selected.sum()


def test_object_only_removes_what_is_off_the_object(quadruped: Scene) -> None:
    normal, mask = quadruped
    everywhere = CurvatureHints(blur=1.5, gain=1.0, object_only=False).select(normal, mask)
    on_object = CurvatureHints(blur=1.5, gain=1.0).select(normal, mask)
    assert (everywhere & (mask == 0)).sum() > 500  # the halo of a blurred outline
    assert torch.equal(on_object, everywhere & (mask > 0))


def test_sphere_gets_no_hints() -> None:
    normal, mask = sphere(256, radius=90)
    assert CurvatureHints(dropout=0.0).sample(normal, mask, seeded()).sum() == 0


def test_greater_equal_selects_the_next_level(quadruped: Scene) -> None:
    normal, mask = quadruped
    sampler = CurvatureHints(comparison="greater_equal")
    assert torch.equal(sampler.select(normal, mask), (sampler.levels(normal) == 126) & (mask > 0))


def test_order_of_thresholds_does_not_matter(quadruped: Scene) -> None:
    swapped = CurvatureHints(thresholds=(126, 127)).select(*quadruped)
    assert torch.equal(swapped, CurvatureHints().select(*quadruped))


def test_minmax_spans_all_levels_a_picture_and_survives_a_plane(quadruped: Scene) -> None:
    normal, _ = quadruped
    levels = CurvatureHints(normalisation="minmax").levels(torch.cat([normal, torch.zeros_like(normal)]))
    assert [levels[0].min().item(), levels[0].max().item()] == [0, 255]
    assert levels[1].eq(128).all()


def test_unsigned_sees_convex_shapes() -> None:
    normal, mask = sphere(64, radius=25)
    levels = CurvatureHints(signed=False, offset=0.0, gain=1.0).levels(normal)
    assert levels[0, 0, 32, 32] == round(255 * 2**0.5 / 25)
    assert levels[mask == 0].median() == 0


def test_dropout_keeps_a_twentieth() -> None:
    # A bowl lined with level 127 everywhere: the divergence is -2 / 40, 255 · 0.05 · 0.05 = 0.64 levels.
    x = torch.linspace(-0.8, 0.8, 65)[None].expand(65, 65) / 1.25 / 0.05 / 25.6
    normal = torch.stack([-x, x.T, (1 - x**2 - x.T**2).sqrt()])[None]
    mask = torch.ones(1, 1, 65, 65)
    sampler = CurvatureHints()
    total = int(sampler.select(normal, mask)[..., 1:-1, 1:-1].sum())
    assert total == 63 * 63
    kept = sum(int(sampler.sample(normal, mask, seeded(i))[..., 1:-1, 1:-1].sum()) for i in range(20))
    expected, deviation = 0.05 * 20 * total, (0.05 * 0.95 * 20 * total) ** 0.5
    assert abs(kept - expected) < 4 * deviation


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"thresholds": (127, 127)}, r"is \(127, 127\); it must be two different levels"),
        ({"thresholds": (127, 256)}, r"it must be two different levels from 0 to 255"),
        ({"thresholds": (127,)}, r"it must be two different levels from 0 to 255"),
    ],
)
def test_bad_setting_says_what_would_be_right(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        CurvatureHints(**settings)
