"""Painter: the model at work for the studio; what was painted last is remembered."""

from collections import OrderedDict
from dataclasses import replace
from pathlib import Path
from threading import Lock
from typing import TypeVar

import numpy as np

from normalgan.painting.normal_map import NormalMap
from normalgan.painting.onnx_backend import OnnxBackend
from normalgan.painting.pipeline import paint
from normalgan.painting.preparation import Prepared, hinted, prepare
from normalgan.studio.drawing import Drawing

T = TypeVar("T")

_REMEMBERED = 2
"""Maps that are kept: a map, and its heights or its export, are asked for in turn. One may take 80 MB.

As many drawings are kept prepared: while a pin is turned, nothing but the hints changes.
"""
_Key = tuple[bytes, int | None]


class Painter:
    """Paints drawings with a model.

    Args:
        path: file that `normalgan export` wrote.

    Raises:
        InputError: if it is no such file.
    """

    def __init__(self, path: Path) -> None:
        self.model = OnnxBackend(path)
        self.name = path.name
        # The first run is slow; nobody shall wait for it while drawing.
        _, confidence = self.model.paint(np.zeros((self.model.size, self.model.size), np.float32))
        self.confident = confidence is not None
        """Whether the model says how sure it is."""
        self._lock = Lock()
        self._painted: OrderedDict[_Key, NormalMap] = OrderedDict()
        self._prepared: OrderedDict[_Key, tuple[Prepared, tuple[int, int]]] = OrderedDict()

    def paint(self, drawing: Drawing, longest: int | None = None) -> NormalMap:
        """Return the normal map of a drawing; it may be called by several threads.

        Args:
            drawing: the drawing.
            longest: longer side of the map in pixels; None is the drawing's own.

        Raises:
            InputError: if the drawing cannot be used.
        """
        key = drawing.digest(), longest
        painted = self._recalled(self._painted, key)
        if painted is None:
            prepared, shape = self._prepare(drawing, longest)
            painted = paint(self.model, hinted(prepared, drawing.read_hints(shape), shape))
            painted = replace(painted, extended=drawing.edit(painted.extended, painted.mask, shape))
            self._remember(self._painted, key, painted)
        return painted

    def _prepare(self, drawing: Drawing, longest: int | None) -> tuple[Prepared, tuple[int, int]]:
        """Return a drawing without its hints as `prepare` gives it, and its own (H, W)."""
        key = drawing.lines_digest(), longest
        found = self._recalled(self._prepared, key)
        if found is None:
            picture, mask = drawing.read_lines()
            prepared = prepare(picture, self.model.size, mask, None, longest, drawing.source)
            found = prepared, picture.shape
            self._remember(self._prepared, key, found)
        return found

    def _recalled(self, kept: OrderedDict[_Key, T], key: _Key) -> T | None:
        with self._lock:
            if key not in kept:
                return None
            kept.move_to_end(key)
            return kept[key]

    def _remember(self, kept: OrderedDict[_Key, T], key: _Key, value: T) -> None:
        with self._lock:
            kept[key] = value
            while len(kept) > _REMEMBERED:
                kept.popitem(last=False)
