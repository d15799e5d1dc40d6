"""Drawings of pierced and solid things, with points in their holes and in the object."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

SIDE = 400
Point = tuple[int, int]


@dataclass(frozen=True)
class Thing:
    """A drawing.

    Args:
        page: (SIDE, SIDE) in [0, 1], ink 0.
        holes: x and y of points in holes and in the air around the object.
        solid: x and y of points of the object, in areas enclosed by lines.
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


def _mug(pen: _Pen) -> Thing:
    pen.arc((270, 210), (70, 70))
    pen.arc((270, 210), (48, 48))
    pen.erase(slice(90, 250), slice(90, 340))
    pen.line((90, 100), (90, 330), (250, 330), (250, 100))
    pen.arc((170, 100), (80, 18))
    return Thing(pen.page, [(290, 210)], [(170, 220), (170, 100)])


def _key(pen: _Pen) -> Thing:
    pen.arc((110, 200), (70, 70))
    pen.arc((110, 200), (40, 40))
    pen.erase(slice(172, 360), slice(186, 214))
    pen.line((178, 186), (350, 186), (350, 250), (330, 250), (330, 214))
    pen.line((330, 214), (310, 214), (310, 240), (290, 240), (290, 214), (178, 214))
    return Thing(pen.page, [(110, 200)], [(250, 200)])


def _chair(pen: _Pen) -> Thing:
    pen.line(
        *((110, 40), (130, 40), (130, 200), (290, 200), (310, 230), (310, 370), (290, 370)),
        *((290, 240), (130, 240), (130, 370), (110, 370)),
        closed=True,
    )
    pen.line((130, 60), (250, 60), (250, 200))
    pen.line((130, 80), (230, 80), (230, 200))
    pen.line((130, 200), (130, 240))
    return Thing(pen.page, [(180, 140)], [(200, 220)])


def _doughnut(pen: _Pen) -> Thing:
    pen.arc((200, 200), (140, 120))
    pen.arc((200, 190), (50, 35))
    return Thing(pen.page, [(200, 190)], [(90, 200)])


def _spectacles(pen: _Pen) -> Thing:
    for x in (110, 290):
        pen.arc((x, 200), (75, 60))
        pen.arc((x, 200), (62, 47))
    pen.arc((200, 190), (20, 12), 180, 360)
    pen.arc((200, 200), (16, 10), 180, 360)
    pen.line((36, 190), (20, 150), (10, 154), (36, 206))
    pen.line((364, 190), (380, 150), (390, 154), (364, 206))
    return Thing(pen.page, [(110, 200), (290, 200)], [])


def _scissors(pen: _Pen) -> Thing:
    for x in (130, 270):
        pen.arc((x, 320), (50, 50))
        pen.arc((x, 320), (32, 32))
    pen.line((155, 275), (190, 200), (240, 40), (215, 190), (165, 285))
    pen.line((245, 275), (210, 200), (160, 40), (185, 190), (235, 285))
    return Thing(pen.page, [(130, 320), (270, 320)], [])


def _bicycle(pen: _Pen) -> Thing:
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
    return Thing(pen.page, [(70, 230), (330, 290)], [])


def _tripod(pen: _Pen) -> Thing:
    legs = (185, 60), (215, 60), (320, 370), (300, 370), (200, 90), (100, 370), (80, 370)
    pen.line(*legs, closed=True)
    pen.line((140, 260), (260, 260), (264, 272), (136, 272), closed=True)
    pen.line((170, 30), (230, 30), (230, 60), (170, 60), closed=True)
    return Thing(pen.page, [(200, 200)], [])


def _window(pen: _Pen) -> Thing:
    pen.line((60, 50), (340, 50), (340, 350), (60, 350), closed=True)
    pen.line((200, 50), (200, 350))
    pen.line((60, 200), (340, 200))
    return Thing(pen.page, [], [(130, 120), (270, 120), (130, 280), (270, 280)])


def _envelope(pen: _Pen) -> Thing:
    pen.line((30, 100), (370, 100), (370, 300), (30, 300), closed=True)
    pen.line((30, 100), (200, 210), (370, 100))
    return Thing(pen.page, [], [(200, 140), (60, 200), (200, 270)])


def _playing_card(pen: _Pen) -> Thing:
    pen.line((80, 50), (320, 50), (320, 350), (80, 350), closed=True)
    pen.line((200, 140), (240, 200), (200, 260), (160, 200), closed=True)
    return Thing(pen.page, [], [(110, 90), (200, 200), (290, 320)])


def _sun(pen: _Pen) -> Thing:
    pen.arc((200, 200), (75, 75))
    for x, y in (
        (0, -1),
        (0.71, -0.71),
        (1, 0),
        (0.71, 0.71),
        (0, 1),
        (-0.71, 0.71),
        (-1, 0),
        (-0.71, -0.71),
    ):
        pen.line(*((round(200 + far * x), round(200 + far * y)) for far in (95, 150)))
    return Thing(pen.page, [(200, 20)], [(200, 200)])


def _flower(pen: _Pen) -> Thing:
    pen.arc((200, 140), (29, 29))
    petals = [(262, 140), (231, 194), (169, 194), (138, 140), (169, 86), (231, 86)]
    for petal in petals:
        pen.arc(petal, (31, 31))
    pen.line((200, 236), (200, 380))
    return Thing(pen.page, [], [(200, 140), *petals])


def _fence(pen: _Pen) -> Thing:
    left = (33, 104, 175, 246, 317)
    for x in left:
        pen.line((x, 300), (x, 120), (x + 23, 90), (x + 46, 120), (x + 46, 300), closed=True)
    for x, y in ((x, y) for x in left[:-1] for y in (150, 175, 240, 265)):
        pen.line((x + 46, y), (x + 71, y))
    return Thing(pen.page, [(92, 208), (234, 208)], [(56, 220), (198, 220), (340, 220)])


def _table(pen: _Pen) -> Thing:
    pen.line((33, 110), (367, 110), (367, 135), (33, 135), closed=True)
    pen.line((58, 135), (58, 310), (80, 310), (80, 135))
    pen.line((320, 135), (320, 310), (342, 310), (342, 135))
    return Thing(pen.page, [(200, 180), (200, 280)], [(200, 122), (69, 240), (331, 240)])


def _stool(pen: _Pen) -> Thing:
    pen.arc((200, 80), (100, 29))
    pen.arc((200, 103), (98, 29), 0, 180)
    pen.line((100, 84), (101, 106))
    pen.line((300, 84), (299, 106))
    pen.line((121, 121), (100, 355), (118, 355), (140, 127))
    pen.line((279, 121), (300, 355), (282, 355), (260, 127))
    pen.line((125, 255), (275, 255))
    pen.line((123, 270), (277, 270))
    return Thing(pen.page, [(200, 190), (200, 320)], [(200, 80), (110, 330), (200, 262)])


def _comb(pen: _Pen) -> Thing:
    pen.line((25, 120), (375, 120), (375, 162), (25, 162), closed=True)
    for x in range(33, 360, 31):
        pen.line((x, 162), (x, 254), (x + 15, 254), (x + 15, 162))
    return Thing(pen.page, [(56, 220), (180, 220), (304, 220)], [(200, 140), (40, 220), (195, 220)])


def _pizza(pen: _Pen) -> Thing:
    pen.line((50, 100), (200, 367), (350, 100), (50, 100))
    pen.arc((200, 100), (150, 45), 180, 360)
    slices = [(158, 158), (242, 175), (200, 258)]
    for middle in slices:
        pen.arc(middle, (25, 25))
    return Thing(pen.page, [], [(200, 120), *slices])


def _eye(pen: _Pen) -> Thing:
    pen.arc((200, 295), (195, 195), 209, 331)
    pen.arc((200, 105), (195, 195), 29, 151)
    pen.arc((200, 200), (58, 58))
    cv2.circle(pen.page, (200, 200), 25, 0, -1, cv2.LINE_AA)
    return Thing(pen.page, [], [(90, 200), (200, 160), (200, 200)])


def _rocket(pen: _Pen) -> Thing:
    pen.line((150, 300), (140, 160), (200, 35), (260, 160), (250, 300), closed=True)
    pen.arc((200, 142), (27, 27))
    pen.line((144, 228), (83, 300), (92, 333), (150, 292))
    pen.line((256, 228), (317, 300), (308, 333), (250, 292))
    return Thing(pen.page, [], [(200, 142), (200, 240), (110, 300), (290, 300)])


_DRAWN: tuple[Callable[[_Pen], Thing], ...] = (
    *(_mug, _key, _chair, _doughnut, _spectacles, _scissors, _bicycle, _tripod),
    *(_window, _envelope, _playing_card, _sun, _flower, _fence, _table),
    *(_stool, _comb, _pizza, _eye, _rocket),
)


def drawings() -> dict[str, Thing]:
    """Return the drawings by name."""
    return {draw.__name__[1:]: draw(_Pen()) for draw in _DRAWN}
