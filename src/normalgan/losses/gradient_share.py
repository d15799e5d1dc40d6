"""The ratio of two losses' gradient norms."""

from collections.abc import Sequence

import torch
from torch import Tensor


def gradient_share(loss: Tensor, other: Tensor, inputs: Sequence[Tensor]) -> Tensor:
    """Return the gradient norm of one loss divided by that of another; the graph is retained.

    Args:
        loss: scalar whose gradient norm is the numerator.
        other: scalar whose gradient norm is the denominator.
        inputs: tensors to differentiate with respect to, such as a network's weights, treated as one
            vector.

    >>> x = torch.tensor([3.0, 4.0], requires_grad=True)
    >>> float(gradient_share(x.sum(), (2 * x).sum(), [x]))
    0.5
    """
    lengths = []
    for value in (loss, other):
        gradients = torch.autograd.grad(value, inputs, retain_graph=True, allow_unused=True)
        squares = [gradient.float().square().sum() for gradient in gradients if gradient is not None]
        lengths.append(torch.stack(squares).sum().sqrt())
    return lengths[0] / lengths[1]
