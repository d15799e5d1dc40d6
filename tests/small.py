"""Data, networks and trainers that take next to no time: five simple meshes at 32 pixels."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch import Trainer

from normalgan.data.datamodule import MeshDataModule
from normalgan.data.recipe import Loadable
from normalgan.data.settings import Split, Storage
from normalgan.gan import NormalGAN
from normalgan.hints import UniformHints
from normalgan.losses import Wasserstein
from normalgan.models import UNetDiscriminator, UNetGenerator
from normalgan.rendering.lines.contours import OccludingContours

torch.set_num_threads(1)  # networks this small are slower with more

# What Lightning says of settings that are meant: no workers for ten samples, few batches.
QUIET = (
    "ignore:.*does not have many workers.*",
    "ignore:.*smaller than the logging interval.*",
    "ignore:.*LeafSpec.*is deprecated.*",
)


def data(meshes: Path, cache: Path, **settings: Any) -> MeshDataModule:
    """Three meshes to train on, one to validate and one to test: six, two and two samples."""
    defaults: dict[str, Any] = {
        "split": Split((0.6, 0.2, 0.2)),
        "lines": OccludingContours(resolution=64),
        "size": 32,
        "train_views": 2,
        "val_views": 2,
        "test_views": 2,
        "storage": Storage(render_workers=0),
        "batch_size": 2,
    }
    return MeshDataModule(str(meshes), cache=str(cache), **(defaults | settings))


def names(sources: Sequence[Loadable]) -> list[str]:
    """Return the names of the sources of a split."""
    return [source.name for source in sources]


def gan(**settings: Any) -> NormalGAN:
    """The paper's parts, four channels wide; the same weights every time."""
    torch.manual_seed(0)
    defaults: dict[str, Any] = {
        "generator": UNetGenerator(size=32, width=4),
        "discriminator": UNetDiscriminator(size=32, width=4),
        "hint_sampler": UniformHints(3, 3),
        "objective": Wasserstein(),
        "n_critic": 1,
    }
    return NormalGAN(**(defaults | settings))


def trainer(folder: Path, **settings: Any) -> Trainer:
    """A trainer on the CPU that shows nothing and writes nothing of its own."""
    defaults: dict[str, Any] = {
        "accelerator": "cpu",
        "default_root_dir": folder,
        "logger": False,
        "enable_checkpointing": False,
        "enable_progress_bar": False,
        "enable_model_summary": False,
        "max_epochs": 1,
    }
    return Trainer(**(defaults | settings))
