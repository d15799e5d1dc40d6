"""Renderers: normal, depth and mask of a mesh viewed by a camera."""

from normalgan.rendering.renderers.base import RENDERERS, Renderer
from normalgan.rendering.renderers.embree import EmbreeRenderer
from normalgan.rendering.renderers.pyrender import PyrenderRenderer

__all__ = ["RENDERERS", "EmbreeRenderer", "PyrenderRenderer", "Renderer"]
