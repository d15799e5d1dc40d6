"""Small scenes that tests train and measure on: spheres of different places and sizes."""

import torch
from torch.utils.data import DataLoader, Dataset

from normalgan.batch import Batch


def sphere(size: int, x: float, y: float, radius: float) -> dict[str, torch.Tensor]:
    """A sphere at (x, y) of the given radius, in units of half the frame: sketch, normal and mask."""
    along = (torch.arange(size) + 0.5) / size * 2 - 1
    u = (along[None, :].expand(size, size) - x) / radius
    v = (-along[:, None].expand(size, size) - y) / radius
    distance = (u**2 + v**2).sqrt()
    mask = (distance < 1).float()
    normal = torch.stack([u, v, (1 - distance**2).clamp(min=0).sqrt()]) * mask
    sketch = ((distance - 1).abs() * radius * size / 2 < 0.8).float()
    return {"sketch": sketch[None], "normal": normal, "mask": mask[None]}


class Spheres(Dataset[dict[str, torch.Tensor]]):
    """A number of spheres, the same ones for the same seed."""

    def __init__(self, count: int = 8, size: int = 32, seed: int = 0) -> None:
        rng = torch.Generator().manual_seed(seed)
        places = torch.rand(count, 3, generator=rng)
        self.samples = [
            sphere(size, float(a - 0.5) / 2, float(b - 0.5) / 2, 0.4 + 0.3 * float(c)) for a, b, c in places
        ]

    def __len__(self) -> int:
        return len(self.samples)

    def __getitem__(self, index: int) -> dict[str, torch.Tensor]:
        return self.samples[index]


def loader(
    count: int = 8, size: int = 32, batch_size: int = 2, seed: int = 0
) -> DataLoader[dict[str, torch.Tensor]]:
    """Batches of spheres in a fixed order."""
    return DataLoader(Spheres(count, size, seed), batch_size=batch_size)


def batch(count: int = 2, size: int = 32) -> Batch:
    """One batch of spheres."""
    whole: Batch = next(iter(loader(count, size, count)))
    return whole
