"""Painting a job: a file of whatever kind, one drawing or many, to what is written for it."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from normalgan.drawings import read_pixels
from normalgan.painting.inputs import as_hints
from normalgan.painting.jobs import DrawingFiles, Job
from normalgan.painting.masks import load_mask
from normalgan.painting.normal_map import NormalMap
from normalgan.painting.outputs import Outputs
from normalgan.painting.packing import Packing
from normalgan.painting.painter import Painter
from normalgan.painting.picture import read_picture, resize
from normalgan.painting.preparation import Mark
from normalgan.painting.sheets import paint_sheet


@dataclass(frozen=True)
class JobPainter:
    """Paints what a job names and writes what belongs to it. It may be called by several threads.

    Args:
        painter: the network.
        outputs: what is written.
        size: longer side of the maps in pixels; None is the drawing's.
        packing: how the drawings of a sheet are found.
        shared: show the network the same square of all the drawings of one file.
    """

    painter: Painter
    outputs: Outputs
    size: int | None = None
    packing: Packing = field(default_factory=Packing)
    shared: bool = False

    def __call__(self, job: Job) -> str:
        """Paint and write one job, and return what is to be said of it; empty if nothing is.

        Raises:
            InputError: if the drawing cannot be used.
            OSError: if a file cannot be written.
        """
        preds = self._sheet(job.files) if self.packing.given else self._drawing(job.files)
        self.outputs.write(job, preds)
        return preds.warning

    def _drawing(self, files: DrawingFiles) -> NormalMap:
        picture = read_picture(files.drawing, files.content, self.size)
        return self.painter(picture, files.hints, files.mask, self.size)

    def _sheet(self, files: DrawingFiles) -> NormalMap:
        sheet = read_pixels(files.drawing, files.content)
        mask: Mark | str | None = None
        if isinstance(files.mask, Path):
            mask = resize(load_mask(files.mask, sheet.shape).astype(np.float32), sheet.shape) > 0.5
        else:
            mask = files.mask
        hints = as_hints(files.hints, sheet.shape)
        cells = self.packing.cells(sheet, files.drawing)
        return paint_sheet(self.painter, sheet, cells, hints, mask, self.shared)
