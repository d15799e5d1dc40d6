"""The tool that takes the mean of two trainings of one network."""

import runpy
import sys
from pathlib import Path

import pytest
import torch

from normalgan.errors import InputError
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


def test_what_has_no_mean_is_refused(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    shipped = read_weights(SHIPPED)
    smaller = Weights(shipped.notes, dict(list(shipped.tensors.items())[1:]))
    with pytest.raises(InputError, match="different networks"):
        TOOL["mean_weights"](shipped, smaller, 0.5)
    monkeypatch.setattr(sys, "argv", ["mean_weights.py", "shipped", "shipped", "out", "--share", "1.5"])
    with pytest.raises(SystemExit, match="2"):
        TOOL["main"]()
    assert "the share is 1.5; give 0 to 1." in capsys.readouterr().err
