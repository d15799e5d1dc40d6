"""Relief: the object as a closed mesh."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.ranges import Range

_FEWEST = 12
"""Minimum number of triangles of a closed relief."""


@OUTPUTS.register
@dataclass(frozen=True)
class Relief(Output):
    """A relief mesh.

    Args:
        format: glb is a single file for engines, obj is text for other programs.
        faces: maximum number of triangles; by default four per pixel.

    Raises:
        InputError: if ``faces`` is less than a closed relief needs.
    """

    name: ClassVar[str] = "relief"
    label: ClassVar[str] = "Relief mesh"
    in_zip: ClassVar[bool] = False

    format: Literal["glb", "obj"] = "glb"
    faces: Annotated[int, Range(_FEWEST)] | None = None

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        # Here because trimesh is slow to import.
        from normalgan.inference.heights.relief_mesh import encode_relief, relief_mesh, simpler

        shape = preds.height(), preds.mask
        simple = shape if self.faces is None else simpler(*shape, self.faces)
        return {self.endings[0]: encode_relief(relief_mesh(*simple), self.format)}
