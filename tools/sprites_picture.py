"""Draws ten small sprites and a tileset by code, and makes pictures of their maps from `generate`.

python tools/sprites_picture.py sprites.webp tileset.webp
"""

import sys
from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.decoding import Decoded
from normalgan.inference.composites.tile_grid import TileGrid
from normalgan.inference.composites.tilesets import predict_tileset
from normalgan.inference.load import load
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.reading.picture import Picture
from normalgan.inference.sprites import Sprite
from normalgan.normals import normalize, pixels_of

_SIDE = 32
_Y, _X = np.mgrid[:_SIDE, :_SIDE] + 0.5
_INK = (0.10, 0.07, 0.13)
_LIGHT = normalize(np.array([-0.55, 0.5, 0.67], np.float32))


def _disc(x: float, y: float, rx: float, ry: float) -> BoolMask:
    return np.asarray(((_X - x) / rx) ** 2 + ((_Y - y) / ry) ** 2 <= 1)


def _box(left: float, top: float, right: float, bottom: float) -> BoolMask:
    return np.asarray((left < _X) & (right > _X) & (top < _Y) & (bottom > _Y))


class _Canvas:
    """A canvas for a sprite of shapes with outlines, shaded in four tones from the upper left."""

    def __init__(self) -> None:
        self.colour = np.zeros((_SIDE, _SIDE, 3), np.float32)
        self.alpha = np.zeros((_SIDE, _SIDE), np.float32)

    def add(
        self, shape: BoolMask, colour: tuple[float, float, float], shaded: bool = True, outlined: bool = True
    ) -> "_Canvas":
        """Paint a shape (32, 32)."""
        inner = cv2.erode(shape.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
        tone = np.full(shape.shape, 0.85)
        if shaded:
            rows, columns = np.nonzero(shape)
            across = (_X - columns.mean()) / (np.ptp(columns) + 1) + (_Y - rows.mean()) / (np.ptp(rows) + 1)
            tone = np.select([across < -0.35, across < 0.05, across < 0.4], [1.0, 0.82, 0.64], 0.48)
        self.colour[shape] = (tone[..., None] * np.array(colour))[shape]
        if outlined:
            self.colour[shape & ~inner] = _INK
        self.alpha[shape] = 1
        return self

    def spots(self, shape: BoolMask, colour: tuple[float, float, float]) -> "_Canvas":
        """Paint over existing shapes, without an outline."""
        self.colour[shape & (self.alpha > 0)] = colour
        return self


def _apple() -> _Canvas:
    done = _Canvas().add(_box(15, 3, 18, 10), (0.45, 0.3, 0.15), outlined=False)
    return done.add(_disc(16, 19, 12, 11), (0.95, 0.2, 0.18)).spots(_disc(11, 14, 2, 2), (1, 0.85, 0.8))


def _potion() -> _Canvas:
    done = _Canvas().add(_box(12, 2, 20, 12), (0.75, 0.85, 0.9)).add(_disc(16, 20, 11, 10), (0.3, 0.5, 0.95))
    return done.spots(_disc(12, 22, 1.5, 1.5) | _disc(19, 24, 1.2, 1.2) | _disc(16, 18, 1, 1), (0.8, 0.9, 1))


def _gem() -> _Canvas:
    shape = np.asarray(np.abs(_X - 16) + np.abs(_Y - 16) * 0.9 <= 13)
    done = _Canvas().add(shape, (0.2, 0.9, 0.6), shaded=False)
    inner = cv2.erode(shape.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    for side, tone in ((_X < 16, 0.95), (_X >= 16, 0.45)):
        for half, more in ((_Y < 16, 1.0), (_Y >= 16, 0.65)):
            done.colour[inner & side & half] = tone * more * np.array([0.2, 1.0, 0.65])
    return done


def _sword() -> _Canvas:
    blade = np.asarray((np.abs(_X + _Y - 32) < 4.9) & (_Y < 23) & (_Y > 2) & (_X < 30))
    done = _Canvas().add(blade, (0.8, 0.85, 0.95))
    guard = np.asarray((np.abs(_X + _Y - 32) < 8.5) & (np.abs(_X - _Y + 12) < 3.5))
    return done.add(guard, (0.85, 0.65, 0.2)).add(_disc(6, 26, 3.5, 3.5), (0.55, 0.3, 0.15))


def _shield() -> _Canvas:
    shape = _disc(16, 13, 12, 17) & _box(3, 3, 29, 30)
    done = _Canvas().add(shape, (0.25, 0.4, 0.8))
    cross = (_box(14, 5, 18, 27) | _box(7, 11, 25, 15)) & shape
    return done.spots(cross, (0.95, 0.85, 0.4))


def _chest() -> _Canvas:
    done = _Canvas().add(_box(3, 8, 29, 28), (0.65, 0.4, 0.2))
    for row in (15, 20, 24):
        done.spots(_box(4, row, 28, row + 1), (0.3, 0.17, 0.08))
    return done.add(_box(13, 12, 19, 19), (0.95, 0.8, 0.3))


def _mushroom() -> _Canvas:
    done = _Canvas().add(_box(12, 16, 20, 29), (0.95, 0.9, 0.75))
    done.add(_disc(16, 15, 13, 11) & (_Y < 18), (0.9, 0.25, 0.2))
    return done.spots(_disc(11, 11, 2, 2) | _disc(19, 9, 2, 1.6) | _disc(23, 14, 1.6, 1.6), (1, 0.97, 0.9))


def _slime() -> _Canvas:
    shape = _disc(16, 20, 13, 12) & (_Y < 28)
    done = _Canvas().add(shape, (0.45, 0.85, 0.35)).spots(_disc(11, 13, 2, 1.5), (0.9, 1, 0.85))
    return done.spots(_box(11, 18, 13, 21) | _box(19, 18, 21, 21), _INK)


def _brick() -> _Canvas:
    done = _Canvas().add(_box(2, 2, 30, 30), (0.7, 0.35, 0.28), shaded=False)
    for row in range(4):
        top = 3 + 7 * row
        done.spots(_box(2, top + 5, 30, top + 6), (0.35, 0.2, 0.18))
        for column in range(-1, 3):
            left = 3 + 10 * column + 5 * (row % 2)
            done.spots(_box(max(left, 3), top, min(left + 8, 29), top + 1), (0.9, 0.55, 0.45))
            done.spots(_box(left + 9, top, left + 10, top + 6) & _box(3, 3, 29, 29), (0.35, 0.2, 0.18))
    return done


def _tree() -> _Canvas:
    done = _Canvas().add(_box(13, 20, 19, 30), (0.5, 0.32, 0.18))
    leaves = _disc(16, 12, 11, 9) | _disc(9, 16, 6, 6) | _disc(23, 16, 6, 6)
    done.add(leaves, (0.25, 0.7, 0.3))
    dots = np.random.default_rng(3).random((_SIDE, _SIDE))
    inner = cv2.erode(leaves.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    return done.spots(inner & (dots < 0.12), (0.15, 0.45, 0.22)).spots(
        inner & (dots > 0.92), (0.55, 0.9, 0.45)
    )


SPRITES: dict[str, Callable[[], _Canvas]] = {
    "apple": _apple,
    "potion": _potion,
    "gem": _gem,
    "sword": _sword,
    "shield": _shield,
    "chest": _chest,
    "mushroom": _mushroom,
    "slime": _slime,
    "brick": _brick,
    "tree": _tree,
}


def draw(name: str, scale: int = 4) -> Picture:
    """Return a sprite as a picture whose art pixels have a side of ``scale`` pixels."""
    canvas = SPRITES[name]()
    once = np.ones((scale, scale), np.float32)
    return Picture(np.kron(canvas.colour, once[..., None]), np.kron(canvas.alpha, once))


def _lit(preds: NormalMap, picture: Picture) -> Floats:
    light = np.clip(preds.extended @ _LIGHT, 0, 1)[..., None]
    assert picture.alpha is not None
    return np.where(picture.alpha[..., None] > 0, picture.colour * (0.25 + 0.9 * light), np.float32(0.2))


def _shown(preds: NormalMap) -> NDArray[np.float32]:
    return np.asarray(pixels_of(preds.normal, 8) / 255, np.float32)


def draw_tileset() -> NDArray[np.uint8]:
    """Return 3 × 3 tiles of a platform (96, 96, 4), of which the middle row and column repeat."""
    earth = np.full((_SIDE, _SIDE, 4), (120, 80, 50, 255), np.uint8)
    for x, y, radius in ((8, 9, 4), (24, 20, 5), (13, 26, 3), (27, 5, 2)):
        cv2.circle(earth, (x, y), radius, (150, 105, 70, 255), -1)
        cv2.circle(earth, (x, y), radius, (70, 45, 30, 255), 1)
    platform = np.tile(earth, (3, 3, 1))
    below, across = np.mgrid[: 3 * _SIDE, : 3 * _SIDE]
    grass = np.rint(8 + 2 * np.sin(across * np.pi / 8))
    platform[below < grass] = 80, 170, 60, 255
    platform[below == grass] = 40, 90, 35, 255
    platform[[0, -1]] = platform[:, [0, -1]] = 25, 18, 15, 255
    return platform


def show_tileset(target: str) -> None:
    """Write the picture of the tileset: its tiles and map, and a level of 7 × 4 tiles, plain and lit."""
    tiles = draw_tileset()
    preds = predict_tileset(load("shipped"), Decoded(tiles, tiles.shape[:2]), TileGrid(_SIDE, _SIDE), "tiles")
    lit = tiles[..., :3] / 255 * (0.25 + 0.9 * np.clip(preds.extended @ _LIGHT, 0, 1)[..., None])
    rows, columns = ([0, *[1] * (count - 2), 2] for count in (4, 7))
    place = np.ix_(
        *((np.array(each)[:, None] * _SIDE + np.arange(_SIDE)).ravel() for each in (rows, columns))
    )
    own = np.vstack([tiles[..., :3] / 255, np.full((_SIDE, 3 * _SIDE, 3), 0.2)])
    maps = np.vstack([_shown(preds), own[-_SIDE:]])
    panels = [own, maps, (tiles[..., :3] / 255)[place], _shown(preds)[place], lit[place]]
    _write(target, np.kron(np.hstack(panels), np.ones((2, 2, 1))))


def _write(target: str, picture: NDArray[np.generic]) -> None:
    pixels = np.rint(255 * np.clip(picture[..., ::-1], 0, 1)).astype(np.uint8)
    cv2.imwrite(target, pixels, [cv2.IMWRITE_WEBP_QUALITY, 85])


def main(target: str, of_tileset: str) -> None:
    """Write the pictures: sprites with map and light as form, with detail and as pixel art; the tileset."""
    predictor = load("shipped")
    rows = []
    for name in SPRITES:
        picture = draw(name)
        assert picture.alpha is not None
        channels = np.dstack([picture.colour, picture.alpha])
        form = predictor(np.rint(255 * channels).astype(np.uint8))
        row = [np.where(picture.alpha[..., None] > 0, picture.colour, np.float32(0.2))]
        for each in (Sprite(), Sprite(detail=0.6), Sprite(detail=0.6, pixel_art=True)):
            preds = each(form, picture)
            row += [_shown(preds), _lit(preds, picture)]
        rows.append(np.hstack([np.pad(each, ((2, 2), (2, 2), (0, 0)), constant_values=0.2) for each in row]))
    _write(target, np.hstack([np.vstack(rows[:5]), np.vstack(rows[5:])]))
    show_tileset(of_tileset)


if __name__ == "__main__":
    main(*sys.argv[1:])
