import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.cost import images_per_second
from normalgan.benchmark.measure import HintTests, measure
from normalgan.benchmark.methods import Method, constant_method, inflation_method, mean_method
from normalgan.hints import NoHints, UniformHints
from normalgan.metrics import angular_error

CPU = torch.device("cpu")


def a_batch(names: list[str]) -> Batch:
    generator = torch.Generator().manual_seed(len(names))
    mask = torch.zeros(len(names), 1, 16, 16)
    mask[:, :, 2:14, 2:14] = 1
    normal = torch.nn.functional.normalize(torch.randn(len(names), 3, 16, 16, generator=generator), dim=1)
    return {"sketch": torch.zeros_like(mask), "normal": normal * mask, "mask": mask, "name": names}


def copycat(batch: Batch, hints: Tensor | None) -> Tensor:
    """Paint what the hints say and else the constant normal, so that only hinted pixels get better."""
    facing = torch.zeros_like(batch["normal"])
    facing[:, 2] = 1
    return facing if hints is None else torch.where(hints[:, 3:] > 0.5, hints[:, :3], facing)


def test_hinted_pixels_count_for_no_method() -> None:
    batches = [a_batch(["a/0", "a/1"]), a_batch(["a/2"])]
    sampler = UniformHints(minimum=5, maximum=5)
    constant = measure(constant_method(), batches, HintTests([0, 5, 20]), CPU).figures
    copied = measure(Method(copycat, sampler), batches, HintTests([0, 5, 20]), CPU).figures
    for count in ("0", "5", "20"):
        assert copied[count] == constant[count]
    assert constant["0"] != constant["5"]  # other pixels
    assert copied["own"]["hints"] == 5
    assert constant["own"] == {**constant["0"], "hints": 0}


def test_a_method_without_hints_is_given_none() -> None:
    given: list[Tensor | None] = []

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        given.append(hints)
        return copycat(batch, hints)

    measure(Method(predict, NoHints()), [a_batch(["a"])], HintTests([0, 5]), CPU)
    assert given == [None]
    measure(Method(predict, UniformHints()), [a_batch(["a"])], HintTests([0, 5]), CPU)
    assert [None if hints is None else int(hints[:, 3].sum()) for hints in given[1:3]] == [None, 5]


def test_figures_are_those_of_the_pixels() -> None:
    batch = a_batch(["a"])
    mean_map = torch.nn.functional.normalize(torch.ones(3, 16, 16), dim=0)
    figures = measure(mean_method(mean_map), [batch], HintTests([0]), CPU).figures["0"]
    angles = angular_error(mean_map[None], batch["normal"])[batch["mask"] > 0]
    assert figures["angular_mean"] is not None
    assert abs(figures["angular_mean"] - angles.mean().item()) < 1e-3
    assert figures["below_30"] == (angles < 30).float().mean().item()


def test_inflation_is_told_the_outline_and_nothing_else() -> None:
    batch = a_batch(["a"])
    predicted = inflation_method().predict(batch, None)
    other: Batch = {**batch, "normal": batch["normal"].flip(1), "sketch": batch["sketch"] + 1}
    assert torch.equal(inflation_method().predict(other, None), predicted)
    assert torch.equal(predicted.norm(dim=1, keepdim=True) > 0.5, batch["mask"] > 0.5)


def test_a_map_that_is_not_finite_has_no_figure() -> None:
    broken = Method(lambda batch, hints: torch.full_like(batch["normal"], torch.nan))
    measured = measure(broken, [a_batch(["a"])], HintTests([0]), CPU)
    assert measured.figures["0"]["angular_mean"] is None
    assert measured.figures["0"]["nz_bias"] is None
    assert measured.meshes["0"]["a"]["angular_mean"] is None


def test_measuring_does_not_use_tf32() -> None:
    allowed: list[bool] = []

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        allowed.append(torch.backends.cudnn.allow_tf32)
        return copycat(batch, hints)

    assert torch.backends.cudnn.allow_tf32  # PyTorch's default, with which a model is trained
    measure(Method(predict), [a_batch(["a"])], HintTests([0]), CPU)
    images_per_second(Method(predict), a_batch(["a"]), CPU, 0)
    assert set(allowed) == {False}
    assert torch.backends.cudnn.allow_tf32


def test_figures_by_mesh_are_those_of_the_mesh_alone() -> None:
    batches = [a_batch(["a/0", "b/0", "a/1"]), a_batch(["b/1"])]
    measured = measure(constant_method(), batches, HintTests([5]), CPU)
    assert measured.meshes["5"].keys() == {"a", "b"}
    first: Batch = {
        "sketch": batches[0]["sketch"][[0, 2]],
        "normal": batches[0]["normal"][[0, 2]],
        "mask": batches[0]["mask"][[0, 2]],
        "name": ["a/0", "a/1"],
    }
    alone = measure(constant_method(), [first], HintTests([5]), CPU)
    assert {**alone.figures["5"], "pixels": 2 * (12 * 12 - 5)} == measured.meshes["5"]["a"]
