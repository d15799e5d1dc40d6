"""Multigrid: solve a sequence of similar sparse symmetric systems."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg

_Vector = NDArray[np.float64]
_STEPS = 20
"""Number of conjugate gradient steps of a relaxation."""
_SLOW = 8
"""Number of steps above which a new multigrid hierarchy pays off; the old one was built for other weights."""


class Solver:
    """Conjugate gradients, preconditioned by algebraic multigrid (Ruge, Stüben 1987).

    The multigrid hierarchy of a system is reused for the following ones while they are similar enough.

    Args:
        tolerance: tolerance of the residual relative to the right-hand side.

    Example:
        >>> matrix = sparse.csr_array(np.array([[2.0, -1.0], [-1.0, 2.0]]))
        >>> Solver().solve(matrix, np.array([0.0, 3.0]), np.zeros(2)).round(3).tolist()
        [1.0, 2.0]
    """

    def __init__(self, tolerance: float = 1e-4) -> None:
        self.tolerance = tolerance
        self._cycle: LinearOperator | None = None

    def solve(self, matrix: sparse.csr_array, wanted: _Vector, start: _Vector) -> _Vector:
        """Return the solution (n,) for a symmetric positive definite matrix (n, n), starting from a guess."""
        # Imported here because it takes half a second and only heights need it.
        import pyamg
        from threadpoolctl import threadpool_limits

        steps = 0

        def count(_: object) -> None:
            nonlocal steps
            steps += 1

        # On busy cores, BLAS threads wait for each other: inner products took ten times as long as the rest.
        with threadpool_limits(1, user_api="blas"):
            if self._cycle is None:
                self._cycle = pyamg.ruge_stuben_solver(matrix).aspreconditioner()
            solution, _ = cg(
                matrix, wanted, start, rtol=self.tolerance, maxiter=200, M=self._cycle, callback=count
            )
        if steps > _SLOW:
            self._cycle = None
        return np.asarray(solution)


def relax(matrix: sparse.csr_array, wanted: _Vector, start: _Vector) -> _Vector:
    """Return an improved guess (n,) of the solution for a symmetric positive definite matrix (n, n).

    It takes a fixed number of conjugate gradient steps, preconditioned by the diagonal. They only reduce
    fine-scale errors. This is enough if the guess is right at large scales, and takes less time and memory
    than `Solver`.

    Example:
        >>> matrix = sparse.csr_array(np.array([[2.0, -1.0], [-1.0, 2.0]]))
        >>> relax(matrix, np.array([0.0, 3.0]), np.zeros(2)).round(3).tolist()
        [1.0, 2.0]
    """
    scale = sparse.diags_array(1 / matrix.diagonal())
    solution, _ = cg(matrix, wanted, start, rtol=1e-4, maxiter=_STEPS, M=scale)
    return np.asarray(solution)
