"""The running statistics of batch norm, where several processes train side by side."""

from collections.abc import Callable

from torch import Tensor, nn


def average_statistics(module: nn.Module, mean: Callable[[Tensor], Tensor]) -> None:
    """Average the buffers of a module over the processes, so that all have the same network.

    DistributedDataParallel broadcasts buffers before each step, but never under manual optimisation, for
    which Lightning switches require_backward_grad_sync off around the forward pass.

    Args:
        module: holds the buffers.
        mean: returns the mean of a tensor over the processes.
    """
    for buffer in module.buffers():
        if buffer.is_floating_point():
            buffer.copy_(mean(buffer.clone()))
