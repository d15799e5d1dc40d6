from normalgan.rendering.variation.variation import Variation
from normalgan.rendering.variation.varied import Varied
from normalgan.rendering.variation.vary import vary

__all__ = ["Variation", "Varied", "vary"]
