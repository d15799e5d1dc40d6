"""A model in any kind of file is measured alike."""

from pathlib import Path

import pytest
import torch

from normalgan.batch import Batch
from normalgan.benchmark.accumulator import Figure
from normalgan.benchmark.measure import HintTests, measure
from normalgan.benchmark.methods import model_method, saved_method
from normalgan.errors import InputError
from normalgan.gan import NormalGAN
from normalgan.hints import UniformHints
from normalgan.losses import Wasserstein
from normalgan.models import UNetGenerator
from normalgan.weights.class_spec import ClassSpec
from normalgan.weights.file import Weights, read_weights
from normalgan.weights.metadata import ModelMetadata
from normalgan.weights.shipped import SHIPPED
from onnx_models import write_model

CPU = torch.device("cpu")
torch.set_num_threads(1)


def a_batch(size: int, count: int) -> Batch:
    generator = torch.Generator().manual_seed(3)
    mask = torch.zeros(count, 1, size, size)
    mask[:, :, size // 8 : -size // 8, size // 8 : -size // 8] = 1
    normal = torch.nn.functional.normalize(torch.randn(count, 3, size, size, generator=generator), dim=1)
    sketch = (torch.rand(count, 1, size, size, generator=generator) > 0.95).float()
    return {"sketch": sketch, "normal": normal * mask, "mask": mask, "name": ["a/0", "a/1"][:count]}


def figures_of(name: str, size: int, count: int) -> dict[str, Figure]:
    return measure(saved_method(name, size, CPU), [a_batch(size, count)], HintTests([0, 20]), CPU).figures


def test_the_shipped_file_measures_the_same_in_torch_and_in_onnx_runtime() -> None:
    by_weights, by_onnx = figures_of("shipped", 256, 1), figures_of(str(SHIPPED), 256, 1)
    assert by_weights.keys() == by_onnx.keys() == {"0", "20", "own"}
    for given, figures in by_weights.items():
        others = dict(by_onnx[given])
        # They are read from bins: what lies at the edge of one may fall into the next.
        for binned, step in (("angular_median", 0.011), ("calibration_error", 0.05)):
            assert figures.pop(binned) == pytest.approx(others.pop(binned), abs=step)
        assert figures == pytest.approx(others, abs=2e-3)
    assert by_weights["20"]["angular_mean"] != by_weights["0"]["angular_mean"]  # the hints were looked at
    assert saved_method("shipped", 256, CPU).sampler == UniformHints(1, 200, 0.3, "log")


def test_noise_sampler_and_weights_come_from_the_file(tmp_path: Path) -> None:
    torch.manual_seed(0)
    generator, sampler = UNetGenerator(size=32, width=4), UniformHints(4, 4)
    notes = ModelMetadata(
        generator=ClassSpec("UNetGenerator", {"size": 32, "width": 4}),
        hint_sampler=ClassSpec("UniformHints", {"minimum": 4, "maximum": 4}),
        size=32,
        noise_at_test=True,
    )
    path = tmp_path / "m.safetensors"
    path.write_bytes(Weights(notes, generator.state_dict()).to_bytes())
    model = NormalGAN(generator, None, sampler, Wasserstein(), noise_at_test=True)
    wanted = measure(model_method(model), [a_batch(32, 2)], HintTests([0, 20]), CPU).figures
    assert figures_of(str(path), 32, 2) == wanted
    assert wanted["own"]["hints"] == 4


def test_models_of_another_size_or_kind(tmp_path: Path) -> None:
    for name in ("shipped", str(SHIPPED)):
        with pytest.raises(InputError, match=r"was trained at 256 pixels, not 64; data.size must be 256"):
            saved_method(name, 64, CPU)
    for name in ("gone.onnx", "gone.safetensors", "gone.ckpt"):
        with pytest.raises(InputError, match=f"there (is|are) no .* {name}"):
            saved_method(name, 64, CPU)
    with pytest.raises(InputError, match="does not say which hints it was trained with; export it again"):
        saved_method(str(write_model(tmp_path / "ramp.onnx")), 64, CPU)
    assert read_weights(SHIPPED).notes.size == 256
