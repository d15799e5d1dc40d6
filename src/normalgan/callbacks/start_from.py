"""StartFrom: initialise a run with the weights of another run."""

import warnings
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
from normalgan.registry import Registry
from normalgan.weights.checkpoint import REGISTRIES, read_checkpoint
from normalgan.weights.class_spec import ANY_NUMBER, ClassSpec
from normalgan.weights.file import SUFFIXES, read_weights
from normalgan.weights.network import naming_model
from normalgan.weights.shipped import SHIPPED_NAME, find_model


class StartFrom(Callback):
    """Initialises a new run with the generator's weights of another run, but not with its optimisers.

    A resumed run keeps its own weights. Use this callback to continue training with other learning rates,
    because resuming restores the old ones.

    Args:
        weights: safetensors, an exported ONNX file, a checkpoint, or ``shipped`` for the package's own
            weights. The generator must have the same class as that of the run, and weights of the same
            shapes; settings that differ are warned about.
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
    saved = None
    if isinstance(settings, Mapping) and "class_path" in settings:
        with naming_model(path):
            saved = ClassSpec.of(settings, ANY_NUMBER)
    own = {key: tensor.shape for key, tensor in network.state_dict().items()} if network else None
    fits = {key: tensor.shape for key, tensor in tensors.items()} == own
    if network is None or not fits or (saved and not _is_of(network, saved, REGISTRIES[name][0])):
        its = "."
        if saved:
            written = yaml.safe_dump({name: settings}, default_flow_style=True, sort_keys=False, width=10_000)
            its = f": model: {written.strip()}"
        raise InputError(
            f"StartFrom was given {path}, whose {name} is another one than the run's; give both the same "
            f"class and settings{its}"
        )
    if saved and (other := _other_settings(network, saved)):
        warnings.warn(f"StartFrom: the {name} in {path} was trained with {other}.", stacklevel=2)
    network.load_state_dict(dict(tensors))


def _is_of(network: Module, saved: ClassSpec, registry: Registry[Any]) -> bool:
    """Return whether a network has the class that a file names; a class not found here is known by name."""
    found = registry.find(saved.name)
    return type(network) is found if found else type(network).__name__ == saved.name.rpartition(".")[2]


def _other_settings(network: Module, saved: ClassSpec) -> str:
    """Return the saved settings that the network does not have, with both values."""
    own = ClassSpec.of_object(network)
    settings = own.settings if own else {}
    return ", ".join(
        f"{key} {value} (the run has {settings[key]})"
        for key, value in saved.settings.items()
        if key in settings and settings[key] != value
    )


def _grow(path: Path, network: Module) -> None:
    small = read_weights(path).generator()
    if not isinstance(small, ResidualUNetGenerator) or not isinstance(network, ResidualUNetGenerator):
        raise InputError(
            f"StartFrom was given {path} to grow from, but only a ResidualUNetGenerator grows, into another."
        )
    grow(small, network)
