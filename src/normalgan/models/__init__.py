"""Networks: generators and discriminators, each a plug-in."""

from normalgan.models.base import DISCRIMINATORS, GENERATORS, INPUT_CHANNELS, Discriminator, Generator
from normalgan.models.global_discriminator import GlobalDiscriminator
from normalgan.models.patch_discriminator import PatchDiscriminator
from normalgan.models.predictions import Predictions
from normalgan.models.residual_unet import ResidualUNetGenerator
from normalgan.models.tiled_generator import TiledGenerator
from normalgan.models.unet import UNetDiscriminator, UNetGenerator
from normalgan.registry import import_modules

import_modules(__name__)

__all__ = [
    "DISCRIMINATORS",
    "GENERATORS",
    "INPUT_CHANNELS",
    "Discriminator",
    "Generator",
    "GlobalDiscriminator",
    "PatchDiscriminator",
    "Predictions",
    "ResidualUNetGenerator",
    "TiledGenerator",
    "UNetDiscriminator",
    "UNetGenerator",
]
