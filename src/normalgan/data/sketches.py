"""SketchDataset: the user's own drawings, and the hints painted for them, as the generator takes them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import Dataset

from normalgan.batch import Sketches
from normalgan.drawings import find_drawings, read_drawing, read_hints
from normalgan.errors import InputError
from normalgan.framing import Frame


class SketchSample(TypedDict):
    """One framed drawing."""

    sketch: Tensor
    """(1, size, size) ink in [0, 1]."""
    hints: Tensor
    """(4, size, size) normals at the hints and where they are; all zero without hints."""
    name: str
    """File name of the drawing, without suffix."""


class SketchDataset(Dataset[SketchSample]):
    """Drawings framed for the model. All are read at once, so that a bad one stops nothing half-way.

    Args:
        source: a folder, a glob or a list of drawings.
        size: side of the model's pictures.
        hints: folder of hint pictures, ``<name>_hints.png`` or ``<name>.png`` for a drawing ``<name>.*``.

    Raises:
        InputError: if a drawing or its hints cannot be used, or no drawing is found.
    """

    def __init__(self, source: str | Sequence[str], size: int, hints: str | None = None) -> None:
        self.paths = find_drawings(source)
        self.size = size
        if hints is not None and not Path(hints).is_dir():
            raise InputError(f"there is no folder of hints {hints}.")
        self._hint_files = [hint_file(path, hints) for path in self.paths]
        if hints is not None and not any(self._hint_files):
            raise InputError(f"{hints} holds no hints for any sketch; they are named <sketch>_hints.png.")
        drawings = [read_drawing(path) for path in self.paths]
        self.frames = {
            path.stem: Frame.around(ink, size) for path, ink in zip(self.paths, drawings, strict=True)
        }
        self._samples = [self._frame(i, ink) for i, ink in enumerate(drawings)]

    def _frame(self, index: int, ink: np.ndarray[tuple[int, ...], np.dtype[np.float32]]) -> SketchSample:
        name = self.paths[index].stem
        frame, hint_path = self.frames[name], self._hint_files[index]
        hints = np.zeros((4, self.size, self.size), np.float32)
        if hint_path is not None:
            hints = frame.cut_hints(*read_hints(hint_path, (ink.shape[0], ink.shape[1])))
        return {
            "sketch": torch.from_numpy(frame.cut(ink))[None],
            "hints": torch.from_numpy(hints),
            "name": name,
        }

    def __len__(self) -> int:
        return len(self._samples)

    def __getitem__(self, index: int) -> SketchSample:
        return self._samples[index]


def hint_file(drawing: Path, folder: str | None) -> Path | None:
    """Return the picture of hints for a drawing, if the folder has one."""
    if folder is None:
        return None
    candidates = [Path(folder) / f"{drawing.stem}{ending}" for ending in ("_hints.png", ".png")]
    # Hints may lie beside their drawings; the drawing itself is not its own hints.
    return next((c for c in candidates if c.is_file() and c.resolve() != drawing.resolve()), None)


def collate_sketches(samples: Sequence[SketchSample]) -> Sketches:
    """Stack framed drawings into a batch."""
    return {
        "sketch": torch.stack([s["sketch"] for s in samples]),
        "hints": torch.stack([s["hints"] for s in samples]),
        "name": [s["name"] for s in samples],
    }
