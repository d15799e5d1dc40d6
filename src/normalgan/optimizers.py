"""MuonRAdam: orthogonalised momentum for wide layers, RAdam for the rest."""

import math
from collections.abc import Callable
from typing import Annotated, Any, overload

import torch
from torch import Tensor, nn
from torch.optim import RAdam

from normalgan.ranges import Range, check_ranges

_QUINTICS = (
    (8.28721201814563, -23.595886519098837, 17.300387312530933),
    (4.107059111542203, -2.9478499167379106, 0.5448431082926601),
    (3.9486908534822946, -2.908902115962949, 0.5518191394370137),
    (3.3184196573706015, -2.488488024314874, 0.51004894012372),
    (2.300652019954817, -1.6689039845747493, 0.4188073119525673),
)
"""Coefficients a, b, c of successive polynomials ax + bx³ + cx⁵ (Amsel et al., "The Polar Express", 2025)."""


def orthogonalized(matrix: Tensor) -> Tensor:
    """Return an approximation of the nearest matrix with orthonormal rows (or columns, if there are fewer).

    All singular values end up between 0.85 and 1.15, except those below a thousandth of the largest, which
    stay smaller. Instead of a decomposition, it applies odd polynomials by means of the smaller Gram
    matrix.

    Args:
        matrix: (A, B) in float32 or float64; the zero matrix stays zero.

    Example:
        >>> orthogonalized(torch.tensor([[3.0, 0.0], [0.0, 0.2]])).round(decimals=0).tolist()
        [[1.0, 0.0], [0.0, 1.0]]
    """
    # With manual optimisation, steps run under autocast, and half precision would give nan here.
    with torch.autocast(matrix.device.type, enabled=False):
        wide = matrix if matrix.shape[0] <= matrix.shape[1] else matrix.T
        wide = wide / (1.01 * wide.norm()).clamp(min=torch.finfo(wide.dtype).tiny)  # singular values up to 1
        gram = wide @ wide.T
        factor = product = _polynomial(gram, *_QUINTICS[0])
        for quintic in _QUINTICS[1:]:
            gram = factor @ gram @ factor
            gram = (gram + gram.T) / 2  # rounding errors would make it less symmetric in each step
            factor = _polynomial(gram, *quintic)
            product = factor @ product
        result: Tensor = product @ wide
    return result if matrix.shape[0] <= matrix.shape[1] else result.T


def _polynomial(gram: Tensor, a: float, b: float, c: float) -> Tensor:
    """Return a + b · gram + c · gram²; its product with x is ax + bx³ + cx⁵."""
    factor = torch.addmm(gram, gram, gram, beta=b, alpha=c)
    factor.diagonal().add_(a)
    return factor


class MuonRAdam(RAdam):
    """RAdam for biases, norms and narrow layers; orthogonalised momentum for the weights of wide layers.

    The weights of a convolution form a matrix with one row per output channel. Its momentum has a few
    large singular values, which dominate RAdam's step. An orthogonalised step is equally long in all
    directions (Jordan et al., "Muon", 2024). It is scaled to the size of Adam's step, so learning rate and
    weight decay can stay the same as for RAdam (Liu et al., "Muon is scalable for LLM training", 2025,
    equation 4).

    Args:
        params: tensors or parameter groups.
        lr: learning rate.
        betas: betas of RAdam.
        weight_decay: decoupled weight decay, multiplied by ``lr``.
        momentum: momentum for the weights of wide layers.
        narrowest: minimum number of rows and of columns for a matrix to be orthogonalised.

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
        """Perform one step and return the loss of the closure, if any."""
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
                    weights.grad = None  # RAdam skips weights without a gradient
        super().step()
        for weights, gradient in gradients:
            weights.grad = gradient
        return loss

    def _is_wide(self, weights: Tensor) -> bool:
        return weights.ndim > 1 and min(len(weights), weights[0].numel()) >= self.narrowest

    def _step_wide(self, weights: nn.Parameter, gradient: Tensor, rate: float, decay: float) -> None:
        state = self.state[weights]
        if not state:
            state["step"] = torch.zeros(())  # RAdam expects it in every loaded state
            state["momentum"] = torch.zeros_like(weights)
        state["step"] += 1
        momentum: Tensor = state["momentum"].lerp_(gradient, 1 - self.momentum)
        matrix = gradient.lerp(momentum, self.momentum).flatten(1)  # Nesterov momentum
        size = 0.2 * math.sqrt(max(matrix.shape))  # about the size of Adam's entries
        weights.mul_(1 - rate * decay).add_(
            orthogonalized(matrix.float()).view_as(weights).to(weights.dtype), alpha=-rate * size
        )
