from normalgan.rendering.variation.variation import Variation
from normalgan.rendering.variation.vary import Varied, vary

__all__ = ["Variation", "Varied", "vary"]
