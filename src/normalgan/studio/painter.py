"""Painter: the model at work for the studio; what was painted last is remembered."""

from collections import OrderedDict
from pathlib import Path
from threading import Lock

import numpy as np

from normalgan.painting.painting import Painted, paint
from normalgan.painting.preparation import prepare
from normalgan.painting.session import Model
from normalgan.studio.drawing import Drawing

_REMEMBERED = 2
"""Maps that are kept: a map, and its heights or its export, are asked for in turn. One may take 80 MB."""


class Painter:
    """Paints drawings with a model.

    Args:
        path: file that `normalgan export` wrote.

    Raises:
        InputError: if it is no such file.
    """

    def __init__(self, path: Path) -> None:
        self.model = Model(path)
        self.name = path.name
        # The first run is slow; nobody shall wait for it while drawing.
        _, confidence = self.model.paint(np.zeros((self.model.size, self.model.size), np.float32))
        self.confident = confidence is not None
        """Whether the model says how sure it is."""
        self._lock = Lock()
        self._painted: OrderedDict[tuple[bytes, int | None], Painted] = OrderedDict()

    def paint(self, drawing: Drawing, longest: int | None = None) -> Painted:
        """Return the normal map of a drawing; it may be called by several threads.

        Args:
            drawing: the drawing.
            longest: longer side of the map in pixels; None is the drawing's own.

        Raises:
            InputError: if the drawing cannot be used.
        """
        key = drawing.digest(), longest
        with self._lock:
            if key in self._painted:
                self._painted.move_to_end(key)
                return self._painted[key]
        picture, hints, mask = drawing.read()
        painted = paint(self.model, prepare(picture, self.model.size, mask, hints, longest, drawing.source))
        with self._lock:
            self._painted[key] = painted
            while len(self._painted) > _REMEMBERED:
                self._painted.popitem(last=False)
        return painted
