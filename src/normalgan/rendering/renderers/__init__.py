"""Renderers: from a mesh and a camera to normal, depth and mask."""

from normalgan.rendering.renderers.base import RENDERERS, Renderer
from normalgan.rendering.renderers.embree import EmbreeRenderer
from normalgan.rendering.renderers.pyrender import PyrenderRenderer

__all__ = ["RENDERERS", "EmbreeRenderer", "PyrenderRenderer", "Renderer"]
