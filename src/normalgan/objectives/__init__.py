"""What training minimises: adversarial objectives, each a plug-in, and the reconstruction losses."""

from normalgan.objectives.base import ADVERSARIAL_OBJECTIVES, AdversarialObjective, Scores
from normalgan.objectives.cross_entropy import CrossEntropy
from normalgan.objectives.gradient_penalty import WassersteinGradientPenalty
from normalgan.objectives.reconstruction import hint_loss, l1_loss
from normalgan.objectives.wasserstein import Wasserstein

__all__ = [
    "ADVERSARIAL_OBJECTIVES",
    "AdversarialObjective",
    "CrossEntropy",
    "Scores",
    "Wasserstein",
    "WassersteinGradientPenalty",
    "hint_loss",
    "l1_loss",
]
