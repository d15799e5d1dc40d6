"""Upsampling: bring a map to the drawing's size, refined by the drawing's lines and rim."""

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

__all__ = [
    "CELL",
    "RIM",
    "Coarse",
    "Refiner",
    "Upsampler",
    "enlarge",
    "planes",
    "upsampler",
]

CELL = 4
"""Side of a cell in pixels; sides of its pictures are multiples of it."""
RIM = 16
"""Largest distance from the silhouette, in pixels, that its input gives."""
_ENLARGED = 1.2
"""How much larger than the model's a map must be to be refined."""
_LARGEST = 4.0
"""Largest scale, in pixels for each pixel of the model, that is refined; the rest is enlarging."""


@dataclass(frozen=True)
class Coarse:
    """The network's prediction at its own size.

    Args:
        normals: (S, S, 3), unit; zero where the network predicted nothing.
        known: (S, S), where they are to be kept; True somewhere.
        needed: (S, S), where the object is.
    """

    normals: Floats
    known: BoolMask
    needed: BoolMask


class Upsampler(Protocol):
    """The step from the network's size to the drawing's; `pipeline.predict` accepts another one."""

    def __call__(self, coarse: Coarse, prepared: Prepared, mask: BoolMask) -> Floats:
        """Return normals (h, w, 3) at the size and place of ``prepared.ink``, of any length.

        Args:
            coarse: what was predicted in the square ``prepared.frame``.
            prepared: the drawing: its lines (h, w), its frame, what the network was shown.
            mask: (h, w), the object, not empty. Off it normals matter only for what blends across its edge.
        """
        ...


def enlarge(coarse: Coarse, prepared: Prepared, mask: BoolMask) -> Floats:
    """Fill missing normals and enlarge by interpolation only; an `Upsampler`."""
    return prepared.frame.restore(extend(coarse.normals, coarse.known, coarse.needed))


class Refiner:
    """Fills missing normals, enlarges them, and refines them at the drawing's size; an `Upsampler`.

    Enlarging blends the two sides of a line and misses the rim, where a surface turns away within one pixel
    of the model. A small network sees the enlarged normals, the lines, the mask and the distance from the
    silhouette at the drawing's size, and adds the difference.
    It is read when it is first called.

    Args:
        path: network that ``tools/train_refiner.py`` wrote.
        threads: threads of one run; 0 takes all cores.
    """

    def __init__(self, path: Path = REFINER, threads: int = 1) -> None:
        self._path, self._threads = path, threads

    @cached_property
    def _session(self) -> "InferenceSession":
        import onnxruntime  # late: it starts threads, and training needs none of them

        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = self._threads
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")  # as for the network
        # Where that one is of ONNX, both work in the same memory, one after the other.
        options.add_session_config_entry("session.use_env_allocators", "1")
        return onnxruntime.InferenceSession(self._path, options, providers=["CPUExecutionProvider"])

    def __call__(self, coarse: Coarse, prepared: Prepared, mask: BoolMask) -> Floats:
        """Return normals (h, w, 3) at the drawing's size and place, as `Upsampler` says."""
        normals = enlarge(coarse, prepared, mask)
        scale = prepared.frame.side / prepared.frame.size
        if scale <= _ENLARGED:
            return normals
        box = around(mask, round(2 * scale))
        normals[box] = self._refined(normals[box], prepared.ink[box], mask[box], min(_LARGEST / scale, 1))
        return normals

    def _refined(self, normals: Floats, ink: Floats, mask: BoolMask, factor: float) -> Floats:
        """Return enlarged normals (H, W, 3), refined at ``factor`` times their size."""
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
    """Return the step to the drawing's size for a model.

    Args:
        refined: whether the model is one that the refiner of the package was trained for.
        threads: threads of the refiner; 0 takes all cores.
    """
    return Refiner(threads=threads) if refined else enlarge


def planes(normals: Floats, ink: Floats, mask: BoolMask) -> Floats:
    """Return the refiner's input, (6, H, W): normals, lines, mask, distance from the silhouette.

    Args:
        normals: (H, W, 3), enlarged.
        ink: (H, W) in [0, 1].
        mask: (H, W), the object, which does not go on beyond the picture's edge.
    """
    out = np.empty((6, *mask.shape), np.float32)
    out[:3] = np.moveaxis(normals, -1, 0)
    out[3], out[4] = ink, mask
    np.minimum(depth_of(mask) / RIM, 1, out=out[5])
    return out
