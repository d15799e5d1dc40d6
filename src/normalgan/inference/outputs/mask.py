"""Mask: a picture of the object's mask."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.inference.outputs.engines import Engine
from normalgan.normals import encode_grey


@OUTPUTS.register
@dataclass(frozen=True)
class Mask(Output):
    """The mask of the object, white on black with a soft edge."""

    name: ClassVar[str] = "mask"
    label: ClassVar[str] = "Mask"
    option: ClassVar[str] = "show_mask"
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {"unity": "_Mask", "unreal": "_M"}

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        return {self.endings[0]: encode_grey(preds.alpha)}
