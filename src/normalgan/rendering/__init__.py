"""Rendering of meshes to normal maps and sketches; does not need torch."""

from normalgan.rendering.cameras import Camera, Views
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh, MeshSource
from normalgan.rendering.mesh_files import MeshFile, find_meshes
from normalgan.rendering.renderers import RENDERERS, EmbreeRenderer, PyrenderRenderer, Renderer

__all__ = [
    "RENDERERS",
    "Camera",
    "EmbreeRenderer",
    "Maps",
    "Mesh",
    "MeshFile",
    "MeshSource",
    "PyrenderRenderer",
    "Renderer",
    "Views",
    "find_meshes",
]
