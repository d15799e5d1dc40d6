import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
import pytest
import torch
from PIL import Image
from small_checkpoints import RESIDUAL, UNET, save
from torch import Tensor

import normalgan
from normalgan.__main__ import main
from normalgan.errors import InputError
from normalgan.exporting import comparison
from normalgan.exporting.comparison import examples
from normalgan.exporting.formats import FORMATS
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.models import Generator, UNetGenerator
from normalgan.models.condition import make_condition

KINDS = ("UNetGenerator", "ResidualUNetGenerator")
EXAMPLE = Path(__file__).parents[2] / "examples" / "onnx_python" / "predict.py"
Export = tuple[Path, Generator]

torch.set_num_threads(1)


def export(checkpoint: Path, target: Path, *more: str) -> int:
    return main(["export", str(checkpoint), "-o", str(target), "--size", "32", *more])


def test_the_model_that_is_read_is_not_written_over(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "m.safetensors").write_bytes(b"weights")
    path = tmp_path / "m.safetensors"
    assert export(path, tmp_path / ".." / tmp_path.name / path.name) == 2
    assert "is an input and would be overwritten" in capsys.readouterr().err
    assert path.read_bytes() == b"weights"


# torch takes ten seconds for the first ONNX file.
@pytest.fixture(scope="module", params=[pytest.param(kind, marks=pytest.mark.slow) for kind in KINDS])
def exported(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Export:
    """A folder with a checkpoint and two ONNX files, and the generator."""
    folder = tmp_path_factory.mktemp(request.param)
    generator = save(folder / "last.ckpt", request.param)
    assert export(folder / "last.ckpt", folder / "m.onnx", "--licence", "CC0-1.0") == 0
    assert export(folder / "last.ckpt", folder / "half.onnx", "--half") == 0
    return folder, generator


def predicted(generator: Generator, sketch: object, hints: object) -> Tensor:
    with torch.no_grad():
        result: Tensor = generator(make_condition(torch.as_tensor(sketch), torch.as_tensor(hints)))
    return result


def test_onnx_paints_what_torch_paints_in_any_batch(exported: Export) -> None:
    folder, generator = exported
    session = onnxruntime.InferenceSession(folder / "m.onnx")
    names = [output.name for output in session.get_outputs()]
    for count in (1, 5):
        sketch, hints = examples(count, 32, seed=7)
        wanted = predicted(generator, sketch, hints).numpy()
        outputs = session.run(None, {"sketch": sketch, "hints": hints})
        np.testing.assert_allclose(outputs[0], wanted[:, :3], atol=1e-3)
        assert names == ["normal", "confidence"][: len(outputs)]
        assert len(outputs) == wanted.shape[1] - 2
        if len(outputs) == 2:
            np.testing.assert_allclose(outputs[1], wanted[:, 3:], rtol=1e-3, atol=1e-3)
    assert [i.shape[1:] for i in session.get_inputs()] == [[1, 32, 32], [4, 32, 32]]
    assert {i.type for i in (*session.get_inputs(), *session.get_outputs())} == {"tensor(float)"}


def test_generate_takes_the_file(exported: Export) -> None:
    folder, generator = exported
    model = OnnxBackend(folder / "m.onnx")
    sketch, hints = examples(1, 32, seed=3)
    normal, confidence = model.predict(sketch[0, 0], hints[0])
    wanted = predicted(generator, sketch, hints)[0].numpy()
    np.testing.assert_allclose(normal, wanted[:3].transpose(1, 2, 0), atol=1e-3)
    assert (confidence is None) == (len(wanted) == 3)


@pytest.mark.parametrize("opset", [15, 21])
def test_other_opsets_predict_the_same(exported: Export, tmp_path: Path, opset: int) -> None:
    folder, generator = exported
    target = tmp_path / "old.onnx"
    more = "--opset", str(opset), "--licence", "CC0-1.0"
    assert export(folder / "last.ckpt", target, *more) == 0
    model = onnx.load(target)
    assert [(each.domain, each.version) for each in model.opset_import] == [("", opset)]
    assert model.metadata_props == onnx.load(folder / "m.onnx").metadata_props
    sketch, hints = examples(2, 32, seed=5)
    outputs = onnxruntime.InferenceSession(target).run(None, {"sketch": sketch, "hints": hints})
    np.testing.assert_allclose(outputs[0], predicted(generator, sketch, hints).numpy()[:, :3], atol=1e-3)


def test_the_file_says_what_it_is_and_nothing_of_the_machine(exported: Export) -> None:
    folder, generator = exported
    content = (folder / "m.onnx").read_bytes()
    said = {p.key: p.value for p in onnx.load_from_string(content).metadata_props}
    arguments = UNET if isinstance(generator, UNetGenerator) else RESIDUAL
    assert said == {
        "normalgan_version": normalgan.__version__,
        "model": type(generator).__name__,
        "licence": "CC0-1.0",
        "size": "32",
        "generator": json.dumps({"class_path": type(generator).__name__, "init_args": arguments}),
        "hint_sampler": '{"class_path": "UniformHints", "init_args": {}}',
        "noise_at_test": "false",
        "refined": "false",
        "line_widths": "0.8 1.9",
        "seed": "0",
    }
    for trace in (b".py", str(Path(normalgan.__file__).parent).encode(), str(Path.home()).encode()):
        assert trace not in content


def test_half_precision_halves_the_file_and_keeps_the_normals(
    exported: Export, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    folder, generator = exported
    whole, half = ((folder / name).stat().st_size for name in ("m.onnx", "half.onnx"))
    weights = 2 * sum(p.numel() for p in generator.parameters())  # two bytes less for each
    assert 0.9 * weights < whole - half < weights
    session = onnxruntime.InferenceSession(folder / "half.onnx")
    sketch, hints = examples(2, 32, seed=5)
    wanted = predicted(generator, sketch, hints).numpy()[:, :3]
    error = np.abs(session.run(["normal"], {"sketch": sketch, "hints": hints})[0] - wanted)
    assert 0 < error.mean() < 5e-3
    assert {i.type for i in (*session.get_inputs(), *session.get_outputs())} == {"tensor(float)"}
    capsys.readouterr()
    assert export(folder / "last.ckpt", tmp_path / "half.onnx", "--half") == 0
    assert "° in the mean" in capsys.readouterr().out
    assert (tmp_path / "half.onnx").read_bytes() == (folder / "half.onnx").read_bytes()


@pytest.mark.parametrize("suffix", [".pt", ".pt2"])
def test_the_formats_of_torch_predict_the_same(exported: Export, tmp_path: Path, suffix: str) -> None:
    folder, generator = exported
    target = tmp_path / f"m{suffix}"
    assert export(folder / "last.ckpt", target) == 0
    run = FORMATS[suffix].read(target.read_bytes())
    for count in (1, 4):
        sketch, hints = examples(count, 32, seed=11)
        outputs = np.concatenate(run(sketch, hints), axis=1)
        np.testing.assert_allclose(outputs, predicted(generator, sketch, hints).numpy(), atol=1e-4)


def test_the_example_paints_a_map(exported: Export, tmp_path: Path) -> None:
    folder, generator = exported
    drawing, target = tmp_path / "drawing.png", tmp_path / "normal.png"
    paper = np.full((64, 64), 255, np.uint8)
    paper[10:54, 10:12] = paper[10:54, 52:54] = paper[10:12, 10:54] = paper[52:54, 10:54] = 0
    Image.fromarray(paper).save(drawing)
    subprocess.run([sys.executable, EXAMPLE, folder / "m.onnx", drawing, target], check=True)
    sketch = 1 - paper.reshape(32, 2, 32, 2).mean((1, 3)).astype(np.float32)[None, None] / 255
    hints = np.zeros((1, 4, 32, 32), np.float32)
    hints[0, 2:, 16, 16] = 1
    normal = predicted(generator, sketch, hints)[0, :3].numpy().transpose(1, 2, 0)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    sure = np.abs(length[..., 0] - 0.5) > 0.01  # at the threshold the last bit decides
    wanted = np.where(length > 0.5, normal / length, [0, 0, 1])
    found = np.asarray(Image.open(target)).astype(np.float32) / 127.5 - 1
    assert np.abs(found - wanted)[sure].max() < 0.02
    assert found.shape == (32, 32, 3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "name", "more"), [(KINDS[0], "m.pt", ()), (KINDS[1], "m.onnx", ("--half",))]
)
def test_a_file_that_paints_otherwise_is_not_written(
    kind: str,
    name: str,
    more: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    save(tmp_path / "last.ckpt", kind)
    honest = comparison.predict

    def shifted(*given: object) -> list[np.ndarray[tuple[int, ...], np.dtype[np.float32]]]:
        return [output + np.float32(2e-3) for output in honest(*given)]  # type: ignore[arg-type]

    monkeypatch.setattr(comparison, "predict", shifted)
    assert export(tmp_path / "last.ckpt", tmp_path / "new" / name, *more) == 1
    assert "differs from torch by 0.00" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["last.ckpt"]


def test_the_size_comes_from_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    checkpoint = tmp_path / "run" / "checkpoints" / "last.ckpt"
    checkpoint.parent.mkdir(parents=True)
    save(checkpoint, "ResidualUNetGenerator")
    arguments = ["export", str(checkpoint), "-o", str(tmp_path / "m.pt")]
    assert main(arguments) == 2
    said = "does not say the size of its pictures; give the --data.size of its training"
    assert said in capsys.readouterr().err
    with pytest.raises(InputError, match=re.escape(said)):
        normalgan.load(checkpoint)
    assert normalgan.load(checkpoint, size=16).backend.size == 16
    (tmp_path / "run" / "config.yaml").write_text("data: {size: 24}\n")
    assert main(arguments) == 0
    assert "24 pixels" in capsys.readouterr().out
    save(checkpoint, "UNetGenerator")  # which has a size of its own
    assert main(arguments) == 0
    assert "32 pixels" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["gone.ckpt"], "there is no model gone.ckpt"),
        (["."], ". is a folder; name a checkpoint in it, such as checkpoints/last.ckpt of a run."),
        (["text.ckpt"], "damaged or no checkpoint"),
        (["good.ckpt", "-o", "m.tflite"], "m.tflite must end in .onnx, .safetensors, .pt, .pt2"),
        (["good.ckpt", "-o", "m.pt2", "--half"], "--half is for .onnx and .safetensors"),
        (["good.ckpt", "--opset", "9"], "opset"),
        (
            ["good.ckpt", "-o", "m.pt2", "--opset", "17"],
            "--opset is for .onnx; leave it out, or write .pt2 without it.",
        ),
        (["good.ckpt", "--size", "40"], "sides that are multiples of 32, not 40"),
        (["good.ckpt", "--licence", "two\nlines"], "--licence is one line"),
        (["good.ckpt", "--halve"], "there is no option --halve"),
        (["old.ckpt"], "cannot be built here"),
        (["good.ckpt", "-o", "text.ckpt/m.safetensors"], "text.ckpt"),
    ],
)
def test_what_cannot_be_exported_is_refused_in_a_sentence(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    sentence: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("text.ckpt").write_text("no checkpoint")
    save(Path("good.ckpt"), "UNetGenerator")
    old = torch.load("good.ckpt", weights_only=True)
    old["state_dict"].pop(next(iter(old["state_dict"])))
    torch.save(old, "old.ckpt")
    before = sorted(tmp_path.rglob("*"))
    assert main(["export", *arguments]) in {1, 2}
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1
    assert sorted(tmp_path.rglob("*")) == before
