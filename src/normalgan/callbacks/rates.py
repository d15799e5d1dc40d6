"""Learning rates that a callback sets, relative to the optimisers' initial ones."""

from lightning.pytorch import Trainer

__all__ = ["base_rates", "scale_rates"]


def base_rates(trainer: Trainer) -> list[list[float]]:
    """Return the rate of each parameter group of each optimiser."""
    return [[group["lr"] for group in optimizer.param_groups] for optimizer in trainer.optimizers]


def scale_rates(trainer: Trainer, rates: list[list[float]], factor: float) -> None:
    """Set each group's rate to ``factor`` times that in ``rates``, which is as `base_rates` returns it."""
    for optimizer, of_groups in zip(trainer.optimizers, rates, strict=True):
        for group, rate in zip(optimizer.param_groups, of_groups, strict=True):
            group["lr"] = factor * rate
