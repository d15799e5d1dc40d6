"""Diary: a callback that notes the epochs as they begin, so that a kill can tell how far a run was."""

from pathlib import Path

from lightning.pytorch import Callback, LightningModule, Trainer


class Diary(Callback):
    """Notes each epoch that begins.

    Args:
        path: the file, which is added to.
    """

    def __init__(self, path: str) -> None:
        self.path = path

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Note it; what is written outlives a kill."""
        with Path(self.path).open("a", encoding="utf-8") as file:
            file.write(f"{trainer.current_epoch}\n")


def epochs_before(path: Path) -> int:
    """Return how many whole epochs were done when the last one began; 0 if none did."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    return int(lines[-1]) if lines else 0
