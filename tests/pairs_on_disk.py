"""Pairs as users have them: sketches of ellipsoids with a wave in them, and their exact normal maps."""

from pathlib import Path

import numpy as np
from PIL import Image

from normalgan.arrays import Floats
from normalgan.files.writing import write_bytes
from normalgan.normals import Bits, Green, encode_exr, encode_png, flip_green, paint_flat

SIZE = 64


def ellipsoid(number: int, size: int = SIZE) -> tuple[Floats, Floats]:
    """Return the ink (size, size) and the normal map (size, size, 3), zero off it, of a wavy ellipsoid."""
    along = (np.arange(size, dtype=np.float32) + 0.5) / size * 2 - 1
    x, y = along[None] / (0.5 + 0.06 * (number % 5)), -along[:, None] / (0.8 - 0.05 * (number % 3))
    x, y = np.broadcast_arrays(x, y)
    square = x**2 + y**2
    inside = square < 1
    z = np.sqrt(np.clip(1 - square, 0, 1))
    wave = 0.6 * np.cos(9 * x) * z  # inside it only: at the outline the normals point outward
    normal = np.stack([x + wave, y, z + 0.02], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    width = 2.5 / size
    ink = (np.abs(np.sqrt(square) - 1 + width) < width) | (inside & (np.abs(y) < width) & (np.abs(x) < 0.5))
    return ink.astype(np.float32), (normal * inside[..., None]).astype(np.float32)


def write_pair(
    sketch: Path, normal: Path, number: int, green: Green = "up", bits: Bits = 8, size: int = SIZE
) -> None:
    """Write a sketch and its normal map, flat off the object; an EXR holds opacity too."""
    ink, vectors = ellipsoid(number, size)
    mask = np.abs(vectors).sum(-1) > 0
    for path in (sketch, normal):
        path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.rint(255 * (1 - ink)).astype(np.uint8)).save(sketch)
    held = flip_green(paint_flat(vectors, mask)) if green == "down" else paint_flat(vectors, mask)
    exr = normal.suffix == ".exr"
    write_bytes(normal, encode_exr(held, mask.astype(np.float32)) if exr else encode_png(held, bits))


def write_pairs(folder: Path, count: int = 10, green: Green = "up", bits: Bits = 8) -> Path:
    """Write ``a0.png`` and ``a0_normal.png`` and so on into a folder, and return it."""
    for number in range(count):
        write_pair(folder / f"a{number}.png", folder / f"a{number}_normal.png", number, green, bits)
    return folder


def hints_picture(number: int, size: int = SIZE) -> Image.Image:
    """Return a transparent picture with the true normal painted at one pixel on the object."""
    _, vectors = ellipsoid(number, size)
    dots = np.zeros((size, size, 4), np.uint8)
    row, column = size // 3, 3 * size // 8
    dots[row, column] = (*np.rint(127.5 * (vectors[row, column] + 1)).astype(np.uint8), 255)
    return Image.fromarray(dots)
