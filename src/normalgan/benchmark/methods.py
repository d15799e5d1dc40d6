"""Method: anything that predicts normal maps, trained or not."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor, nn

from normalgan.arrays import Floats
from normalgan.batch import Batch
from normalgan.benchmark.inflation import inflated_normals
from normalgan.callbacks.checkpoints import check_size
from normalgan.errors import InputError
from normalgan.gan import NormalGAN
from normalgan.hints import HINT_SAMPLERS, HintSampler, NoHints
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.losses import Wasserstein
from normalgan.seeds import derive_seed
from normalgan.weights.checkpoint import read_checkpoint
from normalgan.weights.class_spec import ClassSpec
from normalgan.weights.file import SUFFIXES, Weights, read_weights
from normalgan.weights.shipped import SHIPPED_NAME, find_model


@dataclass(frozen=True)
class Method:
    """A method of predicting normal maps.

    Args:
        predict: function of a batch and hints (N, 4, H, W) or None, which returns normals (N, 3, H, W), or
            normals and confidence (N, 4, H, W). Only classical methods may use the truth; their docstrings
            say so.
        sampler: sampler of the hints that the method was trained with; `NoHints` if it uses none.
        generator: network of the method, or None.
        timed: whether the speed can be measured; predictions of another program are only read.
    """

    predict: Callable[[Batch, Tensor | None], Tensor]
    sampler: HintSampler = NoHints()  # noqa: RUF009  # frozen
    generator: nn.Module | None = None
    timed: bool = True

    @property
    def takes_hints(self) -> bool:
        """Whether the method uses hints."""
        return not isinstance(self.sampler, NoHints)


def constant_method() -> Method:
    """Return the method that always predicts normals that face the viewer."""
    facing = torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1)
    return Method(lambda batch, hints: facing.to(batch["normal"]).expand_as(batch["normal"]))


def mean_method(mean_map: Tensor) -> Method:
    """Return the method that always predicts the mean map (3, H, W) of the training split."""
    return Method(lambda batch, hints: mean_map.to(batch["normal"]).expand_as(batch["normal"]))


def inflation_method() -> Method:
    """Return the method that inflates the true mask, which other methods do not see."""

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        masks = batch["mask"][:, 0].cpu().numpy() > 0.5
        normals = [torch.from_numpy(inflated_normals(mask)).permute(2, 0, 1) for mask in masks]
        return torch.stack(normals).to(batch["normal"])

    return Method(predict)


def weights_method(weights: Weights, device: torch.device) -> Method:
    """Return the model of a weights file as a method, in float32."""
    notes = weights.notes
    model = NormalGAN(
        generator=weights.generator(),
        discriminator=None,
        hint_sampler=notes.build_hint_sampler(),
        objective=Wasserstein(),  # not used, because nothing is trained
        noise_at_test=notes.noise_at_test,
        seed=notes.seed,
    )
    return model_method(model.to(device))


def model_method(model: NormalGAN) -> Method:
    """Return a model as a method; its noise at test time depends only on the samples."""
    model.eval()
    model.keep_noise()

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        devices = [] if batch["sketch"].device.type == "cpu" else [batch["sketch"].device]
        with torch.random.fork_rng(devices), torch.no_grad():
            torch.manual_seed(derive_seed("noise", *batch["name"]))
            predicted = model.predict_with_confidence(batch["sketch"], hints)
        return predicted.float()

    return Method(predict, model.hint_sampler, model.generator)


def saved_method(name: str, size: int, device: torch.device) -> Method:
    """Return a saved model as a method; all file formats of a model give the same figures.

    Args:
        name: path of the file, or ``shipped``.
        size: side of the pictures in pixels.
        device: device of the network; ONNX models run on the CPU.

    Raises:
        InputError: if the file is invalid, or the model was trained at a different size.
    """
    path = find_model(name)
    # The shipped model can run on a GPU, through torch.
    if path.suffix.lower() == ".onnx" and name != SHIPPED_NAME:
        return _onnx_method(path, size)
    if path.suffix.lower() in SUFFIXES:
        weights = read_weights(path)
        check_size(path, weights.notes.size, size)
        return weights_method(weights, device)
    checkpoint = read_checkpoint(path)
    check_size(path, checkpoint.generator_size(), size)
    return weights_method(checkpoint.weights(size), device)


def _onnx_method(path: Path, size: int) -> Method:
    model = OnnxBackend(path, torch.get_num_threads())
    check_size(path, model.size, size)
    if "hint_sampler" not in model.notes:
        raise InputError(f"{path} does not say which hints it was trained with; export it again.")
    sampler = ClassSpec.from_json(model.notes["hint_sampler"]).build(HINT_SAMPLERS)

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        given = [None] * len(batch["sketch"]) if hints is None else list(hints.cpu().numpy())
        sketches = batch["sketch"][:, 0].cpu().numpy()
        predicted = [_channels(*model.predict(*one)) for one in zip(sketches, given, strict=True)]
        return torch.stack(predicted).to(batch["sketch"])

    return Method(predict, sampler)


def _channels(normal: Floats, confidence: Floats | None) -> Tensor:
    """Return normals (S, S, 3) and the optional confidence (S, S) as (3 or 4, S, S)."""
    channels = torch.from_numpy(normal).permute(2, 0, 1)
    return channels if confidence is None else torch.cat([channels, torch.from_numpy(confidence)[None]])
