"""Connected components of a graph."""

import numpy as np
from numpy.typing import ArrayLike

from normalgan.arrays import Indices


def connected(count: int, pairs: ArrayLike) -> Indices:
    """Return the index of each item's connected component, (count,).

    Args:
        count: number of items.
        pairs: (E, 2) indices of connected items; may be empty.

    >>> connected(4, [(0, 2), (2, 3)]).tolist()
    [0, 1, 0, 0]
    """
    from scipy.sparse import coo_array  # takes half a second to import
    from scipy.sparse.csgraph import connected_components

    first, second = np.asarray(pairs, np.intp).reshape(-1, 2).T
    graph = coo_array((np.ones(len(first), np.int8), (first, second)), (count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)
