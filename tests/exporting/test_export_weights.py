"""Export as safetensors."""

import warnings
from pathlib import Path

import pytest
import torch
from small_checkpoints import save, save_generator
from torch import Tensor, nn

from normalgan.__main__ import main
from normalgan.exporting.comparison import examples
from normalgan.models import Generator
from normalgan.models.condition import make_condition
from normalgan.weights.file import read_weights

torch.set_num_threads(1)


def export(checkpoint: Path, target: Path, *more: str) -> int:
    given = ["export", str(checkpoint), "-o", str(target), "--size", "32"]
    return main([*given, *more])


def predicted(generator: Generator) -> torch.Tensor:
    sketch, hints = examples(2, 32, seed=13)
    with torch.no_grad():
        result: torch.Tensor = generator(make_condition(torch.from_numpy(sketch), torch.from_numpy(hints)))
    return result


@pytest.mark.parametrize("kind", ["UNetGenerator", "ResidualUNetGenerator"])
def test_weights_alone_build_the_generator(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    generator = save(tmp_path / "last.ckpt", kind)
    wanted = predicted(generator)
    for more, most in (((), 0.0), (("--half",), 0.1)):
        target = tmp_path / f"m{len(more)}.safetensors"
        assert export(tmp_path / "last.ckpt", target, *more) == 0
        assert ("half precision turns" in capsys.readouterr().out) == bool(more)
        weights = read_weights(target)
        assert weights.notes.size == 32
        error = (predicted(weights.generator()) - wanted).abs()
        assert error.mean() <= most
    small, large = ((tmp_path / f"m{n}.safetensors").stat().st_size for n in (1, 0))
    assert 0.4 < small / large < 0.75


def test_weights_are_exported_as_their_checkpoint_is(tmp_path: Path) -> None:
    save(tmp_path / "last.ckpt", "ResidualUNetGenerator")
    first, again = tmp_path / "first.safetensors", tmp_path / "again.safetensors"
    assert export(tmp_path / "last.ckpt", first, "--licence", "CC0") == 0
    assert main(["export", str(first), "-o", str(again)]) == 0
    assert again.read_bytes() == first.read_bytes()
    assert main(["export", str(first), "-o", str(again), "--licence", "MIT"]) == 0
    assert read_weights(again).notes.licence == "MIT"


class ReshapedWeights(Generator):
    """A network whose weights are reshaped or combined before they are used.

    Args:
        tied: whether two layers share their weights.
    """

    def __init__(self, tied: bool = False) -> None:
        super().__init__()
        self.stem = nn.Conv2d(4, 8, 1)
        self.norm = nn.GroupNorm(4, 8)
        self.scale = nn.Parameter(torch.full((8, 1, 1), -0.5))
        self.mix = nn.utils.parametrizations.weight_norm(nn.Linear(8, 8))
        self.again = self.mix if tied else nn.Linear(8, 8)
        self.head = nn.Conv2d(8, 3, 1)

    def forward(self, condition: Tensor) -> Tensor:
        """Return normals (N, 3, H, W)."""
        inside = self.norm(self.stem(condition)) * self.scale.exp()
        inside = self.again(self.mix(inside.movedim(1, -1)).relu()).movedim(-1, 1)
        return torch.tanh(self.head(inside))


@pytest.mark.slow
def test_an_onnx_file_keeps_weights_that_are_reshaped_before_use(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Folding constants used to replace them by the result, so that predict and test found no weights.
    name = f"{__name__}.ReshapedWeights"
    generator = save_generator(tmp_path / "last.ckpt", ReshapedWeights(), name, {})
    assert export(tmp_path / "last.ckpt", tmp_path / "m.onnx") == 0
    read = read_weights(tmp_path / "m.onnx").generator()
    torch.testing.assert_close(predicted(read), predicted(generator))
    save_generator(tmp_path / "tied.ckpt", ReshapedWeights(tied=True), name, {"tied": True})
    assert "warning" not in capsys.readouterr().err
    with warnings.catch_warnings(action="default"):  # printed, as by the command
        assert export(tmp_path / "tied.ckpt", tmp_path / "tied.onnx") == 0
    assert "its graph does not keep all weights; export .safetensors" in capsys.readouterr().err
