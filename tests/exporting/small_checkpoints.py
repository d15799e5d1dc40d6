"""Checkpoints as `normalgan fit` leaves them, without training."""

from pathlib import Path
from typing import Any

import torch

from normalgan.models import Generator, ResidualUNetGenerator, UNetGenerator

UNET: dict[str, Any] = {"size": 32, "width": 4}
RESIDUAL: dict[str, Any] = {"widths": [8, 8, 16], "blocks": [1, 1, 1], "patch": 2, "mirror": True}


def make_generator(kind: str) -> Generator:
    """A small generator whose weights and statistics are not those of a new one."""
    torch.manual_seed(0)
    generator: Generator = (
        UNetGenerator(**UNET) if kind == "UNetGenerator" else ResidualUNetGenerator(**_tuples(RESIDUAL))
    )
    for parameter in generator.parameters():
        torch.nn.init.normal_(parameter, std=0.2)
    for buffer in generator.buffers():
        if buffer.is_floating_point():
            buffer.copy_(torch.rand_like(buffer) + 0.5)  # means and variances of batch norm
    return generator


def save(path: Path, kind: str) -> Generator:
    """Write a checkpoint, and return the generator in it."""
    generator = make_generator(kind)
    arguments = UNET if kind == "UNetGenerator" else RESIDUAL
    return save_generator(path, generator, f"normalgan.models.{kind}", arguments)


def save_generator(path: Path, generator: Generator, name: str, arguments: dict[str, Any]) -> Generator:
    """Write a checkpoint of a generator, by the name and the arguments of its class, and return it."""
    state = {f"generator.{name}": tensor for name, tensor in generator.state_dict().items()}
    torch.save(
        {
            "pytorch-lightning_version": "2.6.0",
            "state_dict": state,
            "hparams_name": "kwargs",
            "hyper_parameters": {
                "generator": {"class_path": name, "init_args": arguments},
                "discriminator": None,
                "hint_sampler": {"class_path": "normalgan.hints.UniformHints", "init_args": {}},
                "objective": {"class_path": "normalgan.losses.Wasserstein", "init_args": {}},
                "_instantiator": "lightning.pytorch.cli.instantiate_module",
            },
        },
        path,
    )
    return generator.eval()


def _tuples(arguments: dict[str, Any]) -> dict[str, Any]:
    return {k: tuple(v) if isinstance(v, list) else v for k, v in arguments.items()}
