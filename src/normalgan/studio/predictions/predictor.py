"""DrawingPredictor: the studio's model with a cache of recent predictions."""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from threading import Lock
from typing import TypeVar

import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError, RunError
from normalgan.inference.cleaning.reader import Reading, read
from normalgan.inference.composites.layer_context import Context, Inferred, context_of, surest, ways_to_see
from normalgan.inference.findings import Finding
from normalgan.inference.mask.mask_files import READER
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.network.upsampling import Coarse
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.pipeline import finish
from normalgan.inference.preparation import Prepared, hinted, prepare
from normalgan.inference.reading.picture import Picture
from normalgan.studio.drawings.drawing_request import DrawingRequest
from normalgan.studio.predictions.figures import several_figures

K = TypeVar("K")
T = TypeVar("T")

_REMEMBERED = 2**24
"""Maximum number of pixels of all cached maps. A map is requested again for its heights or its export, and if
a drawing has several layers, only the edited one changes. The limit allows four of the largest drawings, each
of which may take 80 MB. The newest two are always kept.

The same limit applies to prepared drawings, which are reused while only the hints change.
"""
_VERSIONS = 4
"""Cached maps per layer: at half and full size, before and after the last stroke."""
_Key = tuple[bytes, int | None]
"""Digest of the drawing, and the map's longer side."""
_Found = tuple[Prepared, tuple[int, int], tuple[Finding, ...]]
"""A prepared drawing, its (H, W), and the finding about separate figures."""
_CONTEXTS = 16
"""Maximum number of cached contexts, and of the network's predictions for them."""


class DrawingPredictor:
    """Predicts drawings with a model.

    Args:
        path: file that `normalgan export` wrote.

    Raises:
        InputError: if the file is not such a model.
    """

    def __init__(self, path: Path) -> None:
        self.model = OnnxBackend(path)
        self.name = path.name
        # The first run is slow, so it is done before the user draws.
        _, confidence = self.model.predict(np.zeros((self.model.size, self.model.size), np.float32))
        read(Picture(np.ones((64, 64, 3), np.float32), None))
        self.confident = confidence is not None
        """Whether the model predicts a confidence."""
        self._lock = Lock()
        self._predicted: OrderedDict[tuple[_Key, bytes], NormalMap] = OrderedDict()
        self._prepared: OrderedDict[_Key, _Found] = OrderedDict()
        self._readings: OrderedDict[bytes, Reading] = OrderedDict()
        self._network = ThreadPoolExecutor(1, "network")
        self._inferred: OrderedDict[bytes, Future[Inferred]] = OrderedDict()
        self._contexts: OrderedDict[tuple[_Key, ...], Context] = OrderedDict()

    def predict(
        self,
        drawing: DrawingRequest,
        parts: Sequence[DrawingRequest],
        longest: int | None,
        check: Callable[[], None],
        *,
        any_context: bool = False,
    ) -> NormalMap:
        """Return the normal map of a drawing. Thread-safe.

        Args:
            drawing: the drawing.
            parts: all parts that the network sees together, back to front, including the drawing itself;
                empty if it is alone.
            longest: longer side of the map in pixels; None keeps the drawing's size.
            check: called between the steps; an exception from it ends the prediction.
            any_context: whether a map that was predicted with older versions of the other parts is accepted.

        Raises:
            InputError: if the drawing is invalid.
        """
        key = drawing.digest(), longest
        if any_context:
            with self._lock:
                around = next((around for each, around in reversed(self._predicted) if each == key), None)
            earlier = None if around is None else self._recalled(self._predicted, (key, around))
            if earlier is not None:
                return earlier
        context = self._context(parts, longest, check)
        around = sha256(b"" if context is None else context.model_input.tobytes()).digest()
        predicted = self._recalled(self._predicted, (key, around))
        if predicted is None:

            def upsample(coarse: Coarse, prepared: Prepared, mask: BoolMask) -> Floats:
                check()
                return self.model.upsample(coarse, prepared, mask)

            check()
            layers = max(len(parts), 1)
            prepared, shape, several = self._prepare(drawing, longest, check, layers)
            check()
            ways = ways_to_see(prepared, context)
            hints = drawing.read_hints(shape)
            seen, preds, confidence = surest(
                [hinted(each, hints, shape) for each in ways], lambda way: self._infer(way).result()
            )
            predicted = finish(seen, preds, confidence, upsample)
            # Among other layers it is a part of something, and may be in pieces.
            findings = predicted.findings if parts else (*predicted.findings, *several)
            edited = drawing.edit(predicted.extended, predicted.mask, shape)
            predicted = replace(predicted, extended=edited, findings=findings)
            self._remember(self._predicted, (key, around), predicted, _VERSIONS * layers, _size_of_map)
        return predicted

    def _infer(self, prepared: Prepared) -> "Future[Inferred]":
        """Return a future of the network's prediction; layers without hints in the same context share it."""
        shown = sha256(prepared.model_input.tobytes())
        if prepared.hints is not None:
            shown.update(prepared.hints.tobytes())
        key = shown.digest()
        found = self._recalled(self._inferred, key)
        if found is None or (found.done() and found.exception() is not None):
            found = self._network.submit(self.model.predict, prepared.model_input, prepared.hints)
            self._remember(self._inferred, key, found, _CONTEXTS)
        return found

    def _context(
        self, parts: Sequence[DrawingRequest], longest: int | None, check: Callable[[], None]
    ) -> Context | None:
        """Return the context of all parts of a drawing; None if fewer than two parts can be prepared."""
        if len(parts) < 2:
            return None
        seen = []
        for part in parts:
            try:
                seen.append((part, self._prepare(part, longest, check, len(parts))[0]))
            except InputError as error:
                if isinstance(error, RunError):
                    raise
        # Parts of different sizes are refused later.
        if len(seen) < 2 or len({prepared.ink.shape for _, prepared in seen}) > 1:
            return None
        key = tuple((part.lines_digest(), longest) for part, _ in seen)
        found = self._recalled(self._contexts, key)
        if found is None:
            found = context_of([prepared for _, prepared in seen])
            self._remember(self._contexts, key, found, _CONTEXTS)
        return found

    def _prepare(
        self, drawing: DrawingRequest, longest: int | None, check: Callable[[], None], layers: int
    ) -> _Found:
        """Return a layer prepared without hints, its (H, W), and the finding if it shows separate figures.

        ``layers`` is the number of layers.

        The network already runs while the mask is found.
        """
        key = drawing.lines_digest(), longest
        found = self._recalled(self._prepared, key)
        if found is None:
            picture, mask = drawing.read_lines()
            reader = partial(self._read, drawing)
            reading = None if drawing.drawn else reader(picture)
            by_hand = drawing.read_mask(picture, reading)
            hints = drawing.read_hints(picture.shape)

            def infer_ahead(prepared: Prepared) -> None:
                check()
                self._infer(hinted(prepared, hints, picture.shape))

            prepared = prepare(
                *(picture, self.model.size, mask, None, longest, by_hand),
                line_widths=self.model.line_widths,
                clean_strokes=drawing.drawn,
                reading=reading,
                on_model_input=infer_ahead,
                reader=reader,
            )
            several = several_figures(prepared, picture) if drawing.mask in {None, READER} else ()
            # The decision takes more memory than everything else and is not needed again.
            found = replace(prepared, decision=None, reading=None), picture.shape, several
            self._remember(self._prepared, key, found, _VERSIONS * layers, _size_of_prepared)
        return found

    def _read(self, drawing: DrawingRequest, picture: Picture) -> Reading:
        """Return the reader's output for a drawing's picture; all sizes and edits of the drawing share it."""
        key = drawing.picture_digest
        found = self._recalled(self._readings, key)
        if found is None:
            found = read(picture)
            self._remember(self._readings, key, found, _VERSIONS)
        return found

    def _recalled(self, kept: OrderedDict[K, T], key: K) -> T | None:
        with self._lock:
            if key not in kept:
                return None
            kept.move_to_end(key)
            return kept[key]

    def _remember(
        self, kept: OrderedDict[K, T], key: K, value: T, most: int, pixels: Callable[[T], int] = lambda _: 0
    ) -> None:
        """Cache a value; drop the oldest ones beyond ``most`` values or `_REMEMBERED` pixels in total."""
        with self._lock:
            kept[key] = value
            while len(kept) > most or (len(kept) > 2 and sum(map(pixels, kept.values())) > _REMEMBERED):
                kept.popitem(last=False)


def _size_of_map(predicted: NormalMap) -> int:
    return predicted.mask.size


def _size_of_prepared(found: _Found) -> int:
    return max(found[0].ink.size, found[0].shape[0] * found[0].shape[1])
