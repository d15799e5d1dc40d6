from collections.abc import Callable
from typing import Any

import pytest
import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.data.augmentation import (
    Augmentation,
    BatchAugmentation,
    augmented,
    change_width,
    drop_lines,
    sample_at,
    sampling_grid,
    turn_normals,
    wobble,
)
from normalgan.errors import InputError

SIZE = 128
STILL = {"flip": 0.0, "rotation": 0.0, "scale": (1.0, 1.0), "translation": 0.0}
CLEAN = {"jitter": 0.0, "dropout": 0.0, "width": 0.0}


def sphere(samples: int = 4) -> Batch:
    """A sphere in the middle: any turn or mirroring leaves its normal map as it is."""
    along = (torch.arange(SIZE) - (SIZE - 1) / 2) / 44
    x, y = along[None, :].expand(SIZE, SIZE), -along[:, None].expand(SIZE, SIZE)
    mask = (x**2 + y**2 < 1).float()
    normal = torch.stack([x, y, (1 - x**2 - y**2).clamp(min=0).sqrt()]) * mask
    sketch = ((x**2 + y**2).sqrt() - 1).abs().lt(0.03).float()
    return {
        "sketch": sketch.expand(samples, 1, SIZE, SIZE),
        "normal": normal.expand(samples, 3, SIZE, SIZE),
        "mask": mask.expand(samples, 1, SIZE, SIZE),
    }


def mean_error(preds: Tensor, target: Tensor, mask: Tensor) -> float:
    error = torch.rad2deg(
        torch.atan2(torch.linalg.cross(preds, target, dim=1).norm(dim=1), (preds * target).sum(1))
    )
    return float(error[mask[:, 0] > 0].mean())


@pytest.mark.parametrize(
    "motion",
    [{"flip": 1.0}, {"rotation": 60.0}, {"flip": 0.5, "rotation": 180.0}],
    ids=["flip", "turn", "both"],
)
def test_a_sphere_stays_a_sphere(motion: dict[str, float]) -> None:
    batch = sphere(8)
    moved = Augmentation(**{**STILL, **CLEAN, **motion})(batch, seed=1)  # type: ignore[arg-type]
    both = moved["mask"] * batch["mask"]
    assert both.sum() / batch["mask"].sum() > 0.98
    assert mean_error(moved["normal"], batch["normal"], both) < 0.2


@pytest.mark.parametrize("motion", [{"flip": 1.0}, {"rotation": 170.0}], ids=["flip", "turn"])
def test_the_sphere_test_can_fail(motion: dict[str, float], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("normalgan.data.augmentation.turn_normals", lambda normal, transform: normal)
    batch = sphere(8)
    moved = Augmentation(**{**STILL, **CLEAN, **motion})(batch, seed=1)  # type: ignore[arg-type]
    assert mean_error(moved["normal"], batch["normal"], moved["mask"] * batch["mask"]) > 10


def test_a_mirrored_slope_leans_the_other_way() -> None:
    batch = sphere(1)
    batch["normal"] = torch.tensor([0.6, 0.48, 0.64]).view(1, 3, 1, 1) * batch["mask"]
    moved = Augmentation(**{**STILL, **CLEAN, "flip": 1.0})(batch, seed=0)  # type: ignore[arg-type]
    middle = moved["normal"][0, :, SIZE // 2, SIZE // 2]
    torch.testing.assert_close(middle, torch.tensor([-0.6, 0.48, 0.64]), atol=1e-4, rtol=0)


def test_a_turned_slope_turns_with_its_place() -> None:
    # The direction in the picture from the centre to a dot, and the slope painted on it, must stay one.
    batch = sphere(6)
    outward = batch["normal"].clone()
    outward[:, 2] = 0
    batch["normal"] = torch.nn.functional.normalize(outward, dim=1) * batch["mask"]
    dot = torch.zeros(6, 1, SIZE, SIZE)
    dot[:, :, 40:44, 90:94] = 1
    batch["sketch"] = dot
    moved = Augmentation(**{**STILL, **CLEAN, "rotation": 170.0})(batch, seed=3)  # type: ignore[arg-type]
    for sketch, normal in zip(moved["sketch"], moved["normal"], strict=True):
        row, column = (int(v) for v in (sketch[0] == sketch.max()).nonzero()[0])
        place = torch.tensor([column - (SIZE - 1) / 2, (SIZE - 1) / 2 - row])
        assert torch.dot(place / place.norm(), normal[:2, row, column]) > 0.99


def test_a_stretched_sphere_is_an_ellipsoid() -> None:
    settings = {**STILL, **CLEAN, "scale": (0.7, 1.3), "stretch": True}
    moved = Augmentation(**settings)(sphere(8), seed=2)  # type: ignore[arg-type]
    for normal, mask in zip(moved["normal"], moved["mask"][:, 0], strict=True):
        rows, columns = mask.nonzero().T
        a, b = (float(along.max() - along.min() + 1) / 2 for along in (columns, rows))
        assert abs(a - b) > 1
        c = (a * b) ** 0.5
        x, y = columns - (SIZE - 1) / 2, (SIZE - 1) / 2 - rows
        z = c * (1 - (x / a) ** 2 - (y / b) ** 2).clamp(min=0).sqrt()
        ellipsoid = torch.nn.functional.normalize(torch.stack([x / a**2, y / b**2, z / c**2]), dim=0)
        inner = z > 0.3 * c  # at the rim half a pixel is many degrees
        found = normal[:, rows, columns][:, inner]
        error = torch.rad2deg(torch.acos((found * ellipsoid[:, inner]).sum(0).clamp(-1, 1)))
        assert error.mean() < 1


def test_normals_stay_at_right_angles_to_the_surface_whatever_moved_it() -> None:
    random = torch.Generator().manual_seed(0)
    transform = torch.eye(3).repeat(16, 1, 1)
    transform[:, :2, :2] += 0.4 * torch.randn(16, 2, 2, generator=random)
    tangents = torch.randn(2, 16, 3, generator=random)
    normal = torch.linalg.cross(tangents[0], tangents[1])
    turned = turn_normals(normal[:, :, None, None], transform)[:, :, 0, 0]
    up = torch.tensor([[1.0, -1.0], [-1.0, 1.0]])  # the transform has y down, vectors have y up
    carry = torch.zeros(16, 3, 3)
    carry[:, :2, :2] = transform[:, :2, :2] * up
    carry[:, 2, 2] = torch.linalg.det(transform[:, :2, :2]).abs().sqrt()
    for tangent in tangents:
        across = torch.einsum("nij,nj->ni", carry, tangent)
        assert (across * turned).sum(1).abs().max() < 1e-4


def test_a_sheared_drawing_keeps_its_outline_on_the_rim() -> None:
    # Where the object turns away from the viewer nothing but the shape of the picture may change.
    moved = Augmentation(**STILL, **CLEAN, stretch=True, shear=20.0)(sphere(4), seed=0)  # type: ignore[arg-type]
    rim = moved["sketch"][:, 0] * moved["mask"][:, 0] > 0.5
    assert rim.sum() > 200
    assert moved["normal"][:, 2][rim].mean() < 0.35


def test_scale_and_translation_move_sketch_and_mask_together() -> None:
    batch = sphere()
    batch["sketch"] = batch["mask"].clone()
    settings = {**STILL, **CLEAN, "scale": (0.7, 0.8), "translation": 0.1}
    moved = Augmentation(**settings)(batch, seed=0)  # type: ignore[arg-type]
    assert (moved["sketch"] - moved["mask"]).abs().mean() < 0.01
    assert not torch.equal(moved["mask"], batch["mask"])


@pytest.mark.skipif(torch.cuda.is_available(), reason="CUDA is there, and is seeded at once")
def test_no_seed_is_kept_for_a_backend_that_is_not_started() -> None:
    """Each step left its stack behind, which took time, and memory for ever."""
    before = len(torch.cuda._queued_calls)
    Augmentation()(sphere(2), seed=0)
    assert len(torch.cuda._queued_calls) == before


def test_samples_of_a_batch_are_changed_each_in_its_own_way() -> None:
    moved = Augmentation()(sphere(2), seed=0)
    assert not torch.equal(moved["normal"][0], moved["normal"][1])
    assert not torch.equal(moved["sketch"][0], moved["sketch"][1])


def test_roughening_touches_the_sketch_alone() -> None:
    batch = sphere()
    moved = Augmentation(**STILL, jitter=3, dropout=0.2, width=1.0)(batch, seed=0)  # type: ignore[arg-type]
    torch.testing.assert_close(moved["normal"], batch["normal"], atol=1e-5, rtol=0)
    assert (moved["sketch"] - batch["sketch"]).abs().mean() > 1e-3


def test_strength_zero_leaves_the_lines_alone() -> None:
    sketch = sphere()["sketch"]
    torch.testing.assert_close(wobble(sketch, 0.0), sketch, atol=1e-4, rtol=0)
    for seed in range(30):  # of a few seeds the least noise lies between the pixels that are looked at
        torch.manual_seed(seed)
        torch.testing.assert_close(drop_lines(sketch, 0.0), sketch)
    torch.testing.assert_close(change_width(sketch, 0.0), sketch)


def test_wobble_moves_lines_by_its_strength() -> None:
    torch.manual_seed(0)
    ramp = torch.arange(SIZE).float().expand(8, 1, SIZE, SIZE)
    inner = (slice(None), slice(None), slice(20, -20), slice(20, -20))
    assert 1.0 < float((wobble(ramp, 2.0) - ramp)[inner].std()) < 2.5


def test_dropped_share_is_bounded() -> None:
    torch.manual_seed(0)
    gone = 1 - drop_lines(torch.ones(64, 1, SIZE, SIZE), 0.3).mean(dim=(1, 2, 3))
    assert gone.max() <= 0.3
    assert gone.mean() > 0.1


def test_strays_leave_the_form_as_it_is() -> None:
    batch = sphere()
    given: Any = {**STILL, **CLEAN}
    plain, marked = (Augmentation(**given, distractor_strokes=share)(batch, seed=0) for share in (0.0, 1.0))
    assert torch.equal(plain["normal"], marked["normal"])
    assert (marked["sketch"] > plain["sketch"]).flatten(1).any(1).all()


@pytest.mark.parametrize("kind", ["fills", "decals", "hatching"])
def test_marks_change_the_sketch_alone(kind: str) -> None:
    batch = sphere()
    settings: list[Any] = [{**STILL, **CLEAN, kind: share} for share in (0.0, 1.0, 1.0)]
    plain, marked, again = (Augmentation(**given)(batch, seed=4) for given in settings)
    assert torch.equal(plain["normal"], marked["normal"])
    assert torch.equal(plain["mask"], marked["mask"])
    assert torch.equal(marked["sketch"], again["sketch"])
    assert (marked["sketch"] != plain["sketch"]).any()
    assert 0 <= float(marked["sketch"].min()) <= float(marked["sketch"].max()) <= 1
    outside = plain["mask"] < 0.5
    assert torch.equal(marked["sketch"][outside], plain["sketch"][outside])


def test_a_grid_takes_each_pixel_from_where_it_was_before_it_was_moved() -> None:
    """Pixels of a matrix: two to the right and one down, and a quarter turn about the origin."""
    picture = torch.arange(25.0).view(1, 1, 5, 5)
    move = torch.tensor([[[1.0, 0, 2], [0, 1, 1], [0, 0, 1]]])
    moved = sample_at(picture, sampling_grid(move, 5))
    torch.testing.assert_close(moved[..., 1:, 2:], picture[..., :-1, :-2])
    assert moved[..., 0, :].abs().max() < 1e-4
    turn = torch.tensor([[[0.0, -1, 4], [1, 0, 0], [0, 0, 1]]])  # (x, y) goes to (4 - y, x)
    turned = sample_at(picture, sampling_grid(turn, 5))
    torch.testing.assert_close(turned[0, 0], picture[0, 0].rot90(-1), atol=1e-4, rtol=0)


def test_moves_are_drawn_within_their_bounds_and_mirror_where_asked() -> None:
    torch.manual_seed(0)
    cpu = torch.device("cpu")
    moves = Augmentation(flip=0.5, rotation=30, scale=(0.8, 1.2), translation=0.1).draw_transform(
        400, 64, cpu
    )
    (a, b), (c, d) = moves[:, 0, :2].unbind(1), moves[:, 1, :2].unbind(1)
    determinant = a * d - b * c
    assert 0.4 < (determinant < 0).float().mean() < 0.6
    size = determinant.abs().sqrt()
    assert float(size.min()) >= 0.8 - 1e-5
    assert float(size.max()) <= 1.2 + 1e-5
    assert float(size.max() - size.min()) > 0.35
    angle = torch.rad2deg(torch.atan2(-b, d))
    assert angle.abs().max() <= 30 + 1e-3
    assert angle.std() > 10
    middle = moves @ torch.tensor([31.5, 31.5, 1.0])
    assert (middle[:, :2] - 31.5).abs().max() <= 0.1 * 64
    assert (middle[:, :2] - 31.5).abs().max() > 0.09 * 64


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"flip": 2.0}, r"flip of Augmentation is 2.0"),
        ({"scale": (1.2, 0.8)}, "two numbers, low then high, more than 0"),
        ({"rotation": -1.0}, "0 or more"),
        ({"distractor_strokes": 1.5}, r"distractor_strokes of Augmentation is 1.5"),
        ({"fills": -0.5}, r"fills of Augmentation is -0.5"),
        ({"decals": 1.5}, r"decals of Augmentation is 1.5"),
        ({"hatching": 1.5}, r"hatching of Augmentation is 1.5"),
        ({"shear": 60.0}, r"shear of Augmentation is 60.0"),
    ],
)
def test_settings_are_checked(settings: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Augmentation(**settings)  # type: ignore[arg-type]


class Odd(BatchAugmentation):
    """Gives whatever it is told to."""

    def __init__(self, give: Callable[[Batch], Any]) -> None:
        self.give = give

    def __call__(self, batch: Batch, seed: int) -> Batch:
        given: Batch = self.give(batch)
        return given


@pytest.mark.parametrize(
    ("give", "sentence"),
    [
        # Lightning passes over None: a run would end well, and have learnt nothing.
        (lambda batch: None, r"^Odd gave None; an augmentation gives a batch with all that it was given\.$"),
        (
            lambda batch: {"sketch": batch["sketch"]},
            r"^Odd gave a batch without normal; an augmentation gives",
        ),
        (
            lambda batch: {**batch, "mask": batch["mask"][..., ::2]},
            r"^Odd gave a tensor \(4, 1, 128, 64\) as mask, of which there was a tensor \(4, 1, 128, 128\)",
        ),
    ],
    ids=["nothing", "a part", "half of it"],
)
def test_an_augmentation_that_gives_no_such_batch_is_named(
    give: Callable[[Batch], Any], sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        augmented(Odd(give), sphere(), 0)
