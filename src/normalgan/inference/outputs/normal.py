"""Normal: the file of the normal map itself."""

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

Pack = Literal["normal_specular"]
_REFUSED = frozenset('<>:"|?*\\')
"""Characters that Windows does not allow in file names; maps are passed on to other machines."""


@dataclass(frozen=True)
class Normal(Output):
    """The normal map.

    Args:
        format: format of the map; exr and tiff hold floats. The default is the ending of the file that -o
            names, otherwise png.
        suffix: suffix that follows the drawing's name in the map's name.
        bits: bits per channel of a PNG.
        y: direction of green: up for OpenGL, down for DirectX.
        alpha: write the object's mask as alpha channel.
        pad: width in pixels of a border around the object that repeats the colours of its edge, for engines
            that blend neighbouring pixels. The default is 16 with alpha, pack or engine, otherwise 0, which
            leaves the whole background flat.
        pack: additional channels; normal_specular writes the specular map as alpha channel.
        engine: set y, bits and suffix for an engine, and write its import file.

    Raises:
        InputError: if the settings contradict each other.
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
        """Raise `InputError` if the settings contradict each other."""
        super().__post_init__()
        if self.bits == 16 and self.format != "png":
            raise InputError(f"bits apply to PNG; a map as {self.format} always has 32-bit floats.")
        if self.pack and self.alpha:
            raise InputError(
                "--pack normal_specular and --alpha both write the alpha channel; leave one out."
            )
        if self.suffix and (Path(self.suffix).name != self.suffix or not _REFUSED.isdisjoint(self.suffix)):
            raise InputError(f"the suffix {self.suffix!r} cannot end a file's name; it is like _normal.")

    @property
    def endings(self) -> tuple[str, ...]:
        """The ending of the map's name, such as ``_normal.png``."""
        return (f"{self.suffix}.{self.format}",)

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the map's file."""
        if self.pack == "normal_specular":
            # At least 1/255 on the object, because pixels with zero alpha are written as flat.
            dullest = preds.mask.astype(np.float32) / 255
            preds = replace(preds, alpha=np.maximum(specular_of(preds), dullest))
        pad = PADDING if self.pad is None and self.engine else self.pad
        transparent = self.alpha or bool(self.pack)
        return {self.endings[0]: preds.encode(self.format, self.bits, self.y, transparent, pad)}

    @property
    def plain(self) -> bool:
        """Whether the map is a plain 8-bit picture for no engine, as animations and layered files hold.

        Engines import pictures, and most of them only the first frame of an animation.
        """
        plain = self.format == "png" and self.bits == 8 and self.pack is None
        return plain and not self.pad and self.engine is None

    def sidecar(self, target: Path) -> tuple[Path, bytes] | None:
        """Return the path and content of the engine's import file; None without an engine."""
        return None if self.engine is None else sidecar(self.engine, target)


def engine_defaults(engine: Engine) -> dict[str, object]:
    """Return the default settings of `Normal` for an engine."""
    convention = CONVENTIONS[engine]
    return {"y": convention.y, "bits": convention.bits, "suffix": convention.suffix}
