from normalgan.rendering.rigs.clips import ClipMeshes
from normalgan.rendering.rigs.files import RiggedFile, find_poses

__all__ = ["ClipMeshes", "RiggedFile", "find_poses"]
