"""benchmarks/speedrun_ideas.py and the yardstick of speedrun_cost.py: what was tried can be tried again."""

import importlib
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, cast

import pytest
import torch
from torch import Tensor, nn

from normalgan.batch import Batch
from normalgan.models import Generator
from normalgan.optimizers import MuonRAdam

ROOT = Path(__file__).parents[2]
SMALL: dict[str, Any] = {"widths": (8, 32), "blocks": (1, 1)}


@pytest.fixture
def ideas(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    return imported("speedrun_ideas", monkeypatch)


@pytest.fixture
def cost(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    return imported("speedrun_cost", monkeypatch)


def imported(name: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    monkeypatch.delitem(sys.modules, name, raising=False)
    return importlib.import_module(name)


def batch(count: int = 4, side: int = 16) -> Batch:
    torch.manual_seed(0)
    mask = torch.zeros(count, 1, side, side)
    mask[..., 2 : side - 6] = 1  # not its own mirror image
    normal = nn.functional.normalize(torch.randn(count, 3, side, side), dim=1) * mask
    sketch = torch.rand(count, 1, side, side)
    return {"sketch": sketch, "normal": normal, "mask": mask, "name": [f"sample {i}" for i in range(count)]}


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("AttentionUNet", {"levels": 1}),
        ("OtherBlocksUNet", {"kind": "NAF"}),
        ("OtherBlocksUNet", {"kind": "ConvNeXt"}),
    ],
)
def test_a_network_learns_in_every_weight(ideas: ModuleType, name: str, settings: dict[str, Any]) -> None:
    torch.manual_seed(0)
    network: Generator = getattr(ideas, name)(**SMALL, **settings)
    optimizer = torch.optim.Adam(network.parameters(), lr=1e-2)
    condition = torch.rand(2, 4, 16, 16) * 2 - 1
    losses = []
    for _ in range(4):
        preds = network.predict(condition)
        assert preds.direction.shape == (2, 3, 16, 16)
        assert preds.presence is not None
        assert preds.confidence is not None
        loss = (preds.direction[:, 2] - 1).square().mean() + preds.presence.mean() + preds.confidence.mean()
        optimizer.zero_grad()
        loss.backward()
        losses.append(loss.item())
        without = [at for at, weights in network.named_parameters() if weights.grad is None]
        assert not without
        optimizer.step()
    assert losses[-1] < losses[0]


def test_attention_says_nothing_at_first_and_then_tells_of_far_places(ideas: ModuleType) -> None:
    torch.manual_seed(0)
    attention = ideas.Attention(64).eval()
    features = torch.randn(2, 64, 3, 5)
    assert torch.equal(attention(features), features)
    nn.init.normal_(attention.out.weight)
    other = features.clone()
    other[:, :, 2, 4] += 1
    changed = (attention(features) - features) - (attention(other) - other)
    assert changed[:, :, 0, 0].abs().max() > 1e-4


def test_every_other_time_a_sample_is_its_mirror_image(ideas: ModuleType) -> None:
    given = batch()
    flip = ideas.AlternatingFlip(rotation=0.0, scale=(1.0, 1.0), translation=0.0)
    first, second = flip(given, 1), flip(given, 2)
    across = torch.tensor([-1.0, 1, 1])[:, None, None]
    mirrored = 0
    for i in range(4):
        as_it_is, other = (first, second) if same(first["mask"][i], given["mask"][i]) else (second, first)
        mirrored += as_it_is is second
        for name in ("sketch", "normal", "mask"):
            assert same(as_it_is[name][i], given[name][i])
        assert same(other["sketch"][i], given["sketch"][i].flip(2))
        assert same(other["normal"][i], given["normal"][i].flip(2) * across)
    assert 0 < mirrored < 4, "not all begin alike"


def same(one: Tensor, other: Tensor) -> bool:
    return torch.allclose(one, other, atol=1e-4)


def test_pictures_are_small_at_first(ideas: ModuleType) -> None:
    small = ideas.SmallFirst(epochs=1)
    given = batch()
    small.on_train_batch_start(SimpleNamespace(current_epoch=0), None, given, 0)
    assert [given[name].shape[2:] for name in ("sketch", "normal", "mask")] == [(8, 8)] * 3
    lengths = given["normal"].norm(dim=1, keepdim=True)
    assert same(lengths, given["mask"])
    given = batch()
    small.on_train_batch_start(SimpleNamespace(current_epoch=1), None, given, 0)
    assert given["sketch"].shape[2:] == (16, 16)


class Noting:
    """In place of an optimiser: notes what it is told, and in which precision it multiplies."""

    def __init__(self) -> None:
        self.noted: list[Any] = []

    def train(self) -> None:
        self.noted.append("train")

    def eval(self) -> None:
        self.noted.append("eval")

    def step(self) -> None:
        self.noted.append((torch.ones(2, 2) @ torch.ones(2, 2)).dtype)


def test_optimisers_of_other_packages_are_told_what_they_need(ideas: ModuleType) -> None:
    optimizer = Noting()
    trainer = SimpleNamespace(optimizers=[optimizer])
    module = SimpleNamespace(device=torch.device("cpu"))
    modes = ideas.ScheduleFreeModes()
    modes.on_train_epoch_start(trainer, module)
    modes.on_validation_start(trainer, module)
    with torch.autocast("cpu", torch.bfloat16):
        optimizer.step()
        ideas.StepsInFloat32().on_train_start(trainer, module)
        optimizer.step()
    assert optimizer.noted == ["train", "eval", torch.bfloat16, torch.float32]


def test_wide_layers_step_every_other_time_by_the_mean_of_two_gradients(ideas: ModuleType) -> None:
    torch.manual_seed(0)
    start, first, second = torch.randn(3, 32, 48).unbind()
    lazy, whole = nn.Parameter(start.clone()), nn.Parameter(start.clone())
    optimizer = ideas.EveryOtherMuonRAdam([lazy], lr=1e-2)
    lazy.grad = first
    optimizer.step()
    assert torch.equal(lazy, start)
    lazy.grad = second
    optimizer.step()
    whole.grad = (first + second) / 2
    MuonRAdam([whole], lr=2e-2, betas=(0.9, 0.98), weight_decay=0.02).step()
    assert torch.equal(lazy, whole)


def test_the_yardstick_changes_no_randomness_and_takes_time(cost: ModuleType) -> None:
    torch.manual_seed(3)
    expected = torch.rand(1)
    torch.manual_seed(3)
    assert cost.Yardstick().seconds() > 0
    assert torch.equal(torch.rand(1), expected)


def test_a_slow_machine_is_taken_out_of_the_cost(
    cost: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    capability = torch.backends.cpu.get_cpu_capability()
    monkeypatch.setattr(cost, "IDLE", {capability: 0.05})
    now = iter([0.0, 30.0, 100.0, 160.0])  # 30 seconds, the yardstick, 60 seconds
    monkeypatch.setattr(cost.time, "process_time", lambda: next(now))
    monkeypatch.setattr(cost.Yardstick, "seconds", lambda self: 0.1)
    (tmp_path / "stop.json").write_text('{"target": 1.0, "most": 40.0}', encoding="utf-8")
    errors = {f"val/{hints}/angular_mean": torch.tensor(20.0) for hints in ("hints", "no_hints")}
    trainer = SimpleNamespace(
        sanity_checking=False, callback_metrics=errors, default_root_dir=tmp_path, should_stop=False
    )
    module = cast(Any, nn.Linear(1, 1))
    module.device = torch.device("cpu")
    callback = cost.Cost()
    callback.on_train_epoch_start(trainer, module)
    callback.on_train_batch_end(trainer, module, None, {"sketch": torch.zeros(4, 1, 2, 2)}, 0)
    callback.on_validation_start(trainer, module)
    callback.on_validation_end(trainer, module)
    (point,) = callback.curve
    assert point == {"cost": 45.0, "images": 4, "slowdown": 2.0, "hints": 20.0, "no_hints": 20.0}
    assert trainer.should_stop, "beyond the most that it may cost"
