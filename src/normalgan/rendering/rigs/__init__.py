from normalgan.rendering.rigs.files import RiggedFile, find_poses

__all__ = ["RiggedFile", "find_poses"]
