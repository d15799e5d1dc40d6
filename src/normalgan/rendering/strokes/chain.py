"""Chaining: connects linked points to ordered paths that continue straight through junctions."""

from collections import defaultdict

import numpy as np

from normalgan.arrays import Doubles, Indices

_Piece = list[int]
_Neighbours = tuple[list[int], list[int]]
_End = tuple[int, int]  # index of a piece and one of its ends, 0 or -1

_REACH = 6.0  # distance from a junction for measuring the direction of a branch, in units of the points
_STRAIGHT = np.cos(np.deg2rad(60.0))  # maximum turn of a path at a junction


def chain(points: Doubles, links: Indices) -> list[Indices]:
    """Return paths that together traverse each link once.

    At a junction, a point with more than two links, a path continues in the straightest direction. A
    contour is therefore not interrupted where another contour ends on it.

    Args:
        points: (N, 2) positions.
        links: (M, 2) pairs of points, without duplicates.

    Returns:
        The points of each path in order. A closed path ends with its first point.

    >>> points = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]])  # a vertex of an inverted T
    >>> [path.tolist() for path in chain(points, np.array([[0, 1], [2, 1], [1, 3]]))]
    [[0, 1, 2], [1, 3]]
    """
    degree = np.bincount(links.ravel(), minlength=len(points))
    pieces = _pieces(_neighbours(links, degree), degree)
    partner = _straight_on(points, pieces, degree)
    return [np.array(path, np.int64) for path in _joined(pieces, partner)]


def _neighbours(links: Indices, degree: Indices) -> _Neighbours:
    """Return the concatenated neighbours of all points, and the start index of each point's neighbours.

    Two flat lists are used because thousands of small lists would keep the garbage collector busy.
    """
    both = np.concatenate([links, links[:, ::-1]])
    near = both[np.argsort(both[:, 0], kind="stable"), 1]
    return near.tolist(), np.append(0, np.cumsum(degree)).tolist()


def _pieces(neighbours: _Neighbours, degree: Indices) -> list[_Piece]:
    """Return the paths between junctions or ends, then the loops without either."""
    near, begin = neighbours
    inner = (degree == 2).tolist()
    walked = [False] * len(inner)
    pieces = []
    for start in np.flatnonzero((degree > 0) & (degree != 2)).tolist():
        for first in near[begin[start] : begin[start + 1]]:
            if not inner[first]:
                if start < first:
                    pieces.append([start, first])
            elif not walked[first]:
                pieces.append(_walk([start, first], neighbours, inner, walked))
    for start in np.flatnonzero(degree == 2).tolist():
        if not walked[start]:
            walked[start] = True
            pieces.append([*_walk([start, near[begin[start]]], neighbours, inner, walked), start])
    return pieces


def _walk(path: _Piece, neighbours: _Neighbours, inner: list[bool], walked: list[bool]) -> _Piece:
    """Extend a path to the next end, junction or visited point, and return it."""
    near, begin = neighbours
    before, here = path
    while inner[here]:
        walked[here] = True
        one, other = near[begin[here]], near[begin[here] + 1]
        before, here = here, other if one == before else one
        if walked[here]:
            break
        path.append(here)
    return path


def _straight_on(points: Doubles, pieces: list[_Piece], degree: Indices) -> dict[_End, _End]:
    """Return the end at which a piece continues, for each end that continues through a junction."""
    meeting: dict[int, list[_End]] = defaultdict(list)
    for number, piece in enumerate(pieces):
        for side in (0, -1):
            if degree[piece[side]] > 2:
                meeting[piece[side]].append((number, side))
    partner: dict[_End, _End] = {}
    for ends in meeting.values():
        away = np.array([_direction(points, pieces[number], side) for number, side in ends])
        straight = -(away @ away.T)
        pairs = [(straight[i, j], i, j) for j in range(len(ends)) for i in range(j)]
        for cosine, i, j in sorted(pairs, key=lambda pair: (-pair[0], *pair[1:])):
            if cosine >= _STRAIGHT and ends[i] not in partner and ends[j] not in partner:
                partner[ends[i]], partner[ends[j]] = ends[j], ends[i]
    return partner


def _direction(points: Doubles, piece: _Piece, side: int) -> Doubles:
    """Return the unit vector (2,) from an end of a piece to where it leaves a circle of radius `_REACH`."""
    some = piece[: int(4 * _REACH) + 2] if side == 0 else piece[: -int(4 * _REACH) - 3 : -1]
    away = points[some] - points[some[0]]
    distance = np.hypot(away[:, 0], away[:, 1])
    out = distance >= _REACH
    at = int(out.argmax()) if out.any() else int(distance.argmax())
    unit: Doubles = away[at] / max(distance[at], 1e-12)
    return unit


def _joined(pieces: list[_Piece], partner: dict[_End, _End]) -> list[_Piece]:
    """Return the joined pieces, first those that start at ends without a partner, then the closed ones."""
    done = [False] * len(pieces)
    paths = []
    loose = [(number, side) for number in range(len(pieces)) for side in (0, -1)]
    for start in sorted(loose, key=lambda end: end in partner):
        if done[start[0]]:
            continue
        path: _Piece = []
        end: _End | None = start
        while end is not None and not done[end[0]]:
            number, side = end
            done[number] = True
            path += pieces[number][:: 1 if side == 0 else -1][1 if path else 0 :]
            end = partner.get((number, -1 - side))
        paths.append(path)
    return paths
