"""Cosine learning-rate schedules that end with the run."""

import math

from torch.optim.lr_scheduler import CosineAnnealingLR


def end_cosine_at(schedule: CosineAnnealingLR, epochs: int) -> None:
    """Change the length of a cosine schedule, and update the learning rate of the current epoch.

    PyTorch derives each rate from the previous one, so a schedule that has reached 0 would stay there.

    Args:
        schedule: schedule that is stepped once per epoch; unchanged if it already has this length.
        epochs: number of epochs until the lowest rate.
    """
    if schedule.T_max == epochs:
        return
    schedule.T_max = epochs
    share = (1 + math.cos(math.pi * schedule.last_epoch / epochs)) / 2
    for group, rate in zip(schedule.optimizer.param_groups, schedule.base_lrs, strict=True):
        group["lr"] = schedule.eta_min + (rate - schedule.eta_min) * share
