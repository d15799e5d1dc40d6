"""Losses: adversarial objectives and reconstruction losses, each a plug-in."""

from normalgan.losses.adversarial import ADVERSARIAL_OBJECTIVES, AdversarialObjective, Critic, Scores
from normalgan.losses.angular_likelihood import AngularLikelihood
from normalgan.losses.cosine import CosineAndL2
from normalgan.losses.cross_entropy import CrossEntropy
from normalgan.losses.l1_and_hints import L1AndHints, hint_loss, l1_loss
from normalgan.losses.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.losses.wasserstein import Wasserstein, WassersteinGradientPenalty
from normalgan.models.predictions import Predictions
from normalgan.registry import import_modules

import_modules(__name__)

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
