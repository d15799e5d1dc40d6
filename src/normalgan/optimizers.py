"""MuonRAdam: orthogonalised momentum for wide layers, RAdam for the rest."""

import math
from collections.abc import Callable
from typing import Annotated, Any, overload

import torch
from torch import Tensor, nn
from torch.optim import RAdam

from normalgan.ranges import Range, check_ranges

__all__ = ["MuonRAdam", "orthogonalized"]

_QUINTICS = (
    (8.28721201814563, -23.595886519098837, 17.300387312530933),
    (4.107059111542203, -2.9478499167379106, 0.5448431082926601),
    (3.9486908534822946, -2.908902115962949, 0.5518191394370137),
    (3.3184196573706015, -2.488488024314874, 0.51004894012372),
    (2.300652019954817, -1.6689039845747493, 0.4188073119525673),
)
"""a, b, c of x → ax + bx³ + cx⁵, one after the other: Amsel et al., "The Polar Express", 2025."""


def orthogonalized(matrix: Tensor) -> Tensor:
    """Return roughly the nearest matrix whose rows, or columns if there are fewer of them, are orthonormal.

    All singular values become about 1 (0.85 to 1.15), except those under a thousandth of the largest, which
    stay smaller. It applies odd polynomials, without a decomposition, to the smaller of the two Gram
    matrices.

    Args:
        matrix: (A, B) in float32 or float64; the zero matrix stays zero.

    Example:
        >>> orthogonalized(torch.tensor([[3.0, 0.0], [0.0, 0.2]])).round(decimals=0).tolist()
        [[1.0, 0.0], [0.0, 1.0]]
    """
    # Manual optimisation steps within the autocast of the forward pass; in half precision these give nan.
    with torch.autocast(matrix.device.type, enabled=False):
        wide = matrix if matrix.shape[0] <= matrix.shape[1] else matrix.T
        wide = wide / (1.01 * wide.norm()).clamp(min=torch.finfo(wide.dtype).tiny)  # singular values up to 1
        gram = wide @ wide.T
        factor = product = _polynomial(gram, *_QUINTICS[0])
        for quintic in _QUINTICS[1:]:
            gram = factor @ gram @ factor
            gram = (gram + gram.T) / 2  # rounding would make it less and less symmetric
            factor = _polynomial(gram, *quintic)
            product = factor @ product
        result: Tensor = product @ wide
    return result if matrix.shape[0] <= matrix.shape[1] else result.T


def _polynomial(gram: Tensor, a: float, b: float, c: float) -> Tensor:
    """Return a + b · gram + c · gram², by which x is multiplied to become ax + bx³ + cx⁵."""
    factor = torch.addmm(gram, gram, gram, beta=b, alpha=c)
    factor.diagonal().add_(a)
    return factor


class MuonRAdam(RAdam):
    """RAdam for biases, norms and narrow layers; orthogonalised momentum for the weights of wide layers.

    A convolution's weights form a matrix with a row for each output channel. Its momentum has a few large
    singular values, which dominate RAdam's step. An orthogonalised step is equally long in all directions
    (Jordan et al., "Muon", 2024). It is scaled to the size of Adam's step, so that rate and weight decay are
    those of RAdam (Liu et al., "Muon is scalable for LLM training", 2025, equation 4).

    Args:
        params: tensors, or groups of them with separate settings.
        lr: rate.
        betas: betas of RAdam.
        weight_decay: decoupled, a share of ``lr``.
        momentum: momentum of the weights of wide layers.
        narrowest: smallest number of rows and columns of a matrix to orthogonalise.

    Raises:
        InputError: if ``momentum`` is not between 0 and 1.
    """

    def __init__(
        self,
        params: Any,
        lr: float = 1e-3,
        betas: tuple[float, float] = (0.9, 0.999),
        weight_decay: float = 0.0,
        momentum: Annotated[float, Range(0, 1, below=True)] = 0.95,
        narrowest: int = 16,
    ) -> None:
        super().__init__(params, lr=lr, betas=betas, weight_decay=weight_decay, decoupled_weight_decay=True)
        self.momentum = momentum
        check_ranges(self)
        self.narrowest = narrowest

    @overload
    def step(self, closure: None = None) -> None: ...

    @overload
    def step(self, closure: Callable[[], float]) -> float: ...

    @torch.no_grad()
    def step(self, closure: Callable[[], float] | None = None) -> float | None:
        """Take a step; return the closure's loss."""
        loss = None
        if closure is not None:
            with torch.enable_grad():
                loss = closure()
        gradients: list[tuple[nn.Parameter, Tensor]] = []
        for group in self.param_groups:
            for weights in group["params"]:
                if weights.grad is not None and self._is_wide(weights):
                    gradients.append((weights, weights.grad))
                    self._step_wide(weights, weights.grad, group["lr"], group["weight_decay"])
                    weights.grad = None  # RAdam passes over what has none
        super().step()
        for weights, gradient in gradients:
            weights.grad = gradient
        return loss

    def _is_wide(self, weights: Tensor) -> bool:
        return weights.ndim > 1 and min(len(weights), weights[0].numel()) >= self.narrowest

    def _step_wide(self, weights: nn.Parameter, gradient: Tensor, rate: float, decay: float) -> None:
        state = self.state[weights]
        if not state:
            state["step"] = torch.zeros(())  # as RAdam asks of every state that is loaded
            state["momentum"] = torch.zeros_like(weights)
        state["step"] += 1
        momentum: Tensor = state["momentum"].lerp_(gradient, 1 - self.momentum)
        matrix = gradient.lerp(momentum, self.momentum).flatten(1)  # a step ahead, by Nesterov
        size = 0.2 * math.sqrt(max(matrix.shape))  # entries as large as those of a step of Adam's, mostly
        weights.mul_(1 - rate * decay).add_(
            orthogonalized(matrix.float()).view_as(weights).to(weights.dtype), alpha=-rate * size
        )
