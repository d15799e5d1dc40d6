"""SketchDataset: the user's drawings and hints, prepared for the generator."""

from collections import OrderedDict
from collections.abc import Sequence
from threading import Lock
from typing import TypedDict

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import Dataset

from normalgan.errors import InputError, with_subject
from normalgan.inference.inputs import check_size, prepare_any
from normalgan.inference.jobs.plan import DrawingFiles
from normalgan.inference.parallel import stream
from normalgan.inference.preparation import Prepared
from normalgan.line_widths import USUAL_WIDTHS, LineWidths

_KEPT = 2**29
"""Maximum size of cached prepared drawings in bytes; others are prepared again when needed."""


class SketchSample(TypedDict):
    """A drawing framed for the generator."""

    sketch: Tensor
    """(1, size, size) ink in [0, 1]."""
    hints: Tensor
    """(4, size, size): hint normals and hint mask; zero without hints."""
    name: str
    """File name of the drawing without extension."""


class SketchDataset(Dataset[SketchSample]):
    """Drawings prepared for the generator.

    All drawings are read at the start, so that invalid ones are reported early. If there are several,
    unusable ones are left out, and `unusable` holds the reasons.

    Args:
        files: drawings with their hints and masks, as found by `inference.jobs.plan.find_files`.
        size: side of the generator's pictures.
        longest: longer side of the maps in pixels; None uses the size of the drawing.
        line_widths: minimum and maximum width of lines that are not redrawn, in the generator's pixels.

    Raises:
        InputError: if no drawing can be used with its hints and its mask.
    """

    unusable: list[InputError]
    """The errors of the drawings that were left out."""

    def __init__(
        self,
        files: Sequence[DrawingFiles],
        size: int,
        longest: int | None = None,
        line_widths: LineWidths = USUAL_WIDTHS,
    ) -> None:
        check_size(longest)
        self._size = size
        self._longest = longest
        self._line_widths = line_widths
        self._lock = Lock()
        self._kept: OrderedDict[str, Prepared] = OrderedDict()
        self._by_name = {each.drawing.stem: each for each in files}
        self.files, self.unusable = [], []
        for name, outcome in stream(list(self._by_name), self.prepared):
            if not isinstance(outcome, Exception):
                self.files.append(self._by_name[name])
            elif isinstance(outcome, InputError) and len(files) > 1:
                self.unusable.append(outcome)
            else:
                raise outcome
        if self.unusable and not self.files:
            raise InputError(f"none of the {len(files)} sketches can be used; the first: {self.unusable[0]}")

    def prepared(self, name: str) -> Prepared:
        """Return the drawing with a name, prepared for the generator."""
        with self._lock:
            if name in self._kept:
                self._kept.move_to_end(name)
                return self._kept[name]
        files = self._by_name[name]
        try:
            found = prepare_any(
                files.drawing, self._size, files.hints, files.mask, self._longest, self._line_widths
            )
        except InputError as error:
            raise with_subject(files.drawing, error) from error
        with self._lock:
            self._kept[name] = found
            while len(self._kept) > 1 and sum(map(_bytes, self._kept.values())) > _KEPT:
                self._kept.popitem(last=False)
        return found

    def __len__(self) -> int:
        return len(self.files)

    def __getitem__(self, index: int) -> SketchSample:
        name = self.files[index].drawing.stem
        prepared = self.prepared(name)
        hints = prepared.hints
        if hints is None:
            hints = np.zeros((4, self._size, self._size), np.float32)
        return {
            "sketch": torch.from_numpy(prepared.model_input)[None],
            "hints": torch.from_numpy(hints),
            "name": name,
        }


def _bytes(prepared: Prepared) -> int:
    masks = prepared.mask, prepared.coverage, prepared.alpha
    kept = (prepared.ink, *masks, prepared.model_input, prepared.hints)
    return sum(array.nbytes for array in kept if array is not None)
