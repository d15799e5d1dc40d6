"""What a renderer returns: the normal, depth and mask of every pixel."""

from dataclasses import dataclass

from normalgan.arrays import BoolMask, Floats

__all__ = ["Maps"]


@dataclass(frozen=True)
class Maps:
    """The visible surface, sampled at pixel centres; row 0 is the top of the picture.

    Args:
        normal: (H, W, 3) unit normals in camera space (x right, y up, z to the viewer); 0 off the object.
        depth: (H, W) distance from the camera plane along its axis, in units of the mesh; inf off the
            object.
        mask: (H, W) True on the object.
    """

    normal: Floats
    depth: Floats
    mask: BoolMask
