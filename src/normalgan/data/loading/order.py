"""Order: the order of views and meshes when samples are rendered during training."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from normalgan.seeds import derive_seed

__all__ = ["BATCHES_PER_CYCLE", "VIEWS_AT_ONCE", "ViewIndex", "order_of_epoch", "spread"]

VIEWS_AT_ONCE = 16
"""A mesh comes back for up to so many views, and may be forgotten after them."""

BATCHES_PER_CYCLE = 24
"""Batches in a row before the first one's meshes return: a number that most numbers of workers divide."""


class ViewIndex(NamedTuple):
    """A sample to render: everything that a worker must know.

    Args:
        mesh: number of the mesh.
        view: number of the view, which no other epoch has.
    """

    mesh: int
    view: int


def order_of_epoch(
    meshes: int, views: int, epoch: int, seed: int, batch_size: int, replicas: int = 1
) -> Iterator[ViewIndex]:
    """Yield every mesh's views ``epoch * views`` to ``(epoch + 1) * views - 1``, shuffled.

    Loading a mesh takes as long as rendering a dozen views, so its views should not be scattered over the
    epoch; but a batch should show many meshes. So the views of each mesh are cut into groups, and the groups
    are shuffled. A row holds one view of each of the next ``BATCHES_PER_CYCLE * replicas * batch_size``
    groups; the next row another view of the same groups in the same order, until they are used up and the
    next groups come. So a batch shows as many groups as it has samples, its neighbours show others, and the
    same meshes return every ``BATCHES_PER_CYCLE`` batches. A DataLoader deals batches out to its workers in
    rotation: if their number divides ``BATCHES_PER_CYCLE``, these batches all go to one worker, and a mesh is
    loaded once for a whole group.

    The order does not depend on the number of workers.

    Args:
        meshes: how many there are.
        views: of each mesh an epoch.
        epoch: from 0.
        seed: another seed gives another order, but no other samples.
        batch_size: samples a batch.
        replicas: processes that train side by side, each on every n-th batch.
    """
    parts = -(-views // VIEWS_AT_ONCE)
    groups = np.random.default_rng(derive_seed("order", seed, epoch)).permutation(meshes * parts)
    abreast = BATCHES_PER_CYCLE * replicas * batch_size
    for start in range(0, len(groups), abreast):
        mesh, part = np.divmod(groups[start : start + abreast], parts)
        # Groups that have a view more than others come first, so that it stays in its place in the row.
        place = np.argsort(part >= (views % parts or parts), kind="stable")
        mesh, part = mesh[place], part[place]
        for offset in range(0, views, parts):
            view = offset + part
            for m, v in zip(mesh[view < views].tolist(), view[view < views].tolist(), strict=True):
                yield ViewIndex(m, epoch * views + v)


def spread(total: int, count: int) -> list[int]:
    """Return ``count`` positions spread evenly over ``total`` samples, all of them if they are fewer.

    >>> spread(10, 3)
    [0, 4, 9]
    >>> spread(2, 5)
    [0, 1]
    """
    if total <= count:
        return list(range(total))
    return [round(i * (total - 1) / max(count - 1, 1)) for i in range(count)]
