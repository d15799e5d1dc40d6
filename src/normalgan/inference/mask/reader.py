"""Reader: a small network that finds the ink and the object in a raw picture."""

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.reading.picture import Picture, fitted, resize
from normalgan.weights.shipped import READER

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

__all__ = ["Reading", "drop_ground", "lines_of", "read"]

_SIDES = 256, 384
"""Smallest and largest longer side, in pixels, of the pictures that the network sees."""
_STRIDE = 32
"""The sides of these pictures are multiples of this many pixels."""
_GREY = np.array([0.299, 0.587, 0.114], np.float32)
_GATE, _FOREIGN = 0.25, 0.3
"""Least probability of ink; and the share of improbable lines from which they are dropped pixel by pixel."""
_REACH = 3
"""How far lines may be from probable ink, in pixels of the network, as a width."""


@dataclass(frozen=True)
class Reading:
    """The network's output for a picture, at the network's size.

    Args:
        ink: (h, w), probability that a pixel is a line of a drawing.
        presence: (h, w), probability that it belongs to an object; holes do not.
        middle: (2, h, w), x and y of the middle of its object, as shares of the picture's sides.
    """

    ink: Floats
    presence: Floats
    middle: Floats

    def presence_at(self, shape: tuple[int, int]) -> Floats:
        """Return the presence at a size of (H, W) pixels."""
        return np.asarray(cv2.resize(self.presence, shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)


def read(picture: Picture) -> Reading:
    """Return the network's output.

    Args:
        picture: the raw drawing; transparent parts become white, or black if the drawing is light.
    """
    shape = picture.size
    side = min(max(*shape, _SIDES[0]), _SIDES[1])
    height, width = (max(round(each / _STRIDE), 1) * _STRIDE for each in fitted(shape, side))
    method = cv2.INTER_AREA if side < max(shape) else cv2.INTER_LINEAR
    shown = cv2.resize(_opaque(picture), (width, height), interpolation=method)
    blob = np.ascontiguousarray(shown[..., ::-1].transpose(2, 0, 1)[None], np.float32)
    found = np.asarray(_session().run(["read"], {"picture": blob})[0][0], np.float32)
    ink, presence = 1 / (1 + np.exp(-np.clip(found[:2], -30, 30)))
    longest = max(height, width)
    x = (np.arange(width, dtype=np.float32) + found[2] * longest) / width
    y = (np.arange(height, dtype=np.float32)[:, None] + found[3] * longest) / height
    return Reading(ink, presence, np.stack([x, y]))


def drop_ground(ink: Floats, reading: Reading) -> Floats:
    """Return lines (h, w) without those of the paper: rules, squares, captions, folds.

    Lines that are improbable all along are left out. If they are many, as on ruled paper, they are left out
    pixel by pixel, also where they touch the drawing.

    Args:
        ink: (h, w) in [0, 1].
        reading: of the same picture.
    """
    inked = ink > 0.1
    total = int(np.count_nonzero(inked))
    if not total:
        return ink
    shape = ink.shape[1], ink.shape[0]
    near = cv2.dilate((reading.ink > _GATE).astype(np.uint8), np.ones((_REACH, _REACH), np.uint8))
    gate = cv2.resize(near, shape, interpolation=cv2.INTER_NEAREST) > 0
    if not (inked & gate).any():
        return ink
    foreign = inked & ~gate
    if np.count_nonzero(foreign) > _FOREIGN * total:
        return np.where(gate, ink, 0).astype(np.float32)
    count, labels = cv2.connectedComponents(inked.astype(np.uint8), connectivity=8)
    own = labels[inked]
    sizes = np.bincount(own, minlength=count)
    believed = np.bincount(own, weights=gate[inked], minlength=count)
    presence = reading.presence_at((ink.shape[0], ink.shape[1]))
    seen = np.bincount(own, weights=presence[inked], minlength=count)
    # A caption may be ink; but no object is there.
    dropped = ((believed < 0.2 * sizes) & (seen < 0.3 * sizes)) | (seen < 0.1 * sizes)
    dropped[0] = False
    if dropped[1:].all():  # nothing looks like a drawing, so nothing is known of its lines
        return ink
    return np.where(dropped[labels], 0, ink).astype(np.float32) if dropped.any() else ink


def lines_of(reading: Reading, shape: tuple[int, int]) -> Floats:
    """Return the network's lines at a size of (H, W) pixels."""
    return np.clip(resize(reading.ink, shape), 0, 1)


def _opaque(picture: Picture) -> Floats:
    """Return colours (h, w, 3) over white, or over black if the opaque part is light."""
    if picture.alpha is None:
        return picture.colour
    alpha = picture.alpha
    seen = float((picture.colour @ _GREY * alpha).sum() / max(float(alpha.sum()), 1e-6))
    paper = 1.0 if seen < 0.6 else 0.0
    return np.asarray(picture.colour * alpha[..., None] + paper * (1 - alpha[..., None]), np.float32)


@cache
def _session() -> "InferenceSession":
    import onnxruntime  # takes a third of a second, which a given mask saves

    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4
    options.intra_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return onnxruntime.InferenceSession(READER.read_bytes(), options, providers=["CPUExecutionProvider"])
