"""Samples for the metrics, and the metrics by their definitions in numpy."""

import numpy as np
import torch
from torch import Tensor
from torchmetrics import MetricCollection

Sample = tuple[Tensor, Tensor, Tensor]


def random_batch(seed: int, size: int = 24) -> Sample:
    """Predictions some 20° off and not of unit length; objects of unlike sizes, the last one empty."""
    rng = torch.Generator().manual_seed(seed)
    target = torch.nn.functional.normalize(torch.randn(4, 3, size, size, generator=rng), dim=1)
    preds = 1.7 * target + 0.4 * torch.randn(4, 3, size, size, generator=rng)
    share = torch.tensor([0.9, 0.5, 0.05, 0.0]).view(4, 1, 1, 1)
    return preds, target, (torch.rand(4, 1, size, size, generator=rng) < share).float()


def by_numpy(batches: list[Sample]) -> dict[str, float]:
    """All metrics from the definitions, in float64, over a list of all errors."""
    angles, l1, l2, images = [], [], [], []
    for preds, target, mask in batches:
        inside = mask.numpy()[:, 0] > 0
        for m, p_map, t_map in zip(inside, preds.double().numpy(), target.double().numpy(), strict=True):
            p, t = p_map[:, m], t_map[:, m]
            unit = p / np.linalg.norm(p, axis=0)
            cosine = (unit * t).sum(0) / np.linalg.norm(t, axis=0)
            angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
            difference = unit - t
            angles.append(angle)
            l1.append(np.abs(difference).sum(0))
            l2.append(np.sqrt((difference**2).sum(0)))
            if m.any():
                images.append(angle.mean())
    pooled = np.concatenate(angles)
    shares = {f"below_{t}".replace(".", "_"): (pooled < t).mean() for t in (5, 7.5, 11.25, 22.5, 30)}
    return shares | {
        "angular_mean": pooled.mean(),
        "angular_median": np.median(pooled),
        "angular_rmse": np.sqrt((pooled**2).mean()),
        "angular_mean_per_image": np.mean(images),
        "l1": np.concatenate(l1).mean(),
        "l2": np.concatenate(l2).mean(),
    }


def computed(metrics: MetricCollection) -> dict[str, float]:
    return {name: value.item() for name, value in metrics.compute().items()}


def turned(degrees: list[float]) -> Sample:
    """One row of vectors that many degrees from (0, 0, 1)."""
    angle = torch.tensor(degrees, dtype=torch.float64).deg2rad()
    preds = torch.stack([angle.sin(), 0 * angle, angle.cos()])[None, :, None]
    target = torch.tensor([0.0, 0.0, 1.0], dtype=torch.float64).view(1, 3, 1, 1).expand_as(preds)
    return preds, target, torch.ones(1, 1, 1, len(degrees))
