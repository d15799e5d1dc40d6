"""Export as safetensors."""

from pathlib import Path

import pytest
import torch
from small_checkpoints import save

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
