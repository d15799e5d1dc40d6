"""An output: an additional file for each normal map."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs import OUTPUTS, Output
from normalgan.normals import encode_grey
from normalgan.testing import check


@OUTPUTS.register
@dataclass(frozen=True)
class Slope(Output):
    """The slope at each pixel.

    Args:
        format: format of the picture.
        steepest: the slope in degrees that becomes white.
    """

    name: ClassVar[str] = "slope"
    label: ClassVar[str] = "Slope"

    steepest: float = 90.0

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the contents of the file."""
        degrees = np.rad2deg(np.arccos(np.clip(preds.extended[..., 2], -1, 1)))
        picture = np.where(preds.mask, degrees / self.steepest, 0).astype(np.float32)
        return {self.endings[0]: encode_grey(picture)}


if __name__ == "__main__":
    check(Slope())
