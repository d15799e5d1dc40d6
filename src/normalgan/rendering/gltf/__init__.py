"""glTF 2.0: container, accessors, nodes, and the triangles of the scene.

trimesh's reader ignores skins and animations, which `normalgan.rendering.rigs` reads from the same container.
"""

__all__ = []
