"""Renderers: normal, depth and mask of a mesh viewed by a camera."""

from normalgan.registry import import_modules
from normalgan.rendering.renderers.base import RENDERERS, Renderer
from normalgan.rendering.renderers.embree import EmbreeRenderer
from normalgan.rendering.renderers.pyrender import PyrenderRenderer

import_modules(__name__)

__all__ = ["RENDERERS", "EmbreeRenderer", "PyrenderRenderer", "Renderer"]
