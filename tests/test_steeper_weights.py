"""The tool that makes weights paint steeper slopes."""

import runpy
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import torch
import torch.nn.functional as F

from normalgan.errors import InputError
from normalgan.models import GENERATORS
from normalgan.weights.class_spec import ClassSpec
from normalgan.weights.file import SHIPPED, Weights, read_weights

TOOL = runpy.run_path(str(Path(__file__).parents[1] / "tools" / "steeper_weights.py"))


def weights_of(name: str, **settings: object) -> Weights:
    torch.manual_seed(0)
    part = ClassSpec(name, settings)
    return Weights(replace(read_weights(SHIPPED).notes, generator=part), part.build(GENERATORS).state_dict())


@pytest.mark.parametrize(("patch", "detail"), [(2, 1), (4, 2)])
def test_slopes_are_multiplied_and_all_else_stays(patch: int, detail: int) -> None:
    flat = weights_of("ResidualUNetGenerator", widths=[6, 8], blocks=[1, 1], patch=patch, detail=detail)
    steep = TOOL["steeper"](flat, 1.5)
    given = torch.rand(2, 4, 16, 16)
    with torch.no_grad():
        before, after = (each.generator().eval().predict(given) for each in (flat, steep))
    wanted = F.normalize(before.direction * torch.tensor([1.5, 1.5, 1.0]).view(3, 1, 1), dim=1)
    torch.testing.assert_close(after.direction, wanted, atol=1e-5, rtol=1e-4)
    assert not torch.allclose(after.direction, before.direction, atol=1e-2)
    torch.testing.assert_close(after.presence, before.presence)
    torch.testing.assert_close(after.confidence, before.confidence)


def test_the_command_writes_weights_that_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "steep.safetensors"
    monkeypatch.setattr(sys, "argv", ["steeper_weights.py", "shipped", str(out), "--slopes", "1.25"])
    TOOL["main"]()
    shipped, steep = read_weights(SHIPPED), read_weights(out)
    assert steep.notes == shipped.notes
    torch.testing.assert_close(
        steep.tensors["heads.bias"][:32], shipped.tensors["heads.bias"][:32].float() * 1.25
    )
    torch.testing.assert_close(steep.tensors["heads.bias"][32:], shipped.tensors["heads.bias"][32:].float())


def test_what_cannot_be_made_steeper_is_refused() -> None:
    with pytest.raises(InputError, match=r"multiplied by 0\.0; give a number above 0"):
        TOOL["steeper"](read_weights(SHIPPED), 0.0)
    with pytest.raises(InputError, match="weights of UNetGenerator; give a ResidualUNetGenerator's"):
        TOOL["steeper"](weights_of("UNetGenerator", size=32, width=4), 1.1)
