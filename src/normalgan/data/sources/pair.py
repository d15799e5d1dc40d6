"""Pair: a sketch and its normal map, and the recipe that turns them into a training sample."""

from dataclasses import dataclass
from typing import Any, ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.inputs import AnyHints, AnyMask, AnyPicture, as_hints, as_mask, as_picture
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import resize
from normalgan.normals import normalize
from normalgan.ranges import PositiveInt, check_ranges
from normalgan.rendering.samples import Sample

PAIRS_VERSION = 4
"""Version of samples of pairs. Increase it if a code change affects them, so that they are created again."""

_TOLERANCE = 0.02
"""Tolerance for the background's colour per channel, of a range of 2, for rounding."""
_LOSSY_TOLERANCE = 0.2
"""The same for JPEG, which blurs and rings at each line. At quality 75, the object of a JPEG of 256 pixels
then has an IoU of 0.98 with that of its PNG, against 0.86 with the other tolerance."""
_CLEAR = 0.4
"""Outwardness along an outline from which a direction is certain."""
_RIGHT = "axes of the camera, x right, y up, z to the viewer, stored as (n + 1) / 2"


class Pair:
    """A sketch and its normal map of the same size, pixel for pixel.

    Args:
        sketch: path, Pillow image or array, as for `normalgan.Predictor`.
        normal: (H, W, 3) floats, unit vectors in camera space: x right, y up, z to the viewer.
        mask: (H, W), mask of the object, in any form accepted by `normalgan.Predictor`; None uses the
            pixels with nonzero vectors.
        hints: normals set by a designer, in any form accepted by `normalgan.Predictor`; None for no hints.

    Raises:
        InputError: if an argument is invalid, or the sizes differ.
    """

    def __init__(
        self, sketch: AnyPicture, normal: NDArray[Any], mask: AnyMask = None, hints: AnyHints = None
    ) -> None:
        self.sketch = as_picture(sketch)
        height, width = self.sketch.shape
        normal = _checked_array(normal)
        if normal.shape[:2] != (height, width):
            raise InputError(
                f"the sketch has {width} × {height} pixels and its normal map {normal.shape[1]} × "
                f"{normal.shape[0]}; both must show the same, pixel on pixel."
            )
        given = as_mask(mask, (height, width))
        if given is None:
            given = np.asarray(np.linalg.norm(normal, axis=-1) > 0.5)
        elif given.shape != (height, width):  # a large picture is downsampled on reading
            given = resize(given.astype(np.float32), (height, width)) > 0.5
        if not given.any():
            raise InputError("the normal map has no object: all its vectors are zero.")
        self.mask: BoolMask = given
        if mask is not None:
            _check_mask(normal, self.mask)
        _check_normals(normal[self.mask])
        self.normal: Floats = normalize(np.where(self.mask[..., None], normal, np.float32(0)))
        _check_axes(self.normal, self.mask)
        self.hints = as_hints(hints, (height, width))
        if self.hints is not None:
            _check_hints(self.hints, self.mask)


@dataclass(frozen=True)
class PairRecipe:
    """Recipe for a sample from a pair: the sketch is cleaned and framed like a drawing in prediction.

    This way, training sketches look like the input of the trained model. The normals are cropped in the
    same way.

    Args:
        size: side of the pictures in pixels.
        hints: whether the samples include the hints of the pairs.
    """

    noun: ClassVar[str] = "pair"

    size: PositiveInt = 256
    hints: bool = False

    def __post_init__(self) -> None:
        check_ranges(self)

    def check(self) -> None:
        """Do nothing, because there are no requirements."""

    def render(self, pair: Pair, index: int) -> Sample:
        """Return the only sample of a pair, for any index.

        Raises:
            InputError: if ``pair`` is not a pair, or the sketch has no lines.
        """
        del index
        if not isinstance(pair, Pair):
            raise InputError(
                f"its load gave {type(pair).__name__}; a source of pairs loads a normalgan.data.sources.Pair."
            )
        prepared = prepare(pair.sketch, self.size, pair.mask, pair.hints if self.hints else None)
        frame, worked = prepared.frame, (prepared.ink.shape[0], prepared.ink.shape[1])
        normal, mask = pair.normal, pair.mask.astype(np.float32)
        if worked != mask.shape:
            normal, mask = resize(normal, worked), resize(mask, worked)
        cut = np.stack([frame.shrink(np.ascontiguousarray(normal[..., i])) for i in range(3)], axis=-1)
        inside = frame.shrink(mask) > 0.5
        hints = None
        if self.hints:
            given = prepared.hints
            empty = np.zeros((4, self.size, self.size), np.float32)
            hints = (empty if given is None else given).transpose(1, 2, 0).astype(np.float16)
        return Sample(
            sketch=np.rint(255 * prepared.model_input).astype(np.uint8),
            normal=(normalize(cut) * inside[..., None]).astype(np.float16),
            mask=inside,
            hints=hints,
        )

    def describe(self) -> dict[str, Any]:
        """Return what the samples depend on, apart from the pairs themselves, as plain values for JSON."""
        return {
            "class": "PairRecipe",
            "size": self.size,
            "hints": self.hints,
            "rendering_version": PAIRS_VERSION,
        }


def background(levels: NDArray[Any], lossy: bool = False) -> BoolMask:
    """Return the background of a normal map without a mask, (H, W).

    The background is the area with the colour of the corners that touches the picture's border. If that
    colour is not a normal, such as zero or black, all pixels of the colour are background. Pixels that are
    not finite count as zero. If the four corners differ, there is no background.

    Args:
        levels: (H, W, 3) colours or vectors, with a range of 2.
        lossy: whether compression has changed the colours, as in a JPEG.

    Example:
        >>> levels = np.zeros((5, 5, 3), np.float32)
        >>> levels[2, 2] = 1
        >>> int(background(levels).sum())
        24
    """
    tolerance = _LOSSY_TOLERANCE if lossy else _TOLERANCE
    levels = np.where(np.isfinite(levels).all(-1, keepdims=True), levels, 0)
    corners = levels[[0, 0, -1, -1], [0, -1, 0, -1]]
    colour = np.median(corners, axis=0)
    if not (np.abs(corners - colour) <= tolerance).all():
        return np.zeros(levels.shape[:2], np.bool_)
    same = (np.abs(levels - colour) <= tolerance).all(-1)
    if abs(float(np.linalg.norm(colour)) - 1) > 0.25:  # the colour is not a normal, so holes have it too
        return np.asarray(same)
    alike = same.astype(np.uint8)
    _, labels = cv2.connectedComponents(alike, connectivity=4)
    edge = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    return np.isin(labels, np.setdiff1d(edge, [0]))


def _checked_array(normal: NDArray[Any]) -> NDArray[Any]:
    wanted = "it is an array of floats with the shape (H, W, 3), unit vectors"
    if not isinstance(normal, np.ndarray):
        raise InputError(f"the normal map is of the type {type(normal).__name__}; {wanted}.")
    if normal.ndim != 3 or normal.shape[2] != 3 or not np.issubdtype(normal.dtype, np.floating):
        colours = " (colours become vectors by normalgan.normals.vectors)" if normal.ndim == 3 else ""
        raise InputError(
            f"the normal map is an array of {normal.dtype} with the shape {normal.shape}; {wanted}{colours}."
        )
    return normal


def _check_normals(on: NDArray[np.floating]) -> None:
    """Raise `InputError` if vectors on the object, (K, 3), are not normals in camera space."""
    if unknown := int((~np.isfinite(on)).any(-1).sum()):
        raise InputError(
            f"the normal map holds numbers that are not finite, at {unknown} of the {len(on)} pixels of the "
            "object; leave these pixels out of the mask."
        )
    length = np.linalg.norm(on, axis=-1)
    # A normal that faces the viewer is (0.5, 0.5, 1) as a colour, which has a length of 1.22.
    if on.min() >= 0 and on.max() <= 1 and float(np.median(length)) > 1.05:
        raise InputError(
            "the normal map holds colours from 0 to 1, not vectors from -1 to 1; normalgan.normals.vectors "
            "makes vectors of colours."
        )
    if (wrong := float((np.abs(length - 1) > 0.25).mean())) > 0.1:
        raise InputError(
            f"the normal map holds no normals: its vectors are {float(np.median(length)):.2f} long at the "
            f"median, and {wrong:.0%} of them on the object are more than 0.25 off the length 1; it must be "
            f"{_RIGHT}."
        )
    if (away := float((on[:, 2] < -0.25).mean())) > 0.1:
        raise InputError(
            f"the normal map holds vectors that point away from the viewer ({away:.0%} on the object have "
            f"z below 0), as those in the axes of the world do; it must be in the {_RIGHT}."
        )


def _check_hints(hints: Hints, mask: BoolMask) -> None:
    """Raise `InputError` if a hint lies outside the object, where there is no normal to learn from."""
    columns, rows = np.floor(hints.points).astype(int).T
    off = np.flatnonzero(~mask[rows, columns])
    if len(off):
        raise InputError(
            f"the hint at x {columns[off[0]]}, y {rows[off[0]]} is outside the object; hints must be on it."
        )


def _check_axes(normal: Floats, mask: BoolMask) -> None:
    """Raise `InputError` if the vectors along the outline show that x and y are mirrored or exchanged.

    Vectors that all point inward are accepted, because those of a bowl seen from above do.
    """
    (xx, xy), (yx, yy) = _outwardness(normal, mask)
    if xx > _CLEAR and yy < -_CLEAR:
        raise InputError(
            "the normal map looks as if its green had the opposite direction: along the outline x points "
            "outward and y inward; set green to down if it is that of DirectX, and to up if of OpenGL."
        )
    if xx < -_CLEAR and yy > _CLEAR:
        raise InputError(
            "the normal map looks as if its red had the opposite direction: along the outline y points "
            f"outward and x inward; invert its red, so that it has the {_RIGHT}."
        )
    if min(abs(xy), abs(yx)) > _CLEAR and max(abs(xx), abs(yy)) < _CLEAR / 2:
        raise InputError(
            "the normal map looks as if its red and green were exchanged: along the outline x follows the "
            f"vertical direction and y the horizontal one; exchange them, so that it has the {_RIGHT}."
        )


def _check_mask(normal: NDArray[Any], mask: BoolMask) -> None:
    """Raise `InputError` if a mask covers the background of the normal map instead of its object."""
    # The tolerance is that of a JPEG, because a mask of a JPEG may be inverted too.
    shown = ~background(normal, lossy=True)
    if mask.sum() * 0.1 > (mask & shown).sum() and shown.sum() * 0.5 < (shown & ~mask).sum():
        raise InputError(
            "the mask covers the background of the normal map, not its object; paint the object white, and "
            "the rest black."
        )


def _outwardness(normal: Floats, mask: BoolMask) -> Floats:
    """Return how much vectors along an object's outline point outwards, (2, 2), each from -1 to 1.

    The rows are the outward direction's x and y, the columns those of the normals. A convex surface points
    outwards at its outline, which gives the identity matrix. There is no outline where the picture's border
    cuts the object. Without any outline, the result is 0.

    Args:
        normal: (H, W, 3), y up.
        mask: (H, W), mask of the object.
    """
    soft = cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 2.0, borderType=cv2.BORDER_REPLICATE)
    right, down = np.gradient(soft, axis=1), np.gradient(soft, axis=0)
    rim = mask & (cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=1) == 0)
    weight = np.hypot(right, down)[rim]
    out = np.stack([-right[rim], down[rim]]) / np.maximum(weight, 1e-6)  # y is up
    held = normal[rim][:, :2].T
    total = (out**2).sum(1)
    return np.asarray((out @ held.T) / np.maximum(total, 1.0)[:, None], np.float32)
