"""NormalMap: the result of a prediction, with its normals, mask and confidence."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Literal, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.inference.composites.cells import Cell
from normalgan.inference.findings import Finding, join
from normalgan.inference.network.tile import Tile
from normalgan.inference.regions import box_of
from normalgan.inference.vectors import unit
from normalgan.normals import (
    Bits,
    Green,
    encode_exr,
    encode_tiff,
    flip_green,
    pack_png,
    pad_edge,
    paint_flat,
    pixels_of,
    strips,
)

PADDING = 16
"""Default width in pixels of the padding around the object; the fourth mipmap level blends 16 pixels."""

Format = Literal["png", "exr", "tiff"]
_FLAT = np.array([[[0, 0, 1]]], np.float32)
_SUFFIXES: dict[str, Format] = {".png": "png", ".exr": "exr", ".tif": "tiff", ".tiff": "tiff"}


@dataclass(frozen=True, eq=False, repr=False)
class NormalMap:
    """A normal map with its mask, confidence and findings; axes are x right, y up, z to the viewer.

    Args:
        extended: (H, W, 3), unit normals everywhere; off the object they continue the object's normals
            smoothly.
        mask: (H, W), the object.
        alpha: (H, W) in [0, 1], the drawing's opacity if the mask comes from it, otherwise the mask with a
            soft edge.
        seen: (S, S), the network's input; blank for a map that no network predicted.
        confidence: (H, W), the network's confidence κ ≥ 0, or None.
        findings: findings about the map; `warning` returns them as text.
        tile: directions in which the map repeats; None if it does not.
        cells: the drawings of a sheet, each a separate surface; empty for other maps. A rotated drawing has
            the normals of the upright drawing.
        partial: whether something in the drawing could not be predicted; the findings say what.
    """

    extended: Floats
    mask: NDArray[np.bool_]
    alpha: Floats
    seen: Floats = field(default_factory=lambda: np.zeros((8, 8), np.float32))
    confidence: Floats | None = None
    findings: tuple[Finding, ...] = ()
    tile: Tile | None = None
    cells: tuple[Cell, ...] = ()
    partial: bool = False

    def __repr__(self) -> str:
        height, width = self.mask.shape
        said = f", warning={self.warning!r}" if self.warning else ""
        return f"<NormalMap of {width} × {height} pixels, {self.mask.mean():.0%} of them the object{said}>"

    @property
    def warning(self) -> str:
        """The findings as part of a sentence; empty if there are none."""
        return join(self.findings)

    @cached_property
    def normal(self) -> Floats:
        """Unit normals (H, W, 3) on the object, and zero off it."""
        return np.where(self.mask[..., None], self.extended, np.float32(0))

    def stronger(self, strength: float) -> "NormalMap":
        """Return the map with its slopes multiplied by ``strength``.

        Raises:
            InputError: if the strength is negative or more than 100.
        """
        if not 0 <= strength <= 100:
            raise InputError(f"strength is {strength}; use 0 to 100; 1 changes nothing.")
        if strength == 1:
            return self
        scaled = self.extended * np.array([strength, strength, 1], np.float32)
        return replace(self, extended=unit(scaled, front=True))

    def height(self) -> Floats:
        """Return the height (H, W) of the surface in pixels towards the viewer.

        The mean over each connected part is zero, and so are all heights off the object; see
        `normalgan.inference.heights.height.integrate`.
        """
        return self._height.copy()

    @cached_property
    def _height(self) -> Floats:
        from normalgan.inference.heights.height import integrate  # here because its solver is slow to import

        if not self.cells:
            return integrate(self.extended, self.mask, tile=self.tile)
        whole = np.zeros(self.mask.shape, np.float32)
        for cell in self.cells:
            cell.put(whole, part_of(self, cell).height())
        return whole

    def encode(
        self,
        form: Format = "png",
        bits: Bits = 8,
        y: Green = "up",
        alpha: bool = False,
        pad: int | None = None,
    ) -> bytes:
        """Return the content of an image file, which is flat or transparent off the object.

        Args:
            form: format of the file; exr and tiff hold floats.
            bits: bits per channel of a PNG.
            y: direction of green: ``up`` for OpenGL, ``down`` for DirectX.
            alpha: whether the file has an alpha channel with the object's opacity.
            pad: width in pixels of a border around the object that repeats the colours of its edge; None uses
                `PADDING` with alpha, where the border is invisible, otherwise 0.
        """
        opacity = self.alpha if alpha else None
        reach = (PADDING if alpha else 0) if pad is None else pad
        match form:
            case "png":
                pixels = self._pixels(bits, y, alpha, blue_first=True)
                pad_edge(pixels, self._opaque(alpha), reach)
                return pack_png(pixels)
            case "exr":
                return encode_exr(self._flat(y, alpha, reach), opacity)
            case "tiff":
                return encode_tiff(self._flat(y, alpha, reach), opacity)

    def pixels(self, y: Green = "up", alpha: bool = False) -> NDArray[np.uint8]:
        """Return the map as 8-bit colours (H, W, 3), or (H, W, 4) with alpha; see `encode`."""
        return np.asarray(self._pixels(8, y, alpha), np.uint8)

    def _pixels(
        self, bits: Bits, y: Green, alpha: bool, *, blue_first: bool = False
    ) -> NDArray[np.uint8] | NDArray[np.uint16]:
        opaque = self._opaque(alpha)
        none = np.zeros((1, 1), np.float32)
        flat = pixels_of(_FLAT, bits, none if alpha else None, blue_first=blue_first)
        pixels = np.empty((*opaque.shape, flat.shape[-1]), flat.dtype)
        pixels[:] = np.repeat(flat, opaque.shape[1], axis=1)
        # Only the object's bounding box is computed, which is about half of a typical map.
        top, bottom, left, right = box_of(opaque)
        box = np.s_[top:bottom, left:right]
        inside, there, normals = pixels[box], opaque[box].view(np.uint8), self.extended[box]
        for rows in strips(inside.shape):
            turned = flip_green(normals[rows]) if y == "down" else normals[rows]
            opacity = self.alpha[box][rows] if alpha else None
            colours = pixels_of(turned, bits, opacity, blue_first=blue_first)
            inside[rows] = cv2.copyTo(colours, there[rows], inside[rows])
        return pixels

    def _opaque(self, alpha: bool) -> NDArray[np.bool_]:
        """Return the pixels (H, W) whose colours are written; all others are flat."""
        return self.alpha > 0 if alpha else self.mask

    def _flat(self, y: Green, alpha: bool, pad: int) -> Floats:
        normals = paint_flat(self.extended, self._opaque(alpha))
        pad_edge(normals, self._opaque(alpha), pad)
        return flip_green(normals) if y == "down" else normals

    def save(
        self, path: str | Path, bits: Bits = 8, y: Green = "up", alpha: bool = False, pad: int | None = None
    ) -> None:
        """Write the map atomically as PNG, EXR or TIFF, depending on the path's ending.

        Args:
            path: path of the file; missing folders are created.
            bits: bits per channel of a PNG, 8 or 16.
            y: direction of green: ``up`` for OpenGL, ``down`` for DirectX.
            alpha: whether the file has an alpha channel with the object's opacity.
            pad: width in pixels of a border that repeats the colours of the object's edge, as in `encode`.

        Raises:
            InputError: if an argument is invalid.
            OSError: if the file cannot be written.
        """
        form = _SUFFIXES.get(Path(path).suffix.lower())
        if form is None:
            raise InputError(f"the normal map {path} must end in one of {' '.join(_SUFFIXES)}.")
        if bits not in get_args(Bits) or (bits == 16 and form != "png"):
            raise InputError(
                f"{bits} bits are not supported for {path}; a PNG has 8 or 16, other formats hold floats."
            )
        if y not in get_args(Green):
            raise InputError(f"y is up or down, not {y!r}.")
        write_bytes(path, self.encode(form, bits, y, alpha, pad))

    def _repr_png_(self) -> bytes:
        """Return the map as a PNG for notebooks."""
        return self.encode()


def part_of(sheet: NormalMap, cell: Cell) -> NormalMap:
    """Return the map of one drawing of a sheet, rotated upright."""
    mask = sheet.mask[cell.box] if cell.own is None else sheet.mask[cell.box] & cell.own
    confidence = None if sheet.confidence is None else cell.upright(sheet.confidence[cell.box])
    return NormalMap(
        np.ascontiguousarray(cell.upright(sheet.extended[cell.box])),
        np.ascontiguousarray(cell.upright(mask)),
        cell.upright(sheet.alpha[cell.box]),
        sheet.seen,
        confidence,
        sheet.findings,
        cell.tile,
    )


def as_it_lies(sheet: NormalMap) -> Floats:
    """Return the normals (H, W, 3) of a sheet viewed as one picture.

    A sheet's map holds the normals of upright sprites. Here the normals of rotated sprites are rotated as
    well.
    """
    if not any(cell.turned for cell in sheet.cells):
        return sheet.extended
    whole = sheet.extended.copy()
    for cell in (each for each in sheet.cells if each.turned):
        x, y, z = np.moveaxis(sheet.extended[cell.box], -1, 0)
        for _ in range(cell.turned):
            x, y = y, -x  # a clockwise quarter turn
        whole[cell.box] = np.stack([x, y, z], -1)
    return whole
