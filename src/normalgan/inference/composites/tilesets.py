"""Tilesets: predict tiles together with their neighbours, so that the maps of adjacent tiles match."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.decoding import Decoded
from normalgan.graphs import connected
from normalgan.inference.cleaning.silhouette import is_silhouette, opaque_part
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.series import Member
from normalgan.inference.composites.sheets import predict_sheet
from normalgan.inference.composites.tile_grid import TileGrid
from normalgan.inference.network.tile import Tile
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import Picture, to_picture
from normalgan.inference.sprites import Sprite
from normalgan.inference.vectors import unit

_REACH = 1 / 4
"""Depth of the band at a tile's edge that is adjusted to matching edges, as a fraction of the tile."""
_PASSES = 4
"""Number of adjustment rounds; one is not enough, because each axis disturbs the other at the corners."""
_USUAL = 0.9
"""Quantile that counts as a usual colour step between a tile's pixel rows; outlines exceed it."""
_ALIKE = 1 / 15
"""Largest difference between two background colours, in [0, 1]; JPEG noise is smaller."""
_ROUNDING = np.float32(1e-6)
"""Tolerance for rounding when the means of equal steps are compared."""
_AXES: tuple[Tile, Tile] = ("y", "x")
"""Direction of repetition along each axis of an array."""


def predict_tileset(
    predictor: Predictor,
    sheet: Decoded,
    grid: TileGrid,
    name: object,
    page: Member | None = None,
    sprite: Sprite | None = None,
) -> NormalMap:
    """Return the map of a tileset, in which tiles match wherever the drawn tiles do.

    Two tiles match if the colour step at their common edge is no larger than steps inside both tiles. A tile
    that matches itself is predicted as a repeating drawing. Tiles that match their neighbours in the picture
    are predicted together. Finally, all edges that may meet get the same normals.

    Args:
        predictor: the network.
        sheet: pixels of the tileset, not reduced.
        grid: positions of the tiles.
        name: file name for messages.
        page: the sheet as one drawing, with its hints and its mask (H, W); None has neither.
        sprite: adapts the map to painted tiles; None leaves it as predicted.

    Raises:
        InputError: if the picture does not fit the grid, or no tile can be predicted.
    """
    said = grid.check(sheet.shape, name)
    rows, columns = grid.places(sheet.shape)
    packed = replace(sheet, pixels=sheet.pixels[np.ix_(rows, columns)], shape=(len(rows), len(columns)))
    picture = to_picture(packed)
    drawn, opacity = _drawn(picture, grid)
    tiles = _Tiles.of(picture, drawn, grid)
    hints, mask = (None, None) if page is None else (page.hints, page.mask)
    own = mask[np.ix_(rows, columns)] if isinstance(mask, np.ndarray) else mask
    own = opacity > 0.5 if own is None and opacity is not None else own
    member = Member(picture, _packed_hints(hints, rows, columns), own)
    preds = predict_sheet(predictor, packed, tiles.cells(), member, said=[said] if said else [])
    if mask is None and opacity is not None:
        preds = replace(preds, mask=opacity > 0.5, alpha=opacity)
    preds = replace(preds, extended=tiles.fitted(preds.extended, preds.mask))
    if sprite is not None and sprite.changes:
        preds = sprite(preds, picture)
        if not sprite.pixel_art:
            preds = replace(preds, extended=tiles.fitted(preds.extended, preds.mask))
    return _spread(preds, sheet, packed, rows, columns)


@dataclass(frozen=True)
class _Tiles:
    """The tiles of a picture without margin and spacing, and which of them match.

    Args:
        grid: grid that gives the size of the tiles.
        counts: numbers of rows and columns.
        drawn: (rows, columns), whether anything is drawn on a tile.
        plain: (rows, columns), whether a tile has a single colour.
        wraps: (2, rows, columns), whether a tile matches itself below, and to the right.
        joins: (2, rows, columns), whether a tile matches the next one below, and to the right.
    """

    grid: TileGrid
    counts: tuple[int, int]
    drawn: BoolMask
    plain: BoolMask
    wraps: BoolMask
    joins: BoolMask

    @classmethod
    def of(cls, picture: Picture, drawn: BoolMask, grid: TileGrid) -> "_Tiles":
        """Return the tiles of a picture; ``drawn`` (H, W) marks the drawn pixels."""
        alpha = np.ones(picture.size, np.float32) if picture.alpha is None else picture.alpha
        cut = _cut(np.dstack([picture.colour * alpha[..., None], alpha, drawn]), grid)
        wraps, joins = np.zeros((2, 2, *cut.shape[:2]), np.bool_)
        for axis in (0, 1):
            behind = np.roll(cut, -1, axis)
            last = np.s_[-1:] if axis == 0 else np.s_[:, -1:]
            beside, hard_beside = _fit(cut, behind, axis)
            itself, hard_itself = _fit(cut, cut, axis)
            beside[last] = hard_beside[last] = False
            # A hard step may be a line along the edge or the end of the object. It is the end if the tile has
            # another continuation beyond its last or before its first edge.
            goes_on, comes_from = itself | beside, itself | np.roll(beside, 1, axis)
            next_comes_from = np.roll(comes_from, -1, axis)
            joins[axis] = beside | (hard_beside & ~goes_on & ~next_comes_from)
            wraps[axis] = itself | (hard_itself & ~goes_on & ~comes_from)
        plain = np.ptp(cut, axis=(2, 3)).max(-1) == 0
        return cls(grid, (cut.shape[0], cut.shape[1]), cut[..., 4].max((2, 3)) > 0, plain, wraps, joins)

    def cells(self) -> list[Cell]:
        """Return the cells to predict: groups of matching tiles first, then tiles that are predicted alone.

        A tile that repeats in every direction in which it has a matching neighbour does not need the
        neighbour. It is predicted as a repeating drawing, which overrides its part of a group.
        """
        groups = connected(self.drawn.size, [(a, b) for _, a, b in self._neighbours()])
        together, alone = [], []
        for group in np.unique(groups[self.drawn.ravel()]):
            members = np.flatnonzero(groups == group)
            own = [self._repeated(int(each)) for each in members]
            plain = self.plain.ravel()[members]
            if not all(repeat or flat for repeat, flat in zip(own, plain, strict=True)):
                together.append(self._cell(members))
            alone += [
                self._cell(np.array([tile]), repeat)
                for tile, repeat, flat in zip(members, own, plain, strict=True)
                if repeat and not flat
            ]
        return together + alone

    def fitted(self, normals: Floats, mask: BoolMask) -> Floats:
        """Return normals (H, W, 3) adjusted to be equal along edges that may meet."""
        normals = normals.copy()
        edges = [self._edges(axis) for axis in (0, 1)]
        sides = self.grid.height, self.grid.width
        for _ in range(_PASSES):
            for axis in (0, 1):
                lines = normals if axis == 0 else normals.swapaxes(0, 1)
                weights = (mask if axis == 0 else mask.T).astype(np.float32) + np.float32(1e-3)
                for group in edges[axis]:
                    _adjust(lines, weights, group, sides if axis == 0 else sides[::-1])
        return normals

    def _neighbours(self) -> Iterable[tuple[int, int, int]]:
        """Yield the axis, the tile and the next tile of each matching pair."""
        for axis, row, column in np.argwhere(self.joins):
            tile = row * self.counts[1] + column
            yield int(axis), int(tile), int(tile + (1 if axis else self.counts[1]))

    def _repeated(self, tile: int) -> Tile | None:
        """Return the directions in which a tile repeats; None if it needs neighbours."""
        row, column = divmod(tile, self.counts[1])
        needs = [
            bool(self.joins[axis, row, column])
            or bool(at and self.joins[axis, row - (axis == 0), column - (axis == 1)])
            for axis, at in ((0, row), (1, column))
        ]
        down, across = (bool(each) for each in self.wraps[:, row, column])
        if not (down or across) or (needs[0] and not down) or (needs[1] and not across):
            return None
        return "both" if down and across else "y" if down else "x"

    def _cell(self, members: NDArray[np.intp], repeat: Tile | None = None) -> Cell:
        height, width = self.grid.height, self.grid.width
        down, across = np.divmod(members, self.counts[1])
        top, left = int(down.min()), int(across.min())
        there = np.zeros((int(down.max()) - top + 1, int(across.max()) - left + 1), np.bool_)
        there[down - top, across - left] = True
        own = None if there.all() else np.kron(there, np.ones((height, width), np.bool_))
        first = f"tile {int(members[0]) + 1} (row {down[0] + 1}, column {across[0] + 1})"
        name = first if len(members) == 1 else f"{first} and the {len(members) - 1} that continue it"
        sides = there.shape[1] * width, there.shape[0] * height
        return Cell(name, left * width, top * height, *sides, own=own, tile=repeat)

    def _edges(self, axis: int) -> list[list[tuple[int, int, bool]]]:
        """Return groups of tile edges that may meet along an axis.

        An edge is the tile's position along the axis, its position across it, and whether it is the last edge
        instead of the first. Pairs of edges that were predicted side by side and meet no other edge are left
        out.
        """
        repeats = {int(tile) for tile in np.flatnonzero(self.wraps[axis].ravel())}
        pairs = [(a, b) for which, a, b in self._neighbours() if which == axis] + [(a, a) for a in repeats]
        meet = [(_Edge(before, last=True), _Edge(behind, last=False)) for before, behind in pairs]
        edges = sorted({edge for pair in meet for edge in pair})
        index = {edge: i for i, edge in enumerate(edges)}
        labels = connected(len(edges), [(index[last], index[first]) for last, first in meet])
        groups: dict[int, list[_Edge]] = {}
        for edge, label in zip(edges, labels, strict=True):
            groups.setdefault(int(label), []).append(edge)

        def side_by_side(tile: int) -> bool:
            return tile not in repeats or self._repeated(tile) in {"both", _AXES[axis]}

        def place(edge: _Edge) -> tuple[int, int, bool]:
            row, column = divmod(edge.tile, self.counts[1])
            return (row, column, edge.last) if axis == 0 else (column, row, edge.last)

        return [
            [place(edge) for edge in group]
            for group in groups.values()
            if len(group) > 2 or not side_by_side(group[0].tile)
        ]


class _Edge(NamedTuple):
    """One of a tile's two edges across an axis."""

    tile: int
    last: bool


def _drawn(picture: Picture, grid: TileGrid) -> tuple[BoolMask, Floats | None]:
    """Return the drawn pixels (H, W) of a tileset, and the opacity of the objects if it is known.

    In an opaque tileset, white at most tile corners is paper, and any other colour along all edges of most
    tiles is background. A tileset with neither, such as terrain, is all object.
    """
    if picture.alpha is not None:
        return opaque_part(picture.alpha), picture.alpha if is_silhouette(picture) else None
    tiles = _cut(np.rint(picture.colour / _ALIKE), grid)
    tiles = tiles.reshape(-1, *tiles.shape[2:])
    sides = [tiles[:, 0], tiles[:, -1], tiles[:, :, 0], tiles[:, :, -1]]
    around = np.concatenate(sides, 1)
    corners = np.concatenate([each[:, [0, -1]] for each in sides[:2]], 1)
    flat = around[np.ptp(around, axis=1).max(-1) == 0][:, 0]
    for places, of in ((corners[(corners == 1 / _ALIKE).all(-1)], corners.size / 3), (flat, len(tiles))):
        found, counts = np.unique(places, axis=0, return_counts=True)
        if counts.max(initial=0) > of / 2:
            ground = (found[counts.argmax()] * _ALIKE).astype(np.float32)
            return np.abs(picture.colour - ground).max(-1) > _ALIKE, None
    return np.ones(picture.size, np.bool_), np.ones(picture.size, np.float32)


def _cut(picture: Floats, grid: TileGrid) -> Floats:
    """Return the tiles (rows, columns, h, w, C) of a picture (H, W, C)."""
    rows, columns = picture.shape[0] // grid.height, picture.shape[1] // grid.width
    return picture.reshape(rows, grid.height, columns, grid.width, -1).swapaxes(1, 2)


def _fit(before: Floats, behind: Floats, axis: int) -> tuple[BoolMask, BoolMask]:
    """Return which tiles (rows, columns, h, w, 5) match the next tile along an axis.

    Args:
        before: premultiplied colours, opacity, and whether a pixel is drawn.
        behind: the same channels of the next tiles.
        axis: 0 for below, 1 for to the right.

    Returns:
        Two masks: whether the step at the edge is at most a usual step inside both tiles, and whether it is
        at most the largest step inside both.
    """
    last, first = np.take(before, -1, 2 + axis), np.take(behind, 0, 2 + axis)
    there = last[..., 4] > 0, first[..., 4] > 0
    joined, torn = (there[0] & there[1]).sum(-1), (there[0] ^ there[1]).sum(-1)
    fits = joined > torn
    step = np.abs(last - first)[..., :4].max(-1).mean(-1) - _ROUNDING
    steps = [
        np.abs(np.diff(each[..., :4], axis=2 + axis)).max(-1).mean(3 - axis) for each in (before, behind)
    ]
    usual, hardest = (np.min([np.quantile(each, share, -1) for each in steps], 0) for share in (_USUAL, 1))
    return fits & (step <= usual), fits & (step <= hardest)


def _adjust(
    normals: Floats, weights: Floats, edges: Sequence[tuple[int, int, bool]], sides: tuple[int, int]
) -> None:
    """Replace the normals along edges with their mean, in place, and blend the change into the tiles.

    Args:
        normals: (H, W, 3), the tiles stacked vertically.
        weights: (H, W), weight of each pixel in the mean.
        edges: a group of edges from `_Tiles._edges`.
        sides: height and width of a tile in this array.
    """
    length, width = sides
    reach = max(round(_REACH * length), 1)
    fade = (0.5 + 0.5 * np.cos(np.pi * np.arange(reach) / reach)).astype(np.float32)
    parts = []
    for along, beside, last in edges:
        across = np.s_[beside * width : (beside + 1) * width]
        start = (along + 1) * length - 1 if last else along * length
        down = start + np.arange(reach) * (-1 if last else 1)
        parts.append((down, across))
    total = sum(weights[down[0], across, None] * normals[down[0], across] for down, across in parts)
    mean = unit(np.asarray(total, np.float32)[None], front=True)[0]
    for down, across in parts:
        change = mean - normals[down[0], across]
        part = normals[down, across] + fade[:, None, None] * change
        normals[down, across] = unit(np.ascontiguousarray(part, np.float32), front=True)


def _packed_hints(hints: Hints | None, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Hints | None:
    """Return the hints that lie in tiles, in pixels of the picture without margin and spacing."""
    if hints is None:
        return None
    x, y = np.floor(hints.points).astype(np.intp).T
    inside = np.isin(x, columns) & np.isin(y, rows)
    places = np.stack([np.searchsorted(columns, x), np.searchsorted(rows, y)], -1)
    points = places + (hints.points - np.floor(hints.points))
    return Hints(points[inside].astype(np.float32), hints.normals[inside]) if inside.any() else None


def _spread(
    preds: NormalMap, sheet: Decoded, packed: Decoded, rows: NDArray[np.intp], columns: NDArray[np.intp]
) -> NormalMap:
    """Return the map of a sheet from the map of its tiles without gaps.

    Tile edges are often extruded into the gaps to avoid colour bleeding; their normals are extruded there
    too.
    """
    if preds.mask.shape == sheet.shape:
        return preds
    near = np.ix_(_nearest(rows, sheet.shape[0]), _nearest(columns, sheet.shape[1]))
    there = np.zeros(sheet.shape, np.bool_)
    there[np.ix_(rows, columns)] = True
    same = sheet.pixels == packed.pixels[near]
    there |= same if same.ndim == 2 else same.all(-1)
    cells = []
    for cell in preds.cells:
        down, across = rows[cell.box[0]], columns[cell.box[1]]
        top, left = int(down[0]), int(across[0])
        own = np.zeros((int(down[-1]) - top + 1, int(across[-1]) - left + 1), np.bool_)
        own[np.ix_(down - top, across - left)] = True if cell.own is None else cell.own
        height, width = own.shape
        place = replace(cell, left=left, top=top, width=width, height=height)
        cells.append(replace(place, own=None if own.all() else own))
    return replace(
        preds,
        extended=preds.extended[near],
        mask=preds.mask[near] & there,
        alpha=preds.alpha[near] * there,
        confidence=None if preds.confidence is None else preds.confidence[near],
        cells=tuple(cells),
    )


def _nearest(lines: NDArray[np.intp], side: int) -> NDArray[np.intp]:
    """Return for each pixel along a side the index of the nearest of several lines."""
    every = np.arange(side)
    behind = np.clip(np.searchsorted(lines, every), 1, len(lines) - 1)
    return np.where(every - lines[behind - 1] <= lines[behind] - every, behind - 1, behind)
