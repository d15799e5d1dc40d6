"""Poisson-disk hints for normalgan."""

from normalgan_poisson.sampler import PoissonHints

__all__ = ["PoissonHints"]
