"""Classes of the working directory, as `python -m normalgan` finds them."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from command import run
from PIL import Image

import normalgan
from normalgan.errors import InputError
from normalgan.models import UNetGenerator
from normalgan.weights.checkpoint import read_checkpoint
from normalgan.weights.local_classes import no_local_classes
from pens import blob, outline

NETS = '''
"""Own parts."""
from normalgan.models import UNetGenerator


class OwnGenerator(UNetGenerator):
    """A generator of one's own."""
'''


@pytest.fixture(name="folder")
def make_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own_nets.py").write_text(NETS)
    yield tmp_path
    sys.modules.pop("own_nets", None)


def save(path: Path, generator: str, hint_sampler: Any) -> None:
    torch.manual_seed(0)
    state = UNetGenerator(size=32, width=4).state_dict()
    torch.save(
        {
            "state_dict": {f"generator.{name}": tensor for name, tensor in state.items()},
            "hyper_parameters": {
                "generator": {"class_path": generator, "init_args": {"size": 32, "width": 4}},
                "discriminator": None,
                "hint_sampler": hint_sampler,
                "objective": {"class_path": "normalgan.losses.Wasserstein", "init_args": {}},
            },
        },
        path,
    )


@pytest.mark.parametrize(
    "sampler",
    [
        {"class_path": "gone_package.Hints", "init_args": {"spacing": 4}},
        {"made_in_python": "gone_package.Hints"},
    ],
    ids=["named", "made in Python"],
)
def test_inference_does_not_need_the_hint_sampler(folder: Path, sampler: dict[str, Any]) -> None:
    save(folder / "m.ckpt", "normalgan.models.UNetGenerator", sampler)
    assert normalgan.load("m.ckpt").backend.size == 32
    done = run("export", "m.ckpt", "-o", "m.safetensors")
    assert done.code == 0, done.err
    assert normalgan.load("m.safetensors").backend.size == 32
    drawing = folder / "ring.png"
    Image.fromarray(np.rint(255 * (1 - outline(blob((48, 48), (24, 24), 16)))).astype(np.uint8)).save(drawing)
    more = ("--trainer.accelerator", "cpu", "--trainer.enable_progress_bar", "false")
    for model in ("m.ckpt", "m.safetensors") if "class_path" in sampler else ["m.ckpt"]:
        given = (
            "--data.size",
            32,
            "--data.prediction.sketches",
            drawing,
            "--output.folder",
            Path(f"of_{model}"),
        )
        done = run("predict", "--ckpt_path", model, *given, *more)
        assert done.code == 0, done.err
        assert list(Path(f"of_{model}").glob("ring*"))
    run("test", "--ckpt_path", "m.ckpt", "--data.size", 32).refused(
        "hint sampler" if "made_in_python" in sampler else "gone_package.Hints"
    )


def test_export_and_load_import_a_generator_of_the_working_directory(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(folder / "m.ckpt", "own_nets.OwnGenerator", {"class_path": "normalgan.hints.NoHints"})
    run("export", "m.ckpt", "-o", "m.safetensors").refused(
        "no Generator named 'own_nets.OwnGenerator'", "run python -m normalgan in the folder of own_nets"
    )
    monkeypatch.syspath_prepend(str(folder))
    done = run("export", "m.ckpt", "-o", "m.safetensors")
    assert done.code == 0, done.err
    for model in ("m.ckpt", "m.safetensors"):
        sys.modules.pop("own_nets", None)
        assert normalgan.load(model).backend.size == 32


def test_only_a_module_that_defines_the_class_is_imported(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(folder))
    trap = "from pathlib import Path\nPath('touched').touch()\n"
    (folder / "third_nets.py").write_text(NETS)
    (folder / "trap.py").write_text(trap)
    (folder / "json.py").write_text(f"{trap}class Own: pass\n")  # Python knows another module of that name
    for name in ("trap.OwnGenerator", "json.Own"):
        save(folder / "m.ckpt", name, {"class_path": "normalgan.hints.NoHints"})
        with pytest.raises(InputError, match="no Generator named"):
            read_checkpoint(folder / "m.ckpt").weights()
    save(folder / "m.ckpt", "third_nets.OwnGenerator", {"class_path": "normalgan.hints.NoHints"})
    with no_local_classes(), pytest.raises(InputError, match="no Generator named"):
        read_checkpoint(folder / "m.ckpt").weights()
    assert not (folder / "touched").exists()
    assert "third_nets" not in sys.modules


def test_a_module_that_fails_is_told_in_a_sentence(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(folder))
    (folder / "failing_nets.py").write_text(f"{NETS}\n1 / 0\n")
    save(folder / "m.ckpt", "failing_nets.OwnGenerator", {"class_path": "normalgan.hints.NoHints"})
    run("export", "m.ckpt", "-o", "m.onnx").refused("failing_nets.py cannot be imported: ZeroDivisionError")
