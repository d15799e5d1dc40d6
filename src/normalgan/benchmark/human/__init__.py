"""Drawings by people of objects whose mesh and camera are known: read in public layouts and measured."""

from normalgan.benchmark.human.command import human

__all__ = ["human"]
