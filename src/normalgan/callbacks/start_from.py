"""StartFrom: a run that starts with the weights of another one."""

from pathlib import Path
from typing import Any

from lightning.pytorch import Callback, LightningModule, Trainer
from torch.nn import Module

from normalgan.errors import InputError
from normalgan.models import ResidualUNetGenerator
from normalgan.models.growth import grow
from normalgan.weights.checkpoint import read_checkpoint
from normalgan.weights.file import SHIPPED_NAME, SUFFIX, find_weights, read_weights

__all__ = ["StartFrom"]


class StartFrom(Callback):
    """Gives a new run the generator's weights of another run; everything else, such as the optimiser, is new.

    A resumed run keeps its own weights.

    Args:
        weights: a file of safetensors, a checkpoint, or ``shipped`` for what comes with the package; its
            generator is of the same class and settings as the run's.
        grow: whether the weights are of a smaller network, with half the resolution, fewer channels or fewer
            blocks; see `normalgan.models.growth`.
    """

    def __init__(self, weights: str = SHIPPED_NAME, grow: bool = False) -> None:
        self.weights = weights
        self.grow = grow
        self._resumed = False

    def state_dict(self) -> dict[str, Any]:
        """Return a mark that the run has started, for its checkpoints."""
        return {"begun": True}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Note that the run is resumed."""
        self._resumed = bool(state_dict["begun"])

    def on_fit_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Load the weights, if the run is new.

        Raises:
            InputError: if the file cannot be used, or its generator is another one.
        """
        if self._resumed:
            return
        path = find_weights(self.weights)
        if self.grow:
            _grow(path, pl_module.get_submodule("generator"))
            return
        saved = path.suffix.lower() == SUFFIX
        tensors = read_weights(path).tensors if saved else read_checkpoint(path).generator_tensors()
        network = pl_module.get_submodule("generator")
        own = {name: tensor.shape for name, tensor in network.state_dict().items()}
        if {name: tensor.shape for name, tensor in tensors.items()} != own:
            raise InputError(
                f"StartFrom was given {path}, whose generator is another one than the run's; give both the "
                "same class and settings."
            )
        network.load_state_dict(dict(tensors))


def _grow(path: Path, network: Module) -> None:
    small = read_weights(path).generator()
    if not isinstance(small, ResidualUNetGenerator) or not isinstance(network, ResidualUNetGenerator):
        raise InputError(
            f"StartFrom was given {path} to grow from, but only a ResidualUNetGenerator grows, into another."
        )
    grow(small, network)
