"""Shading maps for engines: ambient occlusion, curvature and specular."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import wraps
from typing import ClassVar
from weakref import WeakKeyDictionary

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.network.tile import middle, wrapped
from normalgan.inference.normal_map import NormalMap, part_of
from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.inference.outputs.engines import Engine
from normalgan.inference.outputs.occlusion import occlusion
from normalgan.normals import encode_grey

_FINE = 1 / 256
"""Smoothing width for the curvature, as a fraction of a drawing's longer side."""
_BEND = 0.04
"""Radius of a ball whose curvature gives the tanh an argument of 1, as a fraction of the longer side."""
_BESIDE = 0.25
"""Margin of repeats around a repeating map, as a fraction of its longer side."""


@OUTPUTS.register
@dataclass(frozen=True)
class AmbientOcclusion(Output):
    """The ambient occlusion map."""

    name: ClassVar[str] = "ao"
    label: ClassVar[str] = "Ambient occlusion"
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {"unity": "_Occlusion", "unreal": "_AO"}

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        return {self.endings[0]: encode_grey(occlusion_of(preds))}


@OUTPUTS.register
@dataclass(frozen=True)
class Curvature(Output):
    """The curvature map, with light ridges and dark hollows."""

    name: ClassVar[str] = "curvature"
    label: ClassVar[str] = "Curvature"
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {"unity": "_Curvature", "unreal": "_C"}

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        return {self.endings[0]: encode_grey(curvature_of(preds))}


@OUTPUTS.register
@dataclass(frozen=True)
class Specular(Output):
    """The specular map, with polished ridges and dull hollows."""

    name: ClassVar[str] = "specular"
    label: ClassVar[str] = "Specular"
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {"unity": "_Specular", "unreal": "_S"}

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        return {self.endings[0]: encode_grey(specular_of(preds))}


def _once(compute: Callable[[NormalMap], Floats]) -> Callable[[NormalMap], Floats]:
    """Cache a function of a map for as long as the map exists."""
    known: WeakKeyDictionary[NormalMap, Floats] = WeakKeyDictionary()

    @wraps(compute)
    def recalled(preds: NormalMap) -> Floats:
        if preds not in known:
            known[preds] = compute(preds)
        return known[preds]

    return recalled


@_once
def occlusion_of(preds: NormalMap) -> Floats:
    """Return the ambient occlusion (H, W) of a map: 1 where the sky is fully visible, and off the object."""
    if preds.cells:
        whole, height = np.ones(preds.mask.shape, np.float32), preds.height()
        for cell in preds.cells:  # the drawings of a sheet do not occlude each other
            own = np.ascontiguousarray(cell.upright(height[cell.box]))
            cell.put(whole, _occlusion(part_of(preds, cell), own))
        return whole
    return _occlusion(preds, preds.height())


@_once
def curvature_of(preds: NormalMap) -> Floats:
    """Return the curvature (H, W) of a map in [0, 1]; 0.5 off the object."""
    if preds.cells:
        whole = np.full(preds.mask.shape, 0.5, np.float32)
        for cell in preds.cells:
            cell.put(whole, curvature_of(part_of(preds, cell)))
        return whole
    normals, mask = (wrapped(each, preds.tile, _room(preds)) for each in (preds.extended, preds.mask))
    return middle(curvature(normals, mask, max(preds.mask.shape)), preds.tile, _room(preds))


def specular_of(preds: NormalMap) -> Floats:
    """Return the specular map (H, W) in [0, 1]; 0 off the object."""
    return gloss(occlusion_of(preds), curvature_of(preds), preds.mask)


def _occlusion(preds: NormalMap, height: Floats) -> Floats:
    room = _room(preds)
    normals, mask = (wrapped(each, preds.tile, room) for each in (preds.extended, preds.mask))
    around = wrapped(height.astype(np.float32, copy=False), preds.tile, room)
    return middle(occlusion(around, normals, mask, max(preds.mask.shape)), preds.tile, room)


def _room(preds: NormalMap) -> tuple[int, int]:
    return (round(_BESIDE * max(preds.mask.shape)),) * 2


def curvature(normals: Floats, mask: BoolMask, longest: int | None = None) -> Floats:
    """Return the curvature (H, W): above 0.5 on ridges, below it in hollows, 0.5 if flat and off the object.

    It is computed from the divergence of the normals, which is twice the mean curvature where the surface
    faces the viewer.

    Args:
        normals: (H, W, 3), unit on the object.
        mask: (H, W), the object.
        longest: longer side of the drawing in pixels, if the arrays are padded with its repeats; None uses
            the longer side of the object.
    """
    from scipy import ndimage  # here because it is slow to import

    if not mask.any():
        return np.full(mask.shape, 0.5, np.float32)
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    # The size of the largest part, because the map may be a whole sheet.
    side = int(stats[1:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].max())
    side = min(side, longest or side)
    width = max(_FINE * side, 0.7)
    # The nearest normals on the object replace those off it, because the background of a sheet is flat.
    nearest = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
    smooth = cv2.GaussianBlur(normals[nearest[0], nearest[1], :2], (0, 0), width)
    bend = np.gradient(smooth[..., 0], axis=1) - np.gradient(smooth[..., 1], axis=0)  # y goes up
    return np.where(mask, 0.5 + 0.5 * np.tanh(bend * side * _BEND / 2), 0.5).astype(np.float32)


def gloss(open_to_light: Floats, bends: Floats, mask: BoolMask) -> Floats:
    """Return the specular map (H, W) in [0, 1]: high on ridges, low in hollows, 0 off the object.

    Args:
        open_to_light: (H, W), from `occlusion.occlusion`.
        bends: (H, W), from `curvature`.
        mask: (H, W), the object.
    """
    return np.where(mask, np.clip(open_to_light * bends, 0, 1), 0).astype(np.float32)
