"""ModelInput: a picture of the network's input."""

from dataclasses import dataclass
from typing import ClassVar

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.normals import encode_grey


@OUTPUTS.register
@dataclass(frozen=True)
class ModelInput(Output):
    """The network's input, as dark lines on white."""

    name: ClassVar[str] = "input"
    label: ClassVar[str] = "What the model saw"
    in_zip: ClassVar[bool] = False
    option: ClassVar[str] = "show_input"

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        return {self.endings[0]: encode_grey(1 - preds.seen)}
