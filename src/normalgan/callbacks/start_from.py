"""StartFrom: initialise a run with the weights of another run."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from lightning.pytorch import Callback, LightningModule, Trainer
from torch import Tensor
from torch.nn import Module

from normalgan.errors import InputError
from normalgan.files.addresses import is_address
from normalgan.models import ResidualUNetGenerator
from normalgan.models.growth import grow
from normalgan.weights.checkpoint import read_checkpoint
from normalgan.weights.file import SUFFIXES, read_weights
from normalgan.weights.shipped import SHIPPED_NAME, find_model


class StartFrom(Callback):
    """Initialises a new run with the generator's weights of another run, but not with its optimisers.

    A resumed run keeps its own weights. Use this callback to continue training with other learning rates,
    because resuming restores the old ones.

    Args:
        weights: safetensors, an exported ONNX file, a checkpoint, or ``shipped`` for the package's own
            weights. The generator must have the same class and settings as that of the run.
        grow: whether the weights belong to a smaller network, with half the resolution, fewer channels or
            fewer blocks; see `normalgan.models.growth`.
        discriminator: whether to load the discriminator's weights too, from a checkpoint.

    Raises:
        InputError: if both ``grow`` and ``discriminator`` are given.
    """

    def __init__(self, weights: str = SHIPPED_NAME, grow: bool = False, discriminator: bool = False) -> None:
        if grow and discriminator:
            raise InputError("StartFrom takes grow or discriminator, not both: only generators grow.")
        self.weights = weights
        self.grow = grow
        self.discriminator = discriminator
        self._resumed = False

    def state_dict(self) -> dict[str, Any]:
        """Return a marker for checkpoints that the run has already started."""
        return {"begun": True}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Remember that the run was resumed."""
        self._resumed = bool(state_dict["begun"])

    def on_fit_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Load the weights if the run is new.

        Raises:
            InputError: if the file cannot be used, or its generator differs from that of the run.
        """
        if self._resumed:
            return
        if is_address(self.weights):  # a configuration file must not trigger downloads
            raise InputError(f"StartFrom takes a file, not the address {self.weights}; fetch it first.")
        path = find_model(self.weights)
        if self.grow:
            _grow(path, pl_module.get_submodule("generator"))
            return
        saved = path.suffix.lower() in SUFFIXES
        if self.discriminator and saved:
            raise InputError(
                f"{path} holds a generator alone; StartFrom takes a discriminator of a checkpoint."
            )
        if saved:
            weights = read_weights(path)
            _load(path, "generator", weights.tensors, pl_module, weights.notes.generator.to_dict())
            return
        checkpoint = read_checkpoint(path)
        for name in ("generator", "discriminator") if self.discriminator else ("generator",):
            _load(path, name, checkpoint.tensors_of(name), pl_module, checkpoint.settings.get(name))


def _load(
    path: Path, name: str, tensors: Mapping[str, Tensor], model: LightningModule, settings: object
) -> None:
    """Load the weights of a network with these settings into the network of a run.

    Raises:
        InputError: if the networks differ; the message has the settings as they are written in YAML.
    """
    network: Module | None = getattr(model, name)
    own = {key: tensor.shape for key, tensor in network.state_dict().items()} if network else None
    if network is None or {key: tensor.shape for key, tensor in tensors.items()} != own:
        known = isinstance(settings, Mapping) and "class_path" in settings
        written = yaml.safe_dump({name: settings}, default_flow_style=True, sort_keys=False, width=10_000)
        its = f": model: {written.strip()}" if known else "."
        raise InputError(
            f"StartFrom was given {path}, whose {name} is another one than the run's; give both the same "
            f"class and settings{its}"
        )
    network.load_state_dict(dict(tensors))


def _grow(path: Path, network: Module) -> None:
    small = read_weights(path).generator()
    if not isinstance(small, ResidualUNetGenerator) or not isinstance(network, ResidualUNetGenerator):
        raise InputError(
            f"StartFrom was given {path} to grow from, but only a ResidualUNetGenerator grows, into another."
        )
    grow(small, network)
