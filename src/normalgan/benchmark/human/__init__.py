"""Read and measure drawings by people of objects with known normals."""

from normalgan.benchmark.human.command import human

__all__ = ["human"]
