"""A script: fits, validates and tests as one of several processes, and writes down what it ended with.

Its arguments are the number of processes and the folders of meshes, samples and results.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import torch
import yaml
from lightning.pytorch import Callback, LightningModule, Trainer
from torch import Tensor

from normalgan.callbacks import TestReport, WarmAverage
from normalgan.data.datamodule import MeshDataModule
from normalgan.gan import NormalGAN
from normalgan.hints.base import HintSampler
from small import data, gan, trainer

SEEDS: list[int] = []
"""Those the sampler was called with in training; to measure, it is called for one sample at a time."""


@dataclass(frozen=True)
class Lattice(HintSampler):
    """Hints every fourth pixel of the object, whatever the seed, and notes that."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        if len(normal) > 1:
            SEEDS.append(rng.initial_seed())
        where = torch.zeros_like(mask)
        where[..., ::4, ::4] = mask[..., ::4, ::4]
        return where


class Measured(Callback):
    """Notes the network that is measured: the average of the weights, with its statistics of batch norm."""

    def __init__(self) -> None:
        self.networks: list[dict[str, Tensor]] = []

    def on_validation_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        self.networks.append({})

    def on_validation_batch_start(self, trainer: Trainer, pl_module: LightningModule, *_: object) -> None:
        self.networks[-1] = {name: value.clone() for name, value in pl_module.state_dict().items()}


def model() -> NormalGAN:
    """The network that is trained."""
    return gan(hint_sampler=Lattice())


def samples(meshes: Path, cache: Path) -> MeshDataModule:
    """Twelve samples to train on, five to validate and five to test: they do not divide."""
    return data(meshes, cache, train_views=4, val_views=5, test_views=5)


def main(processes: int, meshes: Path, cache: Path, results: Path) -> None:
    """Fit, validate and test."""
    overlay = yaml.safe_load((Path(__file__).parents[1] / "configs" / "ddp.yaml").read_text())["trainer"]
    measured = Measured()
    run = trainer(
        results,
        **(overlay | {"devices": processes}),
        max_epochs=2,
        callbacks=[TestReport(samples=2), WarmAverage(0.5), measured],
    )
    network, module = model(), samples(meshes, cache)
    before = {name: value.clone() for name, value in network.state_dict().items()}
    run.fit(network, module)
    after = {name: value.clone() for name, value in network.state_dict().items()}
    seeds, networks = list(SEEDS), list(measured.networks)
    (val,) = run.validate(network, module, verbose=False)
    (test,) = run.test(network, module, verbose=False)
    torch.save(
        {"before": before, "after": after, "seeds": seeds, "val": val, "test": test, "measured": networks},
        results / f"{run.global_rank}.pt",
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), *(Path(argument) for argument in sys.argv[2:]))
