"""What training minimises: adversarial objectives and reconstruction losses, each a plug-in."""

from normalgan.objectives.angular_likelihood import AngularLikelihood
from normalgan.objectives.base import ADVERSARIAL_OBJECTIVES, AdversarialObjective, Critic, Scores
from normalgan.objectives.cosine import CosineAndL2
from normalgan.objectives.cross_entropy import CrossEntropy
from normalgan.objectives.l1_and_hints import L1AndHints
from normalgan.objectives.pixel_losses import hint_loss, l1_loss
from normalgan.objectives.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.objectives.wasserstein import Wasserstein, WassersteinGradientPenalty
from normalgan.predictions import Predictions

__all__ = [
    "ADVERSARIAL_OBJECTIVES",
    "RECONSTRUCTIONS",
    "AdversarialObjective",
    "AngularLikelihood",
    "CosineAndL2",
    "Critic",
    "CrossEntropy",
    "L1AndHints",
    "Predictions",
    "Reconstruction",
    "Scores",
    "Term",
    "Wasserstein",
    "WassersteinGradientPenalty",
    "hint_loss",
    "l1_loss",
]
