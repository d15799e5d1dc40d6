"""SavedSettings: a LightningModule whose checkpoints hold classes and settings as text."""

from inspect import signature
from typing import Any

from lightning.pytorch import LightningModule
from lightning.pytorch.utilities.parsing import AttributeDict

from normalgan.weights.checkpoint import PICTURE_SIZE, settings_to_save, uncompiled

__all__ = ["SavedSettings"]


class SavedSettings(LightningModule):
    """Saves the arguments of a module as text, and its weights under the names that they have uncompiled."""

    _picture_size: int | None = None

    @property
    def hparams_initial(self) -> AttributeDict:
        """The hyperparameters that loggers write: classes and settings, in values that any YAML reader knows.

        For objects from Python they would write every weight as text: 8 MB for a million weights.
        """
        settings = settings_to_save(self._given())
        return AttributeDict({k: list(v) if isinstance(v, tuple) else v for k, v in settings.items()})

    def on_save_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Store classes and settings as text, so that reading a checkpoint runs no code from it."""
        checkpoint[self.CHECKPOINT_HYPER_PARAMS_KEY] = settings_to_save(self._given())
        checkpoint["state_dict"] = {uncompiled(k): v for k, v in checkpoint["state_dict"].items()}
        if self._picture_size is not None:
            checkpoint[PICTURE_SIZE] = self._picture_size

    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Name weights as this module does, whose networks may be wrapped by ``torch.compile``."""
        own = {uncompiled(name): name for name in self.state_dict()}
        weights = checkpoint["state_dict"]
        checkpoint["state_dict"] = {own.get(uncompiled(k), k): v for k, v in weights.items()}

    def _given(self) -> dict[str, Any]:
        """Return all arguments of the module; Lightning drops values from ``hparams`` that cannot be pickled.

        Otherwise a run with an optimiser made by a lambda, for example, would continue with the default one.
        """
        dropped = signature(type(self)).parameters.keys() - self.hparams.keys()
        return {**{name: getattr(self, name) for name in dropped if hasattr(self, name)}, **self.hparams}
