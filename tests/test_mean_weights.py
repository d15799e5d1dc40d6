"""The tool that takes the mean of two trainings of one network."""

import runpy
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import torch

from normalgan.errors import InputError
from normalgan.models import GENERATORS
from normalgan.weights.class_spec import ClassSpec
from normalgan.weights.file import SHIPPED, Weights, read_weights

TOOL = runpy.run_path(str(Path(__file__).parents[1] / "tools" / "mean_weights.py"))


def moved(weights: Weights, by: float) -> Weights:
    return Weights(
        weights.notes,
        {n: t + by if t.is_floating_point() else t for n, t in weights.tensors.items()},
    )


def test_a_share_of_the_way_is_gone_from_one_to_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shipped = read_weights(SHIPPED)
    other, out = tmp_path / "other.safetensors", tmp_path / "mean.safetensors"
    other.write_bytes(moved(shipped, 1.0).to_bytes())
    monkeypatch.setattr(sys, "argv", ["mean_weights.py", "shipped", str(other), str(out), "--share", "0.25"])
    TOOL["main"]()
    mean = read_weights(out)
    assert mean.notes == shipped.notes
    for name, tensor in mean.tensors.items():
        before = shipped.tensors[name]
        if tensor.is_floating_point():
            assert tensor.dtype == torch.float32
            torch.testing.assert_close(tensor, before.float() + 0.25, atol=2e-2, rtol=0)  # 16 bits of 1 more
        else:
            assert torch.equal(tensor, before)


def test_the_mean_with_what_a_network_has_grown_from_is_between_the_two() -> None:
    def network(*widths: int) -> Weights:
        torch.manual_seed(widths[0])
        settings: dict[str, Any] = {"widths": list(widths), "blocks": [1, 1], "patch": 2, "norm": "batch"}
        part = ClassSpec("ResidualUNetGenerator", settings)
        return Weights(
            replace(read_weights(SHIPPED).notes, generator=part), part.build(GENERATORS).state_dict()
        )

    small, large = network(6, 8), network(9, 8)
    given = torch.rand(2, 4, 16, 16)
    with torch.no_grad():
        wanted, at_start, half = (
            weights.generator()(given)
            for weights in (
                small,
                TOOL["mean_weights"](small, large, 0.0),
                TOOL["mean_weights"](small, large, 0.5),
            )
        )
    torch.testing.assert_close(at_start, wanted, atol=1e-5, rtol=1e-4)
    assert not torch.allclose(half, wanted, atol=1e-2)
    other = TOOL["mean_weights"](small, large, 0.5).tensors["stem.weight"][6:]
    torch.testing.assert_close(other, large.tensors["stem.weight"][6:])  # new channels as they have learnt


def test_what_has_no_mean_is_refused(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    shipped = read_weights(SHIPPED)
    part = ClassSpec("UNetGenerator", {"size": 32, "width": 4})
    another = Weights(replace(shipped.notes, generator=part), part.build(GENERATORS).state_dict())
    with pytest.raises(InputError, match="different networks"):
        TOOL["mean_weights"](shipped, another, 0.5)
    monkeypatch.setattr(sys, "argv", ["mean_weights.py", "shipped", "shipped", "out", "--share", "1.5"])
    with pytest.raises(SystemExit, match="2"):
        TOOL["main"]()
    assert "the share is 1.5; give 0 to 1." in capsys.readouterr().err
