"""Height: the height map of a predicted map."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from normalgan.errors import InputError
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import OUTPUTS, Output, Scaled
from normalgan.inference.outputs.engines import Engine
from normalgan.normals import encode_grey
from normalgan.ranges import Positive


@OUTPUTS.register
@dataclass(frozen=True)
class Height(Output):
    """A height map.

    Args:
        format: png has 16 bits from the lowest to the highest point; tiff holds floats in pixels.
        height_scale: height difference between black and white of a png, in pixels; batch uses the
            largest of all drawings.

    Raises:
        InputError: if the settings contradict each other.
    """

    name: ClassVar[str] = "height"
    label: ClassVar[str] = "Height map"
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {"unity": "_Height", "unreal": "_H"}
    engine_formats: ClassVar[Mapping[Engine, str]] = {"blender": "tiff"}

    format: Literal["png", "tiff"] = "png"
    height_scale: Positive | Literal["batch"] | None = None

    def __post_init__(self) -> None:
        """Raise `InputError` if the settings contradict each other."""
        super().__post_init__()
        if self.height_scale is not None and self.format != "png":
            raise InputError(f"a height scale applies to PNG; a height map as {self.format} holds pixels.")

    @property
    def whole_batch(self) -> bool:
        """Whether all drawings of a command share one scale."""
        return self.height_scale == "batch"

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        height = preds.height()
        inside = height[preds.mask] if preds.mask.any() else np.zeros(1, np.float32)
        if self.format == "tiff":
            return {self.endings[0]: encode_grey(np.where(preds.mask, height, inside.min()), ".tiff")}
        spread = max(float(np.ptp(inside)), 1e-6)
        if isinstance(self.height_scale, float | int):
            spread = float(self.height_scale)
        levels = np.where(preds.mask, (height - inside.min()) / spread, 0)
        return {self.endings[0]: Scaled(encode_grey(levels, ".png", 16), spread)}
