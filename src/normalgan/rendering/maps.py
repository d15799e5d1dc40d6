"""Maps: the normal, depth and mask of each pixel, returned by renderers, and a check of them."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError


@dataclass(frozen=True)
class Maps:
    """The visible surface, sampled at pixel centres; row 0 is the top of the picture.

    Args:
        normal: (H, W, 3) unit normals in camera space (x right, y up, z to the viewer); 0 outside the
            object.
        depth: (H, W) distance from the camera plane along its axis, in mesh units; inf outside the object.
        mask: (H, W), True on the object.
    """

    normal: Floats
    depth: Floats
    mask: BoolMask


def check_maps(renderer: object, maps: object, size: int) -> Maps:
    """Return a renderer's maps after checking their types and their side ``size``.

    Raises:
        InputError: if the maps are invalid.
    """
    name = type(renderer).__name__
    if not isinstance(maps, Maps):
        raise InputError(f"{name} gave {type(maps).__name__}; a renderer gives normalgan.rendering.Maps.")
    for part, wanted in (("normal", (size, size, 3)), ("depth", (size, size)), ("mask", (size, size))):
        value: object = getattr(maps, part)
        if not isinstance(value, np.ndarray) or value.shape != wanted:
            given = f"shape {value.shape}" if isinstance(value, np.ndarray) else type(value).__name__
            raise InputError(f"{name} gave a {part} of {given}; here it is an array of shape {wanted}.")
    if maps.mask.dtype != np.bool_:
        raise InputError(f"{name} gave a mask of {maps.mask.dtype}; it is bool, True on the object.")
    if not np.isfinite(maps.normal).all():
        raise InputError(f"{name} gave normals that are not numbers; give unit vectors, 0 off the object.")
    return maps
