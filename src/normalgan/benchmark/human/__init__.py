"""Drawings by people of objects whose normals are known: read in one layout and measured."""

from normalgan.benchmark.human.command import human

__all__ = ["human"]
