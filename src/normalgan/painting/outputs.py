"""Outputs: what is written for a drawing: its normal map; on request pictures, a height map, a relief."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from normalgan.errors import InputError
from normalgan.files import write_bytes
from normalgan.normals import Bits, Floats, Green, encode_grey
from normalgan.painting.jobs import Job
from normalgan.painting.normal_map import Format, NormalMap

__all__ = ["Outputs", "encode_height"]


@dataclass(frozen=True)
class Outputs:
    """What is to be written for each drawing.

    Args:
        suffix: of the map's name, after the drawing's.
        format: of the map; exr and tiff hold floats.
        bits: of each channel of a PNG.
        y: up is green as in OpenGL, down as in DirectX.
        alpha: write the object's mask as alpha channel.
        show_input: write what the model saw.
        preview: write the map under a lamp that goes around it.
        height: write a height map: png is 16 bits from the lowest to the highest, tiff floats in pixels.
        relief: write a relief mesh.

    Raises:
        InputError: if they do not go together.
    """

    suffix: str = "_normal"
    format: Format = "png"
    bits: Bits = 8
    y: Green = "up"
    alpha: bool = False
    show_input: bool = False
    preview: Literal["png", "gif"] | None = None
    height: Literal["png", "tiff"] | None = None
    relief: Literal["glb", "obj"] | None = None

    def __post_init__(self) -> None:
        if self.bits not in {8, 16}:
            raise InputError(f"the bits of a normal map are 8 or 16, not {self.bits}.")
        if self.bits == 16 and self.format != "png":
            raise InputError(f"bits are of a PNG; a map as {self.format} always has floats of 32 bits.")
        if self.suffix and Path(self.suffix).name != self.suffix:
            raise InputError(f"the suffix {self.suffix!r} is no part of a file's name; it is like _normal.")

    @property
    def ending(self) -> str:
        """What a map's name ends in, such as ``_normal.png``."""
        return f"{self.suffix}.{self.format}"

    def others(self) -> Iterator[str]:
        """Yield what the names of everything else end in."""
        if self.show_input:
            yield "_input.png"
        for name in ("preview", "height", "relief"):
            if kind := getattr(self, name):
                yield f"_{name}.{kind}"

    def write(self, job: Job, preds: NormalMap) -> None:
        """Write what belongs to a drawing, each file whole or not at all.

        Raises:
            OSError: if a file cannot be written.
        """
        self.write_others(job, preds)
        self.write_map(job, preds)  # last, so that where there is a map, there is the rest too

    def write_map(self, job: Job, preds: NormalMap) -> None:
        """Write the map alone."""
        write_bytes(job.target, preds.encode(self.format, self.bits, self.y, self.alpha))

    def write_others(self, job: Job, preds: NormalMap) -> None:
        """Write all but the map."""
        if self.show_input:
            write_bytes(job.beside("_input.png"), encode_grey(1 - preds.seen))
        if self.preview is not None:
            from normalgan.painting.preview import preview_gif, preview_png

            lit = preview_png if self.preview == "png" else preview_gif
            write_bytes(job.beside(f"_preview.{self.preview}"), lit(preds.extended, preds.mask))
        if self.height is not None or self.relief is not None:
            self._write_relief(job, preds)

    def _write_relief(self, job: Job, preds: NormalMap) -> None:
        from normalgan.painting.relief import relief_mesh, write_relief

        height = preds.height()
        if self.height is not None:
            write_bytes(job.beside(f"_height.{self.height}"), encode_height(height, preds, self.height))
        if self.relief is not None:
            write_relief(job.beside(f"_relief.{self.relief}"), relief_mesh(height, preds.mask))


def encode_height(height: Floats, preds: NormalMap, kind: Literal["png", "tiff"]) -> bytes:
    """Return the content of a height map's file.

    Args:
        height: (H, W) in pixels, as `NormalMap.height` gives it.
        preds: the map it is of.
        kind: png is 16 bits from the lowest to the highest, tiff floats in pixels.
    """
    inside = height[preds.mask]
    if kind == "tiff":
        return encode_grey(np.where(preds.mask, height, inside.min()), ".tiff")
    spread = max(float(np.ptp(inside)), 1e-6)
    return encode_grey(np.where(preds.mask, (height - inside.min()) / spread, 0), ".png", 16)
