"""Synchronisation of batch norm's running statistics across training processes."""

from collections.abc import Callable

from torch import Tensor, nn


def average_statistics(module: nn.Module, mean: Callable[[Tensor], Tensor]) -> None:
    """Average the buffers of a module across processes, so that all processes have the same network.

    DistributedDataParallel broadcasts buffers before each step, except under manual optimisation, where
    Lightning disables require_backward_grad_sync around the forward pass.

    Args:
        module: module with the buffers.
        mean: function that returns the mean of a tensor across the processes.
    """
    for buffer in module.buffers():
        if buffer.is_floating_point():
            buffer.copy_(mean(buffer.clone()))
