"""Poisson-disk hints for normalgan, pairs of pebbles to train on, and the error of the worst picture."""

from normalgan_poisson.pebbles import Pebbles
from normalgan_poisson.sampler import PoissonHints
from normalgan_poisson.worst import WorstPicture

__all__ = ["Pebbles", "PoissonHints", "WorstPicture"]
