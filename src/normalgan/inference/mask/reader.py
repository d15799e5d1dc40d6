"""Reader: a small network that tells ink from ground and object from air, and its votes on regions.

It sees the picture as it comes. The lines' own filling decides where both agree; each enclosed region is kept
or left out as a whole, by its mean presence; where an outline is open, presence closes it.
"""

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.network.line_width import line_width
from normalgan.inference.reading.picture import Picture, fitted, resize

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

__all__ = ["SHIPPED", "Reading", "Vote", "drop_ground", "read", "vote"]

SHIPPED = Path(__file__).parents[2] / "weights" / "reader.onnx"
"""The reader that comes with the package."""
_SIDES = 256, 384
"""Smallest and largest longer side, in pixels, of the pictures that the network sees."""
_STRIDE = 32
"""The sides of these pictures are multiples of this many pixels."""
_CLOSE_UP = 0.5
"""An object that spans less than this share of the picture is looked at again, enlarged."""
_ROOM = 0.12
"""Margin around the object in that second look, as a share of its span."""
_GREY = np.array([0.299, 0.587, 0.114], np.float32)
_HOLE, _PART = 0.3, 0.75
"""Mean presence below which what lines enclose is a hole, and above which a region is object throughout."""
_EYE = 0.004
"""Share of what lines enclose below which a region is an eye or a button, and no hole in any case."""
_ADDED = 0.6
"""Mean presence from which a region is object that filling left out."""
_SURE, _SPECK = 0.72, 0.002
"""The same where an outline is open, and the share of the object that is added at least."""
_INKED = 0.35
_GATE, _FOREIGN = 0.25, 0.3
"""Ink that it believes in; the share of lines that it does not believe in from which they are left out."""
_UNSURE = 0.3, 0.7, 0.02
"""Mean presence from and to which it is unsure, and the share of the object from which that is said."""


@dataclass(frozen=True)
class Reading:
    """What the network sees in a picture.

    Args:
        ink: (h, w), probability that a pixel is a line of a drawing.
        presence: (h, w), probability that it belongs to an object; holes do not.
    """

    ink: Floats
    presence: Floats


@dataclass(frozen=True)
class Vote:
    """The object as lines and network tell it together.

    Args:
        mask: (h, w), the object.
        unsure: what is to be said of regions that may or may not belong to it; empty if nothing.
    """

    mask: BoolMask
    unsure: str


def read(picture: Picture) -> Reading:
    """Return what the network sees, at the picture's own size.

    An object that is small on its page is looked at twice, the second time enlarged.

    Args:
        picture: as it comes; where it is transparent, it is laid over white, or black if it is light.
    """
    colour = _opaque(picture)
    ink, presence = _run(colour)
    rows, columns = np.flatnonzero((presence > 0.5).any(1)), np.flatnonzero((presence > 0.5).any(0))
    if len(rows) and len(columns):
        span = max(int(np.ptp(rows)), int(np.ptp(columns))) + 1
        if span < _CLOSE_UP * max(presence.shape):
            room = int(_ROOM * span) + 8
            box = (
                slice(max(int(rows[0]) - room, 0), int(rows[-1]) + room + 1),
                slice(max(int(columns[0]) - room, 0), int(columns[-1]) + room + 1),
            )
            ink[box], presence[box] = _run(colour[box])
    return Reading(ink, presence)


def drop_ground(ink: Floats, reading: Reading) -> Floats:
    """Return lines (h, w) without those of the ground: rules, squares, captions, folds.

    Lines that the network does not believe in anywhere are left out; where they are many, as on ruled paper,
    they are left out pixel by pixel, also where they touch the drawing.

    Args:
        ink: (h, w) in [0, 1].
        reading: of the same picture.
    """
    inked = ink > 0.1
    total = int(np.count_nonzero(inked))
    if not total:
        return ink
    reach = 2 * max(round(max(ink.shape) / 160), 1) + 1
    gate = cv2.dilate((reading.ink > _GATE).astype(np.uint8), np.ones((reach, reach), np.uint8)) > 0
    if not (inked & gate).any():
        return ink
    foreign = inked & ~gate
    if np.count_nonzero(foreign) > _FOREIGN * total:
        return np.where(gate, ink, 0).astype(np.float32)
    count, labels = cv2.connectedComponents(inked.astype(np.uint8), connectivity=8)
    sizes = np.bincount(labels.ravel(), minlength=count)
    believed = np.bincount(labels[gate], minlength=count)
    seen = np.bincount(labels.ravel(), weights=reading.presence.ravel(), minlength=count)
    # A caption may be ink; but no object is there.
    dropped = ((believed < 0.2 * sizes) & (seen < 0.3 * sizes)) | (seen < 0.1 * sizes)
    dropped[0] = False
    return np.where(dropped[labels], 0, ink).astype(np.float32) if dropped.any() else ink


def vote(ink: Floats, filled: BoolMask, presence: Floats) -> Vote:
    """Return the object: what lines enclose, with holes as the network sees them, closed where it sees it.

    Args:
        ink: (h, w) in [0, 1].
        filled: (h, w), what filling takes for the object.
        presence: (h, w), of the network.

    Example:
        >>> ink = np.zeros((40, 40), np.float32)
        >>> ink[5:35, 5:35] = 1
        >>> ink[7:33, 7:33] = 0
        >>> filled = np.pad(np.ones((30, 30), bool), 5)
        >>> int(vote(ink, filled, np.zeros((40, 40), np.float32)).mask[20, 20])
        0
    """
    inked = ink > _INKED
    count, labels, stats, _ = cv2.connectedComponentsWithStats((~inked).astype(np.uint8), connectivity=4)
    height, width = ink.shape
    left, top = stats[:, cv2.CC_STAT_LEFT], stats[:, cv2.CC_STAT_TOP]
    enclosed = (left > 0) & (top > 0)
    enclosed &= (left + stats[:, cv2.CC_STAT_WIDTH] < width) & (top + stats[:, cv2.CC_STAT_HEIGHT] < height)
    # A cell is a part of a region that filling treats alike.
    cells = np.where(inked, 0, 2 * labels + filled).ravel()
    size = np.bincount(cells, minlength=2 * count + 2)
    mean = np.bincount(cells, weights=presence.ravel(), minlength=len(size)) / np.maximum(size, 1)
    by_lines = np.arange(len(size)) % 2 == 1
    inside = np.repeat(enclosed, 2)[: len(size)]
    inside = np.pad(inside, (0, len(size) - len(inside)))
    on = np.where(by_lines, mean >= _HOLE, inside & (mean > _ADDED))
    pixels = ~inside & (~by_lines | (mean < _PART))
    on |= by_lines & inside & (size < _EYE * np.count_nonzero(filled))
    on[0] = pixels[0] = False
    where = cells.reshape(ink.shape)
    solid: BoolMask = on[where]
    mixed = pixels[where]
    solid = np.where(mixed, presence > 0.5, solid) & ~inked
    if mixed.any():
        solid = _without_guesses(solid, filled, presence)
    reach = 2 * round(line_width(inked) + 1.5) + 1
    near = (
        cv2.dilate(solid.astype(np.uint8), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))) > 0
    )
    lines = inked & ((filled & near) | (near & (presence > 0.15)) | (presence > 0.4))
    mask = solid | lines
    # Between a line and what it bounds there is no gap of a pixel.
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8)) > 0
    mask |= closed & ((presence > 0.3) | filled) & ~(by_lines & ~on)[where]
    return Vote(mask, _unsure(where, size, mean, int(np.count_nonzero(mask))))


def _without_guesses(solid: BoolMask, filled: BoolMask, presence: Floats) -> BoolMask:
    """Return the object without what filling did not find and of which the network is not sure, or specks."""
    added = solid & ~filled
    count, labels, stats, _ = cv2.connectedComponentsWithStats(added.astype(np.uint8), connectivity=4)
    area = stats[:, cv2.CC_STAT_AREA]
    sure = np.bincount(labels.ravel(), weights=presence.ravel(), minlength=count) >= _SURE * area
    kept = sure & (area >= _SPECK * max(int(np.count_nonzero(solid)), 1))
    kept[0] = True
    found: BoolMask = solid & kept[labels]
    return found


def _unsure(where: NDArray[np.intp], size: NDArray[np.intp], mean: NDArray[np.floating], total: int) -> str:
    low, high, share = _UNSURE
    doubtful = (mean > low) & (mean < high) & (size > share * max(total, 1))
    doubtful[0] = False
    numbers = np.flatnonzero(doubtful)
    if not len(numbers):
        return ""
    places = []
    for number in numbers[np.argsort(-size[numbers])][:3]:
        depth = cv2.distanceTransform(np.pad(where == number, 1).astype(np.uint8), cv2.DIST_L2, 3)[1:-1, 1:-1]
        row, column = np.unravel_index(int(depth.argmax()), depth.shape)
        places.append(f"x {column}, y {row}")
    what = "a region" if len(numbers) == 1 else f"{len(numbers)} regions"
    return f"{what} may be object or hole, at {'; '.join(places)}; give --mask if it is wrong"


def _opaque(picture: Picture) -> Floats:
    """Return colours (h, w, 3) laid over white; over black if what is opaque is light."""
    if picture.alpha is None:
        return picture.colour
    alpha = picture.alpha
    seen = float((picture.colour @ _GREY * alpha).sum() / max(float(alpha.sum()), 1e-6))
    paper = 1.0 if seen < 0.6 else 0.0
    return np.asarray(picture.colour * alpha[..., None] + paper * (1 - alpha[..., None]), np.float32)


def _run(colour: Floats) -> tuple[Floats, Floats]:
    """Return ink and presence (h, w) of colours (h, w, 3)."""
    shape = (colour.shape[0], colour.shape[1])
    side = min(max(*shape, _SIDES[0]), _SIDES[1])
    wanted = fitted(shape, side)
    height, width = (max(round(each / _STRIDE), 1) * _STRIDE for each in wanted)
    method = cv2.INTER_AREA if side < max(shape) else cv2.INTER_LINEAR
    shown = cv2.resize(colour, (width, height), interpolation=method)
    blob = np.ascontiguousarray(shown[..., ::-1].transpose(2, 0, 1)[None], np.float32)
    read = _session().run(["read"], {"picture": blob})[0][0, :2]
    probable = 1 / (1 + np.exp(-np.clip(np.asarray(read, np.float32), -30, 30)))
    ink, presence = (np.ascontiguousarray(resize(np.ascontiguousarray(each), shape)) for each in probable)
    return ink, presence


@cache
def _session() -> "InferenceSession":
    import onnxruntime  # takes a third of a second, and who gives a mask does without

    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4
    options.intra_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return onnxruntime.InferenceSession(SHIPPED.read_bytes(), options, providers=["CPUExecutionProvider"])
