"""Normal: the normal map itself, as each program wants it."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np

from normalgan.errors import InputError
from normalgan.inference.normal_map import PADDING, Format, NormalMap
from normalgan.inference.outputs.base import Output
from normalgan.inference.outputs.engines import CONVENTIONS, Engine, sidecar
from normalgan.inference.outputs.shading import specular_of
from normalgan.normals import Bits, Green
from normalgan.ranges import Range

__all__ = ["Normal", "Pack", "engine_defaults"]

Pack = Literal["normal_specular"]


@dataclass(frozen=True)
class Normal(Output):
    """The normal map.

    Args:
        format: format of the map; exr and tiff hold floats; by default from the file that -o names, else png.
        suffix: ending of the map's name, after the drawing's.
        bits: bits of each channel of a PNG.
        y: where green points: up as in OpenGL, down as in DirectX.
        alpha: write the mask of the object as alpha channel.
        pad: pixels around the object that get the colour of its edge, for engines that blend neighbours;
            by default 16 with alpha, pack or engine, else 0, which leaves the whole background flat.
        pack: further channels: normal_specular writes the specular map as alpha channel.
        engine: sets y, bits and suffix for an engine, and writes the file by which it imports the map.

    Raises:
        InputError: if they do not go together.
    """

    name: ClassVar[str] = "normal"
    label: ClassVar[str] = "Normal map"

    format: Format = "png"
    suffix: str = "_normal"
    bits: Bits = 8
    y: Green = "up"
    alpha: bool = False
    pad: Annotated[int, Range(0, 1024)] | None = None
    pack: Pack | None = None
    engine: Engine | None = None

    def __post_init__(self) -> None:
        """Refuse settings that contradict each other."""
        super().__post_init__()
        if self.bits == 16 and self.format != "png":
            raise InputError(f"bits apply to PNG; a map as {self.format} always has 32-bit floats.")
        if self.pack and self.alpha:
            raise InputError(
                "--pack normal_specular and --alpha both write the alpha channel; leave one out."
            )
        if self.suffix and Path(self.suffix).name != self.suffix:
            raise InputError(f"the suffix {self.suffix!r} cannot end a file's name; it is like _normal.")

    @property
    def endings(self) -> tuple[str, ...]:
        """The ending of the map's name, such as ``_normal.png``."""
        return (f"{self.suffix}.{self.format}",)

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the map's file."""
        if self.pack == "normal_specular":
            # On the object at least one level of 8 bits: what has none there is written as flat.
            dullest = preds.mask.astype(np.float32) / 255
            preds = replace(preds, alpha=np.maximum(specular_of(preds), dullest))
        pad = PADDING if self.pad is None and self.engine else self.pad
        transparent = self.alpha or bool(self.pack)
        return {self.endings[0]: preds.encode(self.format, self.bits, self.y, transparent, pad)}

    @property
    def plain(self) -> bool:
        """Whether the map is a picture of 8 bits, not packed or padded, as animations and layers hold."""
        return self.format == "png" and self.bits == 8 and self.pack is None and not self.pad

    def sidecar(self, target: Path) -> tuple[Path, bytes] | None:
        """Return the file by which the engine imports a map, and its content; None without an engine."""
        return None if self.engine is None else sidecar(self.engine, target)


def engine_defaults(engine: Engine) -> dict[str, object]:
    """Return the settings of `Normal` that an engine sets, unless the user does."""
    convention = CONVENTIONS[engine]
    return {"y": convention.y, "bits": convention.bits, "suffix": convention.suffix}
