"""Upsampling: enlarge a predicted map to the drawing's size, and refine it with the drawing's lines."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.network.extension import extend
from normalgan.inference.preparation import Prepared
from normalgan.inference.regions import around, depth_of
from normalgan.weights.shipped import REFINER

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

CELL = 4
"""Sides of the refiner's input are multiples of this number of pixels."""
RIM = 16
"""Maximum distance from the silhouette, in pixels, that the refiner's input distinguishes."""
_ENLARGED = 1.2
"""Minimum scale, in pixels per pixel of the model, at which maps are refined."""
_LARGEST = 4.0
"""Maximum scale of the refiner's input, in pixels per pixel of the model; larger maps are interpolated."""


@dataclass(frozen=True)
class Coarse:
    """The network's prediction at its own size.

    Args:
        normals: (S, S, 3), unit normals; zero where the network predicted nothing.
        known: (S, S), mask of the reliable normals; at least one pixel is True.
        needed: (S, S), mask of the object.
    """

    normals: Floats
    known: BoolMask
    needed: BoolMask


class Upsampler(Protocol):
    """Enlarges predictions to the drawing's size; `pipeline.predict` accepts a custom one."""

    def __call__(self, coarse: Coarse, prepared: Prepared, mask: BoolMask) -> Floats:
        """Return normals (h, w, 3), of any length, aligned with ``prepared.ink``.

        Args:
            coarse: the prediction in the square ``prepared.frame``.
            prepared: the prepared drawing.
            mask: (h, w), the object; not empty. Normals off the object only matter for blending at its edge.
        """
        ...


def enlarge(coarse: Coarse, prepared: Prepared, mask: BoolMask) -> Floats:
    """An `Upsampler` that fills missing normals and interpolates."""
    return prepared.frame.restore(extend(coarse.normals, coarse.known, coarse.needed))


class Refiner:
    """An `Upsampler` that refines the enlarged normals with a small network.

    Interpolation blends the two sides of a line and misses the rim, where a surface turns away within one
    pixel of the model. At the drawing's size, the refiner sees the enlarged normals, the lines, the mask and
    the distance from the silhouette, and predicts the correction. It is loaded on first use.

    Args:
        path: network written by ``tools/quantize.py``.
        threads: number of threads per run; 0 uses all cores.
    """

    def __init__(self, path: Path = REFINER, threads: int = 1) -> None:
        self._path, self._threads = path, threads

    @cached_property
    def _session(self) -> "InferenceSession":
        import onnxruntime  # imported here because it starts threads, which training does not need

        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = self._threads
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")  # as in OnnxBackend
        # Shares the arena of an ONNX generator, because the two run one after the other.
        options.add_session_config_entry("session.use_env_allocators", "1")
        return onnxruntime.InferenceSession(self._path, options, providers=["CPUExecutionProvider"])

    def __call__(self, coarse: Coarse, prepared: Prepared, mask: BoolMask) -> Floats:
        """Return refined normals (h, w, 3); see `Upsampler`."""
        normals = enlarge(coarse, prepared, mask)
        scale = prepared.frame.side / prepared.frame.size
        if scale <= _ENLARGED:
            return normals
        box = around(mask, round(2 * scale))
        normals[box] = self._refined(normals[box], prepared.ink[box], mask[box], min(_LARGEST / scale, 1))
        return normals

    def _refined(self, normals: Floats, ink: Floats, mask: BoolMask, factor: float) -> Floats:
        """Return enlarged normals (H, W, 3) refined at ``factor`` times their size."""
        h, w = mask.shape
        if factor < 1:
            shape = (max(round(w * factor), 1), max(round(h * factor), 1))
            normals = np.asarray(cv2.resize(normals, shape, interpolation=cv2.INTER_AREA), np.float32)
            ink = np.asarray(cv2.resize(ink, shape, interpolation=cv2.INTER_AREA), np.float32)
            mask = cv2.resize(mask.astype(np.float32), shape, interpolation=cv2.INTER_AREA) > 0.5
        given = planes(normals, ink, mask)
        below, right = (-side % CELL for side in mask.shape)
        given = np.pad(given, ((0, 0), (0, below), (0, right)), mode="edge")
        (refined,) = self._session.run(["normal"], {"planes": given[None]})
        refined = np.moveaxis(np.asarray(refined)[0, :, : mask.shape[0], : mask.shape[1]], 0, -1)
        if factor < 1:
            refined = cv2.resize(np.ascontiguousarray(refined), (w, h), interpolation=cv2.INTER_LINEAR)
        return np.asarray(refined, np.float32)


def upsampler(*, refined: bool, threads: int = 1) -> Upsampler:
    """Return the upsampler of a model.

    Args:
        refined: whether the package's refiner was trained for the model.
        threads: number of threads of the refiner; 0 uses all cores.
    """
    return Refiner(threads=threads) if refined else enlarge


def planes(normals: Floats, ink: Floats, mask: BoolMask) -> Floats:
    """Return the refiner's input (6, H, W): normals, lines, mask and distance from the silhouette.

    Args:
        normals: (H, W, 3), enlarged normals.
        ink: (H, W) in [0, 1].
        mask: (H, W), the object; the picture's edge counts as silhouette.
    """
    out = np.empty((6, *mask.shape), np.float32)
    out[:3] = np.moveaxis(normals, -1, 0)
    out[3], out[4] = ink, mask
    np.minimum(depth_of(mask) / RIM, 1, out=out[5])
    return out
