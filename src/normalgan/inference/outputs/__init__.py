"""Outputs: the files written for a drawing. A new module in this folder is imported by itself."""

from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.inference.outputs.height import Height
from normalgan.inference.outputs.mask import Mask
from normalgan.inference.outputs.model_input import ModelInput
from normalgan.inference.outputs.normal import Normal
from normalgan.inference.outputs.packed import OcclusionRoughnessMetallic, Roughness
from normalgan.inference.outputs.preview import Preview
from normalgan.inference.outputs.relief import Relief
from normalgan.inference.outputs.shading import AmbientOcclusion, Curvature, Specular
from normalgan.registry import import_modules

import_modules(__name__)

__all__ = [
    "OUTPUTS",
    "AmbientOcclusion",
    "Curvature",
    "Height",
    "Mask",
    "ModelInput",
    "Normal",
    "OcclusionRoughnessMetallic",
    "Output",
    "Preview",
    "Relief",
    "Roughness",
    "Specular",
]
