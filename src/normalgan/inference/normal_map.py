"""NormalMap: the result of a prediction, with normals, mask and confidence, as arrays, pictures and files."""

from dataclasses import dataclass, replace
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

__all__ = ["PADDING", "Format", "NormalMap", "as_it_lies", "part_of"]

PADDING = 16
"""Pixels around the object that carry the colour of its edge: the fourth mipmap blends as many."""

Format = Literal["png", "exr", "tiff"]
_FLAT = np.array([[[0, 0, 1]]], np.float32)
_SUFFIXES: dict[str, Format] = {".png": "png", ".exr": "exr", ".tif": "tiff", ".tiff": "tiff"}


@dataclass(frozen=True, eq=False, repr=False)
class NormalMap:
    """A normal map and its mask, confidence and notes; axes are x right, y up, z to the viewer.

    Args:
        extended: (H, W, 3), unit everywhere: off the object they are those on it, smoothly continued.
        mask: (H, W), the object.
        alpha: (H, W) in [0, 1], the drawing's opacity if that gives the mask, else the mask with a soft edge.
        seen: (S, S), the network's input.
        confidence: (H, W), the network's confidence κ ≥ 0, if it has one.
        findings: findings about it; `warning` puts them into words.
        tile: the directions in which the map repeats; None for none.
        cells: the drawings of a sheet, each a separate surface; none for other maps. A turned drawing has
            the normals of the upright one.
        partial: whether something that is drawn could not be predicted, as the findings say.
    """

    extended: Floats
    mask: NDArray[np.bool_]
    alpha: Floats
    seen: Floats
    confidence: Floats | None
    findings: tuple[Finding, ...]
    tile: Tile | None = None
    cells: tuple[Cell, ...] = ()
    partial: bool = False

    def __repr__(self) -> str:
        height, width = self.mask.shape
        said = f", warning={self.warning!r}" if self.warning else ""
        return f"<NormalMap of {width} × {height} pixels, {self.mask.mean():.0%} of them the object{said}>"

    @property
    def warning(self) -> str:
        """The warning, a part of a sentence; empty if there is none."""
        return join(self.findings)

    @cached_property
    def normal(self) -> Floats:
        """(H, W, 3), unit normals on the object and zero off it."""
        return np.where(self.mask[..., None], self.extended, np.float32(0))

    def stronger(self, strength: float) -> "NormalMap":
        """Return the map with its slopes multiplied by a factor.

        Raises:
            InputError: if the strength is invalid: negative, or more than 100.
        """
        if not 0 <= strength <= 100:
            raise InputError(f"strength is {strength}; use 0 to 100; 1 changes nothing.")
        if strength == 1:
            return self
        scaled = self.extended * np.array([strength, strength, 1], np.float32)
        return replace(self, extended=unit(scaled, front=True))

    def height(self) -> Floats:
        """Return the surface that the normals belong to, (H, W) in pixels towards the viewer.

        It has a mean of zero over each connected part and is zero off the object; see
        `normalgan.inference.heights.height.integrate`.
        """
        return self._height.copy()

    @cached_property
    def _height(self) -> Floats:
        from normalgan.inference.heights.height import integrate  # here: its solver takes a while to import

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
        """Return the content of a file: flat off the object, or transparent there.

        Args:
            form: format of the file; exr and tiff hold floats.
            bits: bits of each channel of a PNG.
            y: up is green as in OpenGL, down as in DirectX.
            alpha: whether the object's mask is the alpha channel.
            pad: how many pixels around the object carry the colour of its edge; None takes `PADDING` with
                alpha, where they are invisible, else 0.
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
        """Return the map's colours of 8 bits, (H, W, 3), or (H, W, 4) with alpha; see `encode`."""
        return np.asarray(self._pixels(8, y, alpha), np.uint8)

    def _pixels(
        self, bits: Bits, y: Green, alpha: bool, *, blue_first: bool = False
    ) -> NDArray[np.uint8] | NDArray[np.uint16]:
        opaque = self._opaque(alpha)
        none = np.zeros((1, 1), np.float32)
        flat = pixels_of(_FLAT, bits, none if alpha else None, blue_first=blue_first)
        pixels = np.empty((*opaque.shape, flat.shape[-1]), flat.dtype)
        pixels[:] = np.repeat(flat, opaque.shape[1], axis=1)
        # Only the box of the object is computed, which is half of most maps.
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
        """Return where a file holds the map's own colours."""
        return self.alpha > 0 if alpha else self.mask

    def _flat(self, y: Green, alpha: bool, pad: int) -> Floats:
        normals = paint_flat(self.extended, self._opaque(alpha))
        pad_edge(normals, self._opaque(alpha), pad)
        return flip_green(normals) if y == "down" else normals

    def save(
        self,
        path: str | Path,
        bits: Bits = 8,
        y: Green = "up",
        alpha: bool = False,
        pad: int | None = None,
    ) -> None:
        """Write the map atomically, as PNG, EXR or TIFF by the path's ending.

        Args:
            path: path of the file; its folder is made where missing.
            bits: bits of each channel of a PNG, 8 or 16.
            y: ``up`` is green as in OpenGL, ``down`` as in DirectX.
            alpha: whether the object's mask is the alpha channel.
            pad: how many pixels around the object carry the colour of its edge, as for `encode`.

        Raises:
            InputError: if a setting cannot be used.
            OSError: if the file cannot be written.
        """
        form = _SUFFIXES.get(Path(path).suffix.lower())
        if form is None:
            raise InputError(f"the normal map {path} must end in one of {' '.join(_SUFFIXES)}.")
        if bits not in get_args(Bits) or (bits == 16 and form != "png"):
            raise InputError(f"bits are 8 or 16, of a PNG; {path} with {bits} is neither.")
        if y not in get_args(Green):
            raise InputError(f"y is up or down, not {y!r}.")
        write_bytes(path, self.encode(form, bits, y, alpha, pad))

    def _repr_png_(self) -> bytes:
        """Return the map as a picture for notebooks."""
        return self.encode()


def part_of(sheet: NormalMap, cell: Cell) -> NormalMap:
    """Return the map of one drawing of a sheet, upright."""
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
    """Return the normals of a sheet seen as one picture, (H, W, 3).

    The map holds normals of upright sprites; the normals of rotated sprites are rotated too.
    """
    if not any(cell.turned for cell in sheet.cells):
        return sheet.extended
    whole = sheet.extended.copy()
    for cell in (each for each in sheet.cells if each.turned):
        x, y, z = np.moveaxis(sheet.extended[cell.box], -1, 0)
        for _ in range(cell.turned):
            x, y = y, -x  # clockwise by a quarter
        whole[cell.box] = np.stack([x, y, z], -1)
    return whole
