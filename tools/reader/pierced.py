"""Eight drawings of things with holes through them, and points in holes and in the object."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

SIDE = 400
Point = tuple[int, int]


@dataclass(frozen=True)
class Pierced:
    """A drawing.

    Args:
        page: (SIDE, SIDE) in [0, 1], ink 0.
        holes: x and y of points in holes.
        solid: x and y of points of the object, in areas that lines enclose.
    """

    page: NDArray[np.float32]
    holes: list[Point]
    solid: list[Point]


class _Pen:
    def __init__(self) -> None:
        self.page = np.ones((SIDE, SIDE), np.float32)

    def line(self, *points: Point, closed: bool = False) -> None:
        cv2.polylines(self.page, [np.array(points, np.int32)], closed, 0, 3, cv2.LINE_AA)

    def arc(self, middle: Point, radii: Point, start: float = 0, end: float = 360) -> None:
        cv2.ellipse(self.page, middle, radii, 0, start, end, 0, 3, cv2.LINE_AA)

    def bar(self, start: Point, end: Point) -> None:
        (x, y), (u, v) = start, end
        length = np.hypot(u - x, v - y)
        dx, dy = round(-5 * (v - y) / length), round(5 * (u - x) / length)
        self.line((x + dx, y + dy), (u + dx, v + dy), (u - dx, v - dy), (x - dx, y - dy), closed=True)

    def erase(self, x: slice, y: slice) -> None:
        self.page[y, x] = 1


def _mug(pen: _Pen) -> Pierced:
    pen.arc((270, 210), (70, 70))
    pen.arc((270, 210), (48, 48))
    pen.erase(slice(90, 250), slice(90, 340))
    pen.line((90, 100), (90, 330), (250, 330), (250, 100))
    pen.arc((170, 100), (80, 18))
    return Pierced(pen.page, [(290, 210)], [(170, 220), (170, 100)])


def _key(pen: _Pen) -> Pierced:
    pen.arc((110, 200), (70, 70))
    pen.arc((110, 200), (40, 40))
    pen.erase(slice(172, 360), slice(186, 214))
    pen.line((178, 186), (350, 186), (350, 250), (330, 250), (330, 214))
    pen.line((330, 214), (310, 214), (310, 240), (290, 240), (290, 214), (178, 214))
    return Pierced(pen.page, [(110, 200)], [(250, 200)])


def _chair(pen: _Pen) -> Pierced:
    pen.line(
        *((110, 40), (130, 40), (130, 200), (290, 200), (310, 230), (310, 370), (290, 370)),
        *((290, 240), (130, 240), (130, 370), (110, 370)),
        closed=True,
    )
    pen.line((130, 60), (250, 60), (250, 200))
    pen.line((130, 80), (230, 80), (230, 200))
    pen.line((130, 200), (130, 240))
    return Pierced(pen.page, [(180, 140)], [(200, 220)])


def _doughnut(pen: _Pen) -> Pierced:
    pen.arc((200, 200), (140, 120))
    pen.arc((200, 190), (50, 35))
    return Pierced(pen.page, [(200, 190)], [(90, 200)])


def _spectacles(pen: _Pen) -> Pierced:
    for x in (110, 290):
        pen.arc((x, 200), (75, 60))
        pen.arc((x, 200), (62, 47))
    pen.arc((200, 190), (20, 12), 180, 360)
    pen.arc((200, 200), (16, 10), 180, 360)
    pen.line((36, 190), (20, 150), (10, 154), (36, 206))
    pen.line((364, 190), (380, 150), (390, 154), (364, 206))
    return Pierced(pen.page, [(110, 200), (290, 200)], [])


def _scissors(pen: _Pen) -> Pierced:
    for x in (130, 270):
        pen.arc((x, 320), (50, 50))
        pen.arc((x, 320), (32, 32))
    pen.line((155, 275), (190, 200), (240, 40), (215, 190), (165, 285))
    pen.line((245, 275), (210, 200), (160, 40), (185, 190), (235, 285))
    return Pierced(pen.page, [(130, 320), (270, 320)], [])


def _bicycle(pen: _Pen) -> Pierced:
    for x in (110, 290):
        for radius in (80, 68, 8):
            pen.arc((x, 260), (radius, radius))
    rear, front, seat, head, crank = (110, 260), (290, 260), (160, 160), (265, 160), (200, 260)
    for start, end in (
        *((rear, seat), (seat, head), (head, crank), (crank, seat), (crank, rear), (head, front)),
        *(((255, 130), head), ((150, 140), seat)),
    ):
        pen.bar(start, end)
    pen.line((130, 130), (170, 130), (170, 140), (130, 140), closed=True)
    pen.line((250, 120), (285, 120), (285, 130), (250, 130), closed=True)
    return Pierced(pen.page, [(70, 230), (330, 290)], [])


def _tripod(pen: _Pen) -> Pierced:
    legs = (185, 60), (215, 60), (320, 370), (300, 370), (200, 90), (100, 370), (80, 370)
    pen.line(*legs, closed=True)
    pen.line((140, 260), (260, 260), (264, 272), (136, 272), closed=True)
    pen.line((170, 30), (230, 30), (230, 60), (170, 60), closed=True)
    return Pierced(pen.page, [(200, 200)], [])


_DRAWN: tuple[Callable[[_Pen], Pierced], ...] = (
    *(_mug, _key, _chair, _doughnut, _spectacles, _scissors, _bicycle, _tripod),
)


def drawings() -> dict[str, Pierced]:
    """Return the drawings by what they show."""
    return {draw.__name__[1:]: draw(_Pen()) for draw in _DRAWN}
