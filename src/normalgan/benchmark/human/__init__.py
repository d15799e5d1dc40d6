"""Drawings by people of objects with known normals: reading and measuring."""

from normalgan.benchmark.human.command import human

__all__ = ["human"]
