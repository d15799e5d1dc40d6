"""Hints: samplers that choose the pixels with a known normal, and hints as tensors.

Samplers are plug-ins, one module each. A new module in this folder is imported, and so registered, by itself.
"""

from normalgan.hints.base import HINT_SAMPLERS, ErrorHintSampler, HintSampler
from normalgan.hints.curvature import CurvatureHints
from normalgan.hints.encode import hints_at
from normalgan.hints.farthest import FarthestPointHints
from normalgan.hints.none import NoHints
from normalgan.hints.normal_curvature import curvature_map
from normalgan.hints.uniform import UniformHints
from normalgan.hints.worst import WorstErrorHints
from normalgan.registry import import_modules

import_modules(__name__)

__all__ = [
    "HINT_SAMPLERS",
    "CurvatureHints",
    "ErrorHintSampler",
    "FarthestPointHints",
    "HintSampler",
    "NoHints",
    "UniformHints",
    "WorstErrorHints",
    "curvature_map",
    "hints_at",
]
