"""Groups: items that pairs connect."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

__all__ = ["connected"]


def connected(count: int, pairs: Iterable[tuple[int, int]]) -> NDArray[np.int32]:
    """Return a number for each item (count,), from 0, the same for items that pairs connect.

    >>> connected(4, [(0, 2), (2, 3)]).tolist()
    [0, 1, 0, 0]
    """
    from scipy.sparse import coo_array  # here: it takes a while to import
    from scipy.sparse.csgraph import connected_components

    first, second = np.array([*pairs], np.intp).reshape(-1, 2).T
    graph = coo_array((np.ones(len(first), np.int8), (first, second)), (count, count))
    return np.asarray(connected_components(graph, directed=False)[1])
