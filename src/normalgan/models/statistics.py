"""The running statistics of batch norm, where several processes train side by side."""

from typing import Any, Protocol

from torch import Tensor, nn

__all__ = ["Processes", "average_statistics"]


class Processes(Protocol):
    """Averages tensors over the training processes, as a Lightning strategy does."""

    def reduce(self, tensor: Tensor, *, reduce_op: str) -> Any:
        """Return the mean of a tensor over the processes."""


def average_statistics(module: nn.Module, processes: Processes) -> None:
    """Average the buffers of a module over the processes, so that all have the same network.

    DistributedDataParallel broadcasts buffers before each step, but never under manual optimisation, for
    which Lightning switches require_backward_grad_sync off around the forward pass.

    Args:
        module: holds the buffers.
        processes: takes the means.
    """
    for buffer in module.buffers():
        if buffer.is_floating_point():
            buffer.copy_(processes.reduce(buffer.clone(), reduce_op="mean"))
