"""Packed maps: several shading maps in the channels of one picture, for PBR engines."""

from dataclasses import dataclass
from typing import ClassVar

import cv2
import numpy as np

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.inference.outputs.shading import occlusion_of, specular_of
from normalgan.normals import encode_grey, pack_png


@OUTPUTS.register
@dataclass(frozen=True)
class Roughness(Output):
    """The roughness, one minus the specular map."""

    name: ClassVar[str] = "roughness"
    label: ClassVar[str] = "Roughness"
    in_zip: ClassVar[bool] = False  # it is the specular map inverted

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        return {self.endings[0]: encode_grey(1 - specular_of(preds))}


@OUTPUTS.register
@dataclass(frozen=True)
class OcclusionRoughnessMetallic(Output):
    """Occlusion, roughness and metallic in red, green and blue, as glTF, Unreal and Godot read them."""

    name: ClassVar[str] = "orm"
    label: ClassVar[str] = "Occlusion, roughness, metallic"
    in_zip: ClassVar[bool] = False  # it packs maps that the zip holds

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file; metallic is 0 everywhere, because drawings do not show it."""
        rough = 1 - specular_of(preds)
        channels = cv2.merge([np.zeros_like(rough), rough, occlusion_of(preds)])  # BGR order
        return {self.endings[0]: pack_png(np.rint(255 * np.clip(channels, 0, 1)).astype(np.uint8))}
