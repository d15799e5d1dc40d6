"""Synchronisation of batch norm's running statistics across training processes."""

from typing import Any, Protocol

from torch import Tensor, nn


class Processes(Protocol):
    """Averages tensors over the training processes, as a Lightning strategy does."""

    def reduce(self, tensor: Tensor, *, reduce_op: str) -> Any:
        """Return the mean of a tensor across the processes."""


def average_statistics(module: nn.Module, processes: Processes) -> None:
    """Average the buffers of a module across processes, so that all processes have the same network.

    DistributedDataParallel broadcasts buffers before each step, except under manual optimisation, where
    Lightning disables require_backward_grad_sync around the forward pass.

    Args:
        module: module with the buffers.
        processes: the training processes.
    """
    for buffer in module.buffers():
        if buffer.is_floating_point():
            buffer.copy_(processes.reduce(buffer.clone(), reduce_op="mean"))
