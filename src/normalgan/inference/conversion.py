"""Conversion: read existing normal maps and height maps, and add details to a normal map."""

from pathlib import Path

import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.drawing import Drawing
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.reading.drawings import read_normals, read_pixels, to_unit
from normalgan.inference.vectors import unit
from normalgan.normals import Green

_FLAT: Floats = np.array([0, 0, 1], np.float32)
"""The normal that the middle levels of a PNG with 8 bits, 127 and 128, stand for."""


def read_map(path: str | Path, green: Green = "up") -> NormalMap:
    """Return the normal map in a file as a `NormalMap`.

    Args:
        path: a PNG, TIFF or EXR file.
        green: direction of y in the green channel.

    Raises:
        InputError: if the file cannot be read, is not a normal map, or holds several pictures.
    """
    _check_single(path)
    found, alpha = read_normals(path, green)
    # 256 levels have no middle, so that a flat area would rise by a pixel in every 255.
    middle = (np.abs(np.abs(found[..., :2]) - 1 / 255) < 1e-6).all(-1)
    found = np.where((middle & (found[..., 2] >= 1))[..., None], _FLAT, found)
    return _map(found, alpha, path)


def map_of_heights(path: str | Path, scale: float) -> NormalMap:
    """Return the normal map of the surface in a height map.

    Args:
        path: a grey picture in which white is high.
        scale: height difference between black and white in pixels; for a float TIFF, pixels per unit.

    Raises:
        InputError: if the file cannot be read, is not grey, or holds several pictures.
    """
    if not scale > 0:
        raise InputError(f"scale is {scale}; give the number of pixels from black to white, more than 0.")
    _check_single(path)
    pixels = read_pixels(Path(path), exact=True).pixels
    alpha = to_unit(pixels[..., 3]) if pixels.ndim == 3 and pixels.shape[2] == 4 else None
    if pixels.ndim == 3:
        if (pixels[..., :3] != pixels[..., :1]).any():
            raise InputError(f"{path} has colours; a height map is grey.")
        pixels = pixels[..., 0]
    heights = pixels if pixels.dtype == np.float32 else to_unit(pixels)
    down, right = np.gradient(heights.astype(np.float32) * np.float32(scale))
    slopes = np.stack([-right, down, np.ones_like(right)], axis=-1)
    return _map(slopes, alpha, path)


def _check_single(path: str | Path) -> None:
    if Drawing(Path(path)).moving is not None:
        raise InputError(f"{path} has several pictures; give one, such as a frame in a file of its own.")


def with_detail(base: NormalMap, detail: NormalMap) -> NormalMap:
    """Return a map with the details of another map added; a smaller detail map is tiled."""
    height, width = base.mask.shape
    rows, columns = (-(-a // b) for a, b in zip((height, width), detail.mask.shape, strict=True))
    repeated = np.tile(detail.extended, (rows, columns, 1))[:height, :width]
    return NormalMap(
        reoriented(base.extended, repeated), base.mask, base.alpha, base.seen, base.confidence, base.findings
    )


def reoriented(base: Floats, detail: Floats) -> Floats:
    """Return normals (H, W, 3) of detail normals (H, W, 3) applied to base normals (H, W, 3).

    References:
        Barré-Brisebois, Hill 2012, "Blending in detail".

    Example:
        A flat base returns the detail, and a flat detail returns the base:

        >>> flat = np.array([[[0, 0, 1]]], np.float32)
        >>> tilted = np.array([[[0.6, 0, 0.8]]], np.float32)
        >>> [bool(np.allclose(each, tilted)) for each in (reoriented(flat, tilted), reoriented(tilted, flat))]
        [True, True]
    """
    onto = base + np.array([0, 0, 1], np.float32)
    turned = detail * np.array([-1, -1, 1], np.float32)
    share = (onto * turned).sum(axis=-1, keepdims=True) / np.maximum(onto[..., 2:], np.float32(1e-4))
    return unit(np.ascontiguousarray(onto * share - turned, np.float32), front=True)


def _map(vectors: Floats, alpha: Floats | None, path: str | Path) -> NormalMap:
    """Return vectors as a map; pixels that are not finite are transparent and flat.

    Renderers write NaN or infinity where there is no surface.
    """
    known: BoolMask = np.asarray(np.isfinite(vectors).all(-1))
    if not known.any():
        raise InputError(f"{path} has no pixel with finite numbers.")
    normals = unit(np.ascontiguousarray(np.where(known[..., None], vectors, _FLAT), np.float32), front=True)
    opacity = np.where(known, np.float32(1) if alpha is None else alpha, np.float32(0))
    return NormalMap(normals, opacity > 0.5, opacity)
