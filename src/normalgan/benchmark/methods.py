"""Method: anything that predicts normal maps, trained or not."""

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from normalgan.batch import Batch
from normalgan.benchmark.inflation import inflated_normals
from normalgan.gan import NormalGAN
from normalgan.hints import HintSampler, NoHints
from normalgan.losses import Wasserstein
from normalgan.seeds import derive_seed
from normalgan.weights.file import Weights

__all__ = [
    "Method",
    "Paint",
    "constant_method",
    "inflation_method",
    "mean_method",
    "model_method",
    "weights_method",
]

Paint = Callable[[Batch, Tensor | None], Tensor]
"""From a batch and hints (N, 4, H, W), or none, to normals (N, 3, H, W), or with confidence (N, 4, H, W)."""


@dataclass(frozen=True)
class Method:
    """A method and its properties.

    Args:
        predict: predicts a batch; it must not look at the truth, but for what is told of a classical method.
        sampler: gives the hints that it was trained for.
        generator: its network; None if it has none.
        timed: whether it predicts here, so that its speed can be measured; what another program predicted is
            only read.
    """

    predict: Paint
    sampler: HintSampler = NoHints()  # noqa: RUF009  # frozen
    generator: nn.Module | None = None
    timed: bool = True

    @property
    def takes_hints(self) -> bool:
        """Whether it was made to be given hints; one that was not is given none."""
        return not isinstance(self.sampler, NoHints)


def constant_method() -> Method:
    """Return the method whose normals all face the viewer."""
    facing = torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1)
    return Method(lambda batch, hints: facing.to(batch["normal"]).expand_as(batch["normal"]))


def mean_method(mean_map: Tensor) -> Method:
    """Return the method that always predicts the mean map (3, H, W) of the training split."""
    return Method(lambda batch, hints: mean_map.to(batch["normal"]).expand_as(batch["normal"]))


def inflation_method() -> Method:
    """Return the method that inflates the true mask, which no other method sees."""

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        masks = batch["mask"][:, 0].cpu().numpy() > 0.5
        normals = [torch.from_numpy(inflated_normals(mask)).permute(2, 0, 1) for mask in masks]
        return torch.stack(normals).to(batch["normal"])

    return Method(predict)


def weights_method(weights: Weights, device: torch.device) -> Method:
    """Return the model of a weights file, in float32, ready to predict."""
    notes = weights.notes
    model = NormalGAN(
        generator=weights.generator(),
        discriminator=None,
        hint_sampler=notes.build_hint_sampler(),
        objective=Wasserstein(),  # nothing is learnt
        noise_at_test=notes.noise_at_test,
        seed=notes.seed,
    )
    return model_method(model.to(device))


def model_method(model: NormalGAN) -> Method:
    """Return a model as a method; noise at test time depends on the samples alone."""
    model.eval()
    if model.noise_at_test:
        for module in model.generator.modules():
            if isinstance(module, nn.Dropout):
                module.train()

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        devices = [] if batch["sketch"].device.type == "cpu" else [batch["sketch"].device]
        with torch.random.fork_rng(devices), torch.no_grad():
            torch.manual_seed(derive_seed("noise", *batch["name"]))
            predicted = model.predict_with_confidence(batch["sketch"], hints)
        return predicted.float()

    return Method(predict, model.hint_sampler, model.generator)
