"""Objects for the reader's training pages: views of meshes, clip art, and doodles of plain shapes.

An object consists of contours, whose even-odd filling is its mask, and of strokes, in a square from 0 to 1.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.floating]
"""(P, 2), x and y."""
Part = tuple[Points, bool]
"""A closed outline, and whether a hole goes through it."""
Rng = np.random.Generator
Place = tuple[float, float] | NDArray[np.floating]
POINT = 32
_ROUND = 72
"""Number of points of an ellipse."""


@dataclass(frozen=True)
class Shape:
    """An object to be drawn, in a square from 0 to 1, y down.

    Args:
        name: name of the view or the doodle.
        contours: groups of contours, (P, 2) each. The even-odd filling of a group, united with those of the
            others, is the object with its holes.
        strokes: the lines, (P, 2) each.
        outlines: the number of strokes, from the first on, that are occluding contours; the others lie
            inside.
        normal: the normals (n, n, 3), or None.
        bare: strokes that are parts of the object themselves, such as whiskers and legs of one line.
        paint: the original clip art, a PNG; None for other objects. See `drawn`.
        lined: whether dark lines bound the clip art.
    """

    name: str
    contours: list[list[Points]]
    strokes: list[Points]
    outlines: int
    normal: NDArray[np.float32] | None = None
    bare: list[Points] = field(default_factory=list)
    paint: NDArray[np.uint8] | None = None
    lined: bool = False

    def drawn(self) -> NDArray[np.uint8]:
        """Return the original clip art, (n, n, 4), BGRA."""
        assert self.paint is not None
        return np.asarray(cv2.imdecode(self.paint, cv2.IMREAD_UNCHANGED), np.uint8)

    @property
    def pierced(self) -> bool:
        """Whether a hole through it is large enough to be visible."""
        areas = [cv2.contourArea(c, oriented=True) for group in self.contours for c in group]
        return bool(areas) and min(areas) * max(areas) < 0 and min(map(abs, (min(areas), max(areas)))) > 0.002


class Views:
    """The views that `views.py` and `clipart.py` stored; every sixteenth mesh or drawing is held out."""

    def __init__(self, folder: Path, held_out: bool, most: int | None = None) -> None:
        self.folder, self.held_out = folder, held_out
        self.shapes: list[Shape] = []
        self.pierced: list[Shape] = []
        self._seen: set[str] = set()
        self.reload(most)

    def reload(self, most: int | None = None) -> None:
        """Read the files that were added since the last call."""
        for path in sorted(self.folder.glob("views_*.npz")):
            if path.name in self._seen or (most is not None and len(self._seen) >= most):
                continue
            self._seen.add(path.name)
            with np.load(path) as stored:
                for number, name in enumerate(json.loads(str(stored["names"]))):
                    mesh = name.rsplit("/", 1)[0]
                    if (sum(mesh.encode()) % 16 == 0) == self.held_out:
                        self.shapes.append(
                            _view(
                                name,
                                {
                                    key: stored[f"{number}.{key}"]
                                    for key in (
                                        "mask",
                                        "normal",
                                        "points",
                                        "lengths",
                                        "outlines",
                                        "paint",
                                        "lined",
                                    )
                                    if f"{number}.{key}" in stored
                                },
                            )
                        )
        self.pierced = [shape for shape in self.shapes if shape.pierced]


def _view(name: str, stored: dict[str, NDArray[Any]]) -> Shape:
    bits = np.unpackbits(stored["mask"])
    size = round(len(bits) ** 0.5)
    mask = cv2.resize(bits.reshape(size, size), None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST)
    found, _ = cv2.findContours(np.pad(mask, 1), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    # Contours run through the pixel centres of the doubled mask, half a pixel inside its edge.
    contours = [_contour((c[:, 0].astype(np.float32) - 0.5) / (2 * size)) for c in found if len(c) > 8]
    points = stored["points"].astype(np.float32) / (POINT * size)
    strokes = np.split(points, np.cumsum(stored["lengths"])[:-1])
    normal = stored["normal"].astype(np.float32) / np.float32(127) if "normal" in stored else None
    return Shape(
        name,
        [contours],
        strokes,
        int(stored["outlines"]),
        normal,
        paint=stored.get("paint"),
        lined=bool(stored.get("lined", False)),
    )


def darkness(colour: NDArray[Any]) -> NDArray[np.float32]:
    """Return for colours (h, w, 3) in [0, 255] how dark a line each pixel is, in [0, 1]."""
    dark: NDArray[np.float32] = np.clip((150 - colour.max(2)) / np.float32(80), 0, 1)
    return dark


def _contour(pixels: Points) -> Points:
    return np.ascontiguousarray(smoothed(pixels, closed=True)[::3])


def smoothed(path: Points, closed: bool) -> Points:
    """Return a path along pixels with its staircase smoothed, with the same number of points."""
    before, after = (path[-3:], path[:3]) if closed else (path[:1].repeat(3, 0), path[-1:].repeat(3, 0))
    around = np.concatenate([before, path, after])
    kernel = np.array([1, 2, 3, 4, 3, 2, 1], np.float32) / 16
    return np.stack([np.convolve(around[:, k], kernel, "valid") for k in (0, 1)], 1).astype(np.float32)


def doodle(rng: Rng, kind: str | None = None) -> Shape:
    """Return a figure of round and pointed parts, like those of children and sign painters."""
    kinds = [
        *("figure", "animal", "blob", "thing", "stick", "ring"),
        *("snow", "frame", "wire", "plain", "row", "lobes"),
    ]
    shares = [0.12, 0.1, 0.06, 0.11, 0.08, 0.08, 0.02, 0.03, 0.04, 0.15, 0.13, 0.08]
    return _Doodle(rng).draw(kind or str(rng.choice(kinds, p=shares)))


def sheet(rng: Rng, sides: NDArray[np.floating]) -> Shape:
    """Return a card, a sign or a window: one closed line around the page that is an object, not a frame.

    It contains only plain figures, bars or rows. Around a drawing, the same line near the edge of the page
    would be a frame.

    Args:
        rng: a source of chance.
        sides: width and height, in [0, 1].
    """
    round_ = rng.random() < 0.3
    t = np.linspace(0, 2 * np.pi, 160, endpoint=False)
    power = rng.choice([1.0, 0.6, 0.3])
    c, s = np.cos(t), np.sin(t)
    unit: NDArray[np.floating] = np.stack(
        [np.sign(c) * np.abs(c) ** power, np.sign(s) * np.abs(s) ** power], 1
    )
    if not round_:
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float32)
        if rng.random() < 0.15:
            around = np.arange(n := rng.integers(5, 9)) * 2 * np.pi / n + rng.choice(
                [0, np.pi / n, np.pi / 2]
            )
            corners = np.stack([np.cos(around), np.sin(around)], 1).astype(np.float32)
            corners /= np.abs(corners).max(0)
        unit = _dense(corners + rng.choice([0.0, 0.03]) * rng.normal(0, 1, corners.shape).astype(np.float32))
    if rng.random() < 0.3:
        sides = sides * np.where(rng.permutation(2) > 0, 1, rng.uniform(0.45, 0.95))
    outline = (0.5 + 0.5 * unit * sides).astype(np.float32)
    inside: list[Points] = []
    if rng.random() < 0.35:
        inside = _divisions(rng, outline, straight=not round_ and len(corners) == 4)
    elif rng.random() < 0.8:
        inside = _figures(rng, outline, rings=round_)
    return _shape("doodle/sheet", [(outline, True)], inside, [], [], False, False, [])


def _divisions(rng: Rng, outline: Points, straight: bool) -> list[Points]:
    """Return the inner lines of a man-made thing: the bars of a window, the rim of a screen, rows of text.

    Args:
        rng: a source of chance.
        outline: (P, 2), convex.
        straight: whether it is a rectangle, which bars cross from side to side.
    """
    low, high = outline.min(0), outline.max(0)
    middle, room = (low + high) / 2, (high - low) / 2
    kind = rng.choice(["bars", "rim", "rows"], p=[0.5, 0.35, 0.15] if straight else [0, 0.7, 0.3])
    if kind == "rim":
        share = rng.uniform(0.6, 0.94)
        rim = (middle + (outline - middle) * share).astype(np.float32)
        figures = _figures(rng, rim, rings=not straight) if rng.random() < 0.5 else []
        return [_closed(rim), *figures]
    lines: list[Points] = []
    if kind == "rows":
        reach = rng.uniform(0.3, 0.6) * room[0]
        for y in middle[1] + np.linspace(-0.5, 0.5, rng.integers(2, 7)) * room[1]:
            end = reach * rng.uniform(0.3, 1)
            lines.append(np.array([[middle[0] - reach, y], [middle[0] + end, y]], np.float32))
        return lines
    for axis, count in enumerate(rng.permutation([rng.integers(1, 4), rng.integers(0, 4)])):
        for k in range(count):
            at = low[axis] + (k + 1) / (count + 1) * 2 * room[axis] + rng.choice([0.0, 0.02]) * rng.normal()
            bar = np.stack([low, high]).astype(np.float32)
            bar[:, axis] = at
            lines.append(bar)
    return lines


def _figures(rng: Rng, outline: Points, rings: bool) -> list[Points]:
    """Return plain closed figures inside an outline: discs, stars, polygons.

    Args:
        rng: a source of chance.
        outline: (P, 2), convex or nearly so.
        rings: whether a disc in its middle would make it a ring.
    """
    middle, room = outline.mean(0), np.ptp(outline, axis=0) / 2
    least = float(room.min())
    figures: list[Points] = []
    placed: list[tuple[NDArray[np.floating], float]] = []
    count = 1 if rng.random() < 0.6 else int(rng.integers(2, 7))
    for _ in range(count):
        radius = least * (rng.uniform(0.15, 0.65) if count == 1 else rng.uniform(0.08, 0.3))
        centre = middle + rng.uniform(-1, 1, 2) * np.maximum(0.72 * room - radius, 0) * rng.choice(
            [0, 0.4, 1]
        )
        if any(np.hypot(*(centre - other)) < 1.3 * (radius + size) for other, size in placed):
            continue
        placed.append((centre, radius))
        n = int(rng.choice([3, 4, 5, 6, 60], p=[0.12, 0.13, 0.25, 0.1, 0.4]))
        if rings and n == 60 and radius > 0.2 * least:
            n = 5
        pointed = n < 60 and rng.random() < (0.8 if n >= 5 else 0.3)
        t = np.arange(2 * n) * np.pi / n - np.pi / 2 + (0 if rng.random() < 0.6 else rng.uniform(0, 6.28))
        reach = np.where(np.arange(2 * n) % 2, rng.uniform(0.35, 0.6) if pointed else np.cos(np.pi / n), 1)
        flat = 1.0 if rng.random() < 0.7 else rng.uniform(0.5, 1)
        figure = centre + radius * np.stack([reach * np.cos(t), flat * reach * np.sin(t)], 1)
        figures.append(_closed(figure.astype(np.float32)))
    return figures


class _Doodle:
    def __init__(self, rng: Rng) -> None:
        self.rng = rng
        self.parts: list[Part] = []
        self.details: list[Points] = []
        self.bare: list[Points] = []
        self.bodies: list[Part] = []  # parts without a line around them
        self.holes: list[Points] = []
        self.merged = False  # whether lines inside the union of its parts are left out

    def ellipse(
        self,
        cx: float,
        cy: float,
        rx: float,
        ry: float,
        turn: float = 0.0,
        squareness: float | None = None,
        wobble: float | None = None,
    ) -> Points:
        rng = self.rng
        power = float(rng.choice([1.0, 1.0, 1.0, 0.7, 0.45])) if squareness is None else squareness
        t = np.linspace(0, 2 * np.pi, _ROUND, endpoint=False) + rng.uniform(0, 6.28)
        c, s = np.cos(t), np.sin(t)
        x, y = np.sign(c) * np.abs(c) ** power, np.sign(s) * np.abs(s) ** power
        wobble = float(rng.choice([0, 0.02, 0.06, 0.12])) if wobble is None else wobble
        if wobble:
            k = rng.integers(2, 6)
            r = 1 + wobble * np.sin(k * t + rng.uniform(0, 6.28)) + wobble / 2 * np.sin((k + 3) * t)
            x, y = x * r, y * r
        a, b = np.cos(turn), np.sin(turn)
        return np.stack([cx + rx * x * a - ry * y * b, cy + rx * x * b + ry * y * a], 1).astype(np.float32)

    def tube(self, path: Points, widths: Sequence[float]) -> Points:
        path = _resampled(np.asarray(path, np.float32), 24)
        way = np.gradient(path, axis=0)
        way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
        across = np.stack([-way[:, 1], way[:, 0]], 1)
        w = np.interp(np.linspace(0, 1, 24), np.linspace(0, 1, len(widths)), widths)[:, None] / 2
        cap = []
        if self.rng.random() < 0.6:
            angle = np.linspace(np.pi / 2, -np.pi / 2, 9)[1:-1, None]
            cap = [path[-1] + w[-1] * (np.sin(angle) * across[-1] + np.cos(angle) * way[-1])]
        return np.concatenate([path + w * across, *cap, (path - w * across)[::-1]]).astype(np.float32)

    def limb(self, start: Place, angle: float, length: float, width: float) -> tuple[Points, Points]:
        rng = self.rng
        way = np.array([np.cos(angle), np.sin(angle)])
        bend = rng.normal(0, 0.25, 2) * length
        start = np.asarray(start)
        path = np.stack([start, start + way * length * 0.5 + bend * 0.5, start + way * length])
        return path, self.tube(
            _curve(path), (width, width * rng.uniform(0.6, 1.3), width * rng.uniform(0.4, 1.2))
        )

    def face(self, cx: float, cy: float, r: float) -> None:
        rng = self.rng
        if rng.random() < 0.85:
            size = r * rng.uniform(0.05, 0.25)
            for side in (-1, 1):
                eye = self.ellipse(
                    cx + side * r * 0.38, cy - r * 0.15, size, size * rng.uniform(0.8, 1.6), wobble=0
                )
                self.details.append(_closed(eye))
                if size > 0.1 * r and rng.random() < 0.6:
                    self.details.append(
                        _closed(
                            self.ellipse(
                                cx + side * r * 0.38, cy - r * 0.12, size * 0.4, size * 0.4, wobble=0
                            )
                        )
                    )
        if rng.random() < 0.8:
            t = np.linspace(0.2, np.pi - 0.2, 14)
            self.details.append(
                np.stack(
                    [cx + 0.5 * r * np.cos(t), cy + 0.25 * r + rng.uniform(-0.2, 0.4) * r * np.sin(t)], 1
                ).astype(np.float32)
            )
        if rng.random() < 0.4:
            self.details.append(
                np.array(
                    [[cx, cy - 0.05 * r], [cx - 0.1 * r, cy + 0.15 * r], [cx + 0.05 * r, cy + 0.17 * r]],
                    np.float32,
                )
            )

    def hair(self, cx: float, cy: float, r: float) -> None:
        rng = self.rng
        for angle in rng.uniform(np.pi * 1.05, np.pi * 1.95, rng.integers(3, 14)):
            start = np.array([cx + r * np.cos(angle), cy + r * np.sin(angle)])
            end = start + r * rng.uniform(0.15, 0.9) * np.array(
                [np.cos(angle + rng.normal(0, 0.4)), np.sin(angle + rng.normal(0, 0.2))]
            )
            self.bare.append(_curve(np.stack([start, (start + end) / 2 + rng.normal(0, 0.08 * r, 2), end])))

    def draw(self, kind: str) -> Shape:
        rng = self.rng
        getattr(self, "_" + kind)()
        overlap = rng.random() < 0.35  # as children draw: every circle is complete
        return _shape(
            f"doodle/{kind}",
            self.parts,
            self.details,
            self.bare,
            self.holes,
            overlap,
            self.merged,
            self.bodies,
        )

    def _figure(self) -> None:  # noqa: PLR0912 - one choice after the other
        rng = self.rng
        head, body = rng.uniform(0.08, 0.2), rng.uniform(0.1, 0.24)
        high = rng.uniform(0.12, 0.24)
        cy = 0.5
        hy = cy - high - head * rng.uniform(0.85, 1.1)
        sticks = rng.random() < 0.25
        legs = []
        for side in (-1, 1):
            spread = rng.uniform(0.05, 0.5)
            for start, angle, length in (
                (
                    (0.5 + side * body * 0.8, cy - high * 0.5),
                    (0 if side > 0 else np.pi) + side * rng.uniform(-0.8, 0.9),
                    rng.uniform(0.15, 0.32),
                ),
                (
                    (0.5 + side * body * 0.45, cy + high * 0.85),
                    np.pi / 2 - side * spread,
                    rng.uniform(0.15, 0.32),
                ),
            ):
                path, tube = self.limb(start, angle, length, rng.uniform(0.04, 0.13))
                if sticks:
                    self.bare.append(_curve(path))
                    if rng.random() < 0.5:
                        end = path[-1]
                        for finger in rng.uniform(-1, 1, 3):
                            self.bare.append(
                                np.stack(
                                    [
                                        end,
                                        end
                                        + 0.04 * np.array([np.cos(angle + finger), np.sin(angle + finger)]),
                                    ]
                                ).astype(np.float32)
                            )
                else:
                    legs.append(tube)
                    if rng.random() < 0.5:
                        legs.append(self.ellipse(*path[-1], *rng.uniform(0.025, 0.08, 2)))
        self.parts += [(leg, True) for leg in legs]
        if rng.random() < 0.3:
            skirt = np.array(
                [
                    [0.5 - body * 0.6, cy],
                    [0.5 + body * 0.6, cy],
                    [0.5 + body * 1.4, cy + high * 1.4],
                    [0.5 - body * 1.4, cy + high * 1.4],
                ],
                np.float32,
            )
            self.parts.append((skirt, True))
        self.parts.append((self.ellipse(0.5, cy, body, high), True))
        if rng.random() < 0.4:
            self.parts.insert(
                0,
                (
                    self.tube(np.array([[0.5, cy - high * 0.8], [0.5, hy]], np.float32), (head * 0.6,) * 2),
                    True,
                ),
            )
        self.parts.append((self.ellipse(0.5, hy, head, head * rng.uniform(0.8, 1.2)), True))
        if rng.random() < 0.3:
            for side in (-1, 1):
                self.parts.append(
                    (
                        self.ellipse(
                            0.5 + side * head * 0.9,
                            hy - head * 0.6,
                            head * 0.35,
                            head * rng.uniform(0.3, 0.9),
                        ),
                        True,
                    )
                )
        if rng.random() < 0.4:
            self.hair(0.5, hy, head)
        self.face(0.5, hy, head)
        if rng.random() < 0.4:
            for k in range(rng.integers(1, 4)):
                self.details.append(
                    _closed(self.ellipse(0.5, cy - high * 0.4 + k * high * 0.4, 0.012, 0.012, wobble=0))
                )

    def scribble(self, part: Points, edge: bool) -> None:
        """Add a part filled with a line to and fro, with or without an edge."""
        rng = self.rng
        low, high = part.min(0), part.max(0)
        turn = rng.uniform(0, np.pi)
        along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
        middle, reach = (low + high) / 2, np.linalg.norm(high - low) / 2
        points = []
        for k, away in enumerate(np.arange(-reach, reach, rng.uniform(0.004, 0.02))):
            line = middle + across * away + along * np.linspace(-reach, reach, 64)[:, None]
            inside = [cv2.pointPolygonTest(part, (float(x), float(y)), False) > 0 for x, y in line]
            line = line[inside]
            if len(line):
                ends = line[[0, -1]] + rng.normal(0, 0.004, (2, 2))
                points.append(ends if k % 2 else ends[::-1])
        if points:
            self.details.append(np.concatenate(points).astype(np.float32))
        (self.parts if edge else self.bodies).append((part, True))

    def _child(self) -> None:
        """Add a person as a child draws one: a big head, closed shapes as limbs, clothes, hair."""
        rng = self.rng
        head = rng.uniform(0.1, 0.22)
        wide, high = rng.uniform(0.06, 0.24), rng.uniform(0.08, 0.22)
        neck = rng.uniform(0, 0.07) if rng.random() < 0.5 else -rng.uniform(0.0, 0.05)
        cy = 0.55
        hy = cy - high - neck - head * 0.9
        leg, arm = rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.3)
        thick = rng.uniform(0.02, 0.16)
        kind = rng.integers(4)  # tubes, ellipses, tapered, open ones
        for side in (-1, 1):
            lean = rng.uniform(-0.1, 0.6) if rng.random() < 0.5 else 0.05
            for start, way, length in (
                ((0.5 + side * wide * 0.85, cy - high * 0.7), np.pi / 2 - side * rng.uniform(0.2, 2.2), arm),
                ((0.5 + side * wide * 0.5, cy + high * 0.9), np.pi / 2 - side * lean, leg),
            ):
                step = np.array([np.cos(way), np.sin(way)])
                end = np.array(start) + length * step
                limb = thick * rng.uniform(0.7, 1.2)
                if kind == 1:
                    x, y = (np.array(start) + end) / 2
                    part = self.ellipse(x, y, length * 0.6, limb, turn=way, squareness=1.0)
                else:
                    widths = (limb, limb) if kind == 0 else (limb, limb * rng.uniform(0.1, 0.8))
                    part = self.tube(np.stack([start, end]), widths)
                self.parts.append((part, True))
                if rng.random() < 0.6:
                    self.parts.append((self.ellipse(*end, *rng.uniform(0.02, 0.07, 2)), True))
                elif rng.random() < 0.6:
                    for finger in rng.uniform(-0.9, 0.9, rng.integers(2, 6)):
                        tip = np.array([np.cos(way + finger), np.sin(way + finger)])
                        self.bare.append(
                            np.stack([end, end + rng.uniform(0.02, 0.06) * tip]).astype(np.float32)
                        )
        body = self.ellipse(0.5, cy, wide, high, squareness=float(rng.choice([0.3, 1.0])))
        self.parts.append((body, True))
        if neck > 0:
            ends = np.array([[0.5, cy - high], [0.5, hy + head * 0.8]], np.float32)
            self.parts.append((self.tube(ends, (head * rng.uniform(0.2, 0.6),) * 2), True))
        self._clothes(cy, wide, high)
        self.parts.append((self.ellipse(0.5, hy, head, head * rng.uniform(0.8, 1.2)), True))
        self._headdress(hy, head)
        self.face(0.5, hy, head)
        if rng.random() < 0.3:
            for k in range(rng.integers(1, 5)):
                button = self.ellipse(0.5, cy - high * 0.5 + k * high * 0.3, 0.012, 0.012, wobble=0)
                self.details.append(_closed(button))

    def _clothes(self, cy: float, wide: float, high: float) -> None:
        """Add a skirt, a belt or nothing."""
        rng = self.rng
        if rng.random() < 0.4:
            hem = cy + high * rng.uniform(0.9, 1.5)
            top = rng.uniform(-0.9, 0.6)
            skirt = np.array(
                [[0.5 - wide, cy + high * top], [0.5 + wide, cy + high * top], [0.5 + wide * 1.8, hem],
                 [0.5 - wide * 1.8, hem]], np.float32,
            )  # fmt: skip
            if rng.random() < 0.3:
                self.scribble(_dense(skirt), True)
            else:
                self.parts.append((_dense(skirt), True))
                for x in rng.uniform(-1, 1, rng.integers(0, 6)):
                    fold = np.array(
                        [[0.5 + wide * x, hem - high * 0.5], [0.5 + 1.6 * wide * x, hem]], np.float32
                    )
                    self.details.append(fold)
        elif rng.random() < 0.3:
            y = cy + high * rng.uniform(-0.3, 0.7)
            self.details.append(np.array([[0.5 - wide, y], [0.5 + wide, y]], np.float32))

    def _headdress(self, hy: float, head: float) -> None:
        """Add hair, a crown, a hat or nothing."""
        rng = self.rng
        hair = rng.integers(6)
        if hair == 0:
            self.hair(0.5, hy, head)
        elif hair == 1:  # a cap of scribbled hair
            cap = self.ellipse(0.5, hy - head * 0.55, head * 1.05, head * 0.6)
            self.scribble(cap, bool(rng.random() < 0.5))
        elif hair == 2:  # bunches or plaits
            for side in (-1, 1):
                at = np.array([0.5 + side * head, hy - head * 0.4])
                drop = np.array([side * rng.uniform(0.2, 0.8), rng.uniform(0.4, 1.6)]) * head
                part = self.tube(
                    _curve(np.stack([at, at + drop * np.array([1.1, 0.1]), at + drop])),
                    (head * 0.3, head * 0.5, head * 0.1),
                )
                if rng.random() < 0.5:
                    self.scribble(part, bool(rng.random() < 0.5))
                else:
                    self.parts.append((part, True))
        elif hair == 3:  # a crown or spikes
            n = rng.integers(3, 8)
            x = np.linspace(-0.8, 0.8, 2 * n + 1) * head
            y = -np.sqrt(np.maximum(head**2 - x**2, 0)) - np.where(np.arange(2 * n + 1) % 2, 0.5, 0.1) * head
            crown = np.stack([0.5 + x, hy + y], 1)
            crown = np.concatenate([crown, [[0.5 + x[-1], hy - head * 0.5], [0.5 + x[0], hy - head * 0.5]]])
            part = _dense(crown.astype(np.float32))
            if rng.random() < 0.4:
                self.scribble(part, True)
            else:
                self.parts.append((part, True))
        elif hair == 4:  # a hat
            brim = np.array([[-1.2, -0.7], [1.2, -0.7], [0.7, -0.9], [0.6, -1.7], [-0.6, -1.7], [-0.7, -0.9]])
            self.parts.append((_dense((brim * head + [0.5, hy]).astype(np.float32)), True))

    def _strokes(self) -> None:
        """Add strokes that are objects themselves: flourishes, distant birds, waves, brush letters."""
        rng = self.rng
        if rng.random() < 0.6:  # birds
            largest = rng.uniform(0.06, 0.25)
            for _ in range(rng.integers(2, 10) if rng.random() < 0.4 else rng.integers(10, 40)):
                x, y = rng.uniform(0.05, 0.95, 2)
                r = largest * rng.uniform(0.2, 1)
                for side in (-1, 1):
                    wing = np.array([[x, y], [x + side * r * 0.5, y - r * 0.6], [x + side * r, y - r * 0.1]])
                    self.bare.append(_curve(wing + rng.normal(0, 0.1 * r, wing.shape)))
            return
        for _ in range(rng.integers(1, 5)):
            t = np.linspace(0, rng.uniform(2, 9), 40)
            spiral = np.exp(-t * rng.uniform(0.15, 0.4)) * rng.uniform(0.1, 0.3)
            start = rng.uniform(0.25, 0.75, 2)
            drift = rng.normal(0, 0.04, 2)
            line = start + np.stack([spiral * np.cos(t), spiral * np.sin(t)], 1) + drift * t[:, None]
            self.bare.append(line.astype(np.float32))

    def _animal(self) -> None:
        rng = self.rng
        length, high = rng.uniform(0.2, 0.32), rng.uniform(0.1, 0.2)
        sticks = rng.random() < 0.15
        for k in range(rng.choice([2, 4, 4, 4, 6])):
            x = 0.5 + length * np.linspace(-0.8, 0.8, 6)[k % 6 if k < 6 else 0] + rng.normal(0, 0.02)
            x = 0.5 + length * (-0.75 + 1.5 * k / 3) if k < 4 else x
            path, tube = self.limb(
                (x, 0.5 + high * 0.6),
                np.pi / 2 + rng.normal(0, 0.25),
                rng.uniform(0.12, 0.3),
                rng.uniform(0.03, 0.1),
            )
            if sticks:
                self.bare.append(_curve(path))
            else:
                self.parts.append((tube, True))
        if rng.random() < 0.7:
            path, tube = self.limb(
                (0.5 - length * 0.9, 0.48),
                np.pi + rng.normal(0, 0.7),
                rng.uniform(0.1, 0.28),
                rng.uniform(0.015, 0.06),
            )
            if rng.random() < 0.5:
                self.bare.append(_curve(path))
            else:
                self.parts.append((tube, True))
        self.parts.append((self.ellipse(0.5, 0.5, length, high), True))
        head = rng.uniform(0.08, 0.16)
        hx, hy = 0.5 + length * rng.uniform(0.8, 1.2), 0.5 - high * rng.uniform(0.2, 1.4)
        if rng.random() < 0.4:
            self.parts.append(
                (
                    self.tube(
                        np.array([[0.5 + length * 0.7, 0.5], [hx, hy]], np.float32), (head, head * 0.8)
                    ),
                    True,
                )
            )
        for side in (-1, 1):
            if rng.random() < 0.8:
                ear = np.array(
                    [
                        [hx + side * head * 0.3, hy - head * 0.7],
                        [hx + side * head * rng.uniform(0.5, 1.2), hy - head * rng.uniform(1.2, 2.2)],
                        [hx + side * head * 0.85, hy - head * 0.4],
                    ],
                    np.float32,
                )
                x, y = ear.mean(0)
                self.parts.append(
                    (ear if rng.random() < 0.5 else self.ellipse(x, y, head * 0.25, head * 0.5), True)
                )
        self.parts.append((self.ellipse(hx, hy, head, head * rng.uniform(0.7, 1)), True))
        self.face(hx, hy, head)
        if rng.random() < 0.25:
            for side in (-1, 1):
                for k in range(3):
                    self.bare.append(
                        np.array(
                            [
                                [hx + side * head * 0.4, hy + head * 0.2],
                                [hx + side * head * 1.5, hy + head * (0.05 + 0.2 * k)],
                            ],
                            np.float32,
                        )
                    )

    def _plain(self) -> None:
        """Add one empty closed line, or a sign: a disc, a square, a triangle."""
        rng = self.rng
        if rng.random() < 0.25:  # a card, a door
            corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * rng.uniform(0.1, 0.3, 2) + 0.5
            outline = _dense(corners.astype(np.float32))
        elif rng.random() < 0.3:  # a coin, a ball
            outline = self.ellipse(0.5, 0.5, 0.3, 0.3, squareness=1.0, wobble=0)
        elif rng.random() < 0.6:
            size = rng.uniform(0.1, 0.3)
            flat = size * (1.0 if rng.random() < 0.4 else rng.uniform(0.3, 1))
            outline = self.ellipse(
                0.5, 0.5, size, flat, turn=rng.uniform(0, 3.14), wobble=float(rng.choice([0, 0.03]))
            )
        else:
            n = rng.integers(3, 7)
            t = np.arange(n) * 2 * np.pi / n + rng.uniform(0, 6.28)
            r = 0.3 * (1 + (rng.normal(0, 0.15, n) if rng.random() < 0.5 else 0))
            outline = _dense(np.stack([0.5 + r * np.cos(t), 0.5 + r * np.sin(t)], 1).astype(np.float32))
        self.parts.append((outline, True))
        if rng.random() < 0.3:
            self.details += _figures(rng, outline, rings=len(outline) == _ROUND)
            return
        for _ in range(rng.integers(1, 6) if rng.random() < 0.4 else 0):
            cx, cy = 0.5 + 0.1 * rng.uniform(-1, 1, 2)
            rx, ry = rng.uniform(0.01, 0.09, 2)
            small = self.ellipse(cx, cy, rx, ry, turn=rng.uniform(0, 3))
            self.details.append(_closed(small))

    def _blob(self) -> None:
        rng = self.rng
        for _ in range(rng.integers(1, 5)):
            cx, cy = rng.uniform(0.35, 0.65, 2)
            rx, ry = rng.uniform(0.08, 0.32, 2)
            blob = self.ellipse(cx, cy, rx, ry, turn=rng.uniform(0, 3.14), wobble=rng.uniform(0, 0.2))
            self.parts.append((blob, True))
        for _ in range(rng.integers(0, 5)):
            cx, cy = rng.uniform(0.35, 0.65, 2)
            self.details.append(
                _closed(self.ellipse(cx, cy, *rng.uniform(0.02, 0.1, 2)))
                if rng.random() < 0.6
                else _curve(rng.uniform(0.35, 0.65, (3, 2)).astype(np.float32))
            )

    def _thing(self) -> None:
        """Add polygons: stars, houses, boxes with stripes and windows; or leaves and drops."""
        rng = self.rng
        n = rng.integers(3, 9)
        t = np.linspace(0, 2 * np.pi, n, endpoint=False) + rng.uniform(0, 6.28)
        r = rng.uniform(0.2, 0.4) * (1 + rng.uniform(0, 0.4) * rng.normal(0, 1, n)).clip(0.5, 1.6)
        outer = np.stack([0.5 + r * np.cos(t), 0.5 + r * np.sin(t)], 1)
        if rng.random() < 0.4:
            inner = np.stack(
                [0.5 + 0.45 * r * np.cos(t + np.pi / n), 0.5 + 0.45 * r * np.sin(t + np.pi / n)], 1
            )
            outer = np.stack([outer, inner], 1).reshape(-1, 2)
        if rng.random() < 0.4:
            outer = np.array(
                [
                    [0.5 - r[0], 0.5 - r[1]],
                    [0.5 + r[0], 0.5 - r[1]],
                    [0.5 + r[0], 0.5 + r[1]],
                    [0.5 - r[0], 0.5 + r[1]],
                ]
            )
        outer = outer.astype(np.float32)
        self.parts.append((_dense(outer), True))
        kind = rng.integers(4)
        low, high = outer.min(0), outer.max(0)
        if kind == 0:
            for y in np.linspace(low[1], high[1], rng.integers(4, 12))[1:-1]:
                self.details.append(np.array([[low[0], y], [high[0], y]], np.float32))
        elif kind == 1:
            for _ in range(rng.integers(1, 5)):
                cx, cy = rng.uniform(low * 0.7 + high * 0.3, low * 0.3 + high * 0.7)
                rx, ry = rng.uniform(0.02, 0.07, 2)
                self.details.append(
                    _closed(self.ellipse(cx, cy, rx, ry, squareness=float(rng.choice([0.3, 1.0]))))
                )
        elif kind == 2 and rng.random() < 0.5:  # a porthole
            size = min(high - low) * rng.uniform(0.12, 0.25)
            cx, cy = 0.5 + (high - low) * rng.uniform(-0.2, 0.2, 2)
            self.details.append(_closed(self.ellipse(cx, cy, size, size, squareness=1.0, wobble=0)))
        if rng.random() < 0.3:
            self.parts.insert(
                0,
                (
                    self.tube(
                        np.array([[0.5, 0.5], [0.5 + rng.uniform(-0.3, 0.3), 0.95]], np.float32), (0.05, 0.05)
                    ),
                    True,
                ),
            )

    def _stick(self) -> None:
        rng = self.rng
        head = rng.uniform(0.07, 0.16)
        self.parts.append((self.ellipse(0.5, 0.22, head, head), True))
        hip = np.array([0.5 + rng.normal(0, 0.05), 0.6])
        neck = np.array([0.5, 0.22 + head])
        self.bare.append(np.stack([neck, hip]).astype(np.float32))
        for side in (-1, 1):
            arm = neck + np.array([0, 0.07])
            self.bare.append(
                _curve(
                    np.stack(
                        [
                            arm,
                            arm + np.array([side * 0.12, rng.uniform(-0.1, 0.15)]),
                            arm + np.array([side * 0.24, rng.uniform(-0.2, 0.25)]),
                        ]
                    )
                )
            )
            self.bare.append(
                _curve(
                    np.stack(
                        [
                            hip,
                            hip + np.array([side * 0.08, 0.15]),
                            hip + np.array([side * rng.uniform(0.05, 0.2), 0.32]),
                        ]
                    )
                )
            )
        self.face(0.5, 0.22, head)

    def _ring(self) -> None:
        """Add things with a hole through them: handles, rings, frames, loops."""
        rng = self.rng
        if rng.random() < 0.5:
            wide, high = rng.uniform(0.12, 0.25), rng.uniform(0.15, 0.25)
            body = self.ellipse(0.45, 0.5, wide, high, squareness=0.35, wobble=0)
            reach, room = rng.uniform(0.1, 0.2), high * rng.uniform(0.4, 0.8)
            thick = rng.uniform(0.02, 0.06)
            outer = self.ellipse(0.45 + wide * 0.92, 0.5, reach, room, squareness=1.0, wobble=0)
            hole = self.ellipse(
                0.45 + wide * 0.92, 0.5, reach - thick, max(room - thick, 0.02), squareness=1.0, wobble=0
            )
            self.parts += [(outer, True)]
            self.holes.append(hole)
            self.parts += [(body, False)]
            self.details.append(
                _closed(
                    self.ellipse(0.45, 0.5 - high * 0.85, wide * 0.9, high * 0.15, squareness=1.0, wobble=0)
                )
            )
        else:
            r = rng.uniform(0.1, 0.2)
            cx, cy = rng.uniform(0.3, 0.7, 2)
            way = rng.uniform(0, 6.28)
            shaft = self.tube(
                np.array([[cx, cy], [cx + 0.5 * np.cos(way), cy + 0.5 * np.sin(way)]], np.float32),
                (0.05, 0.05),
            )
            self.parts += [(shaft, True), (self.ellipse(cx, cy, r, r, wobble=0, squareness=1.0), True)]
            self.holes.append(
                self.ellipse(
                    cx, cy, r * rng.uniform(0.4, 0.75), r * rng.uniform(0.4, 0.75), wobble=0, squareness=1.0
                )
            )

    def _wheel(self, cx: float, cy: float, r: float, thick: float) -> None:
        """Add a round or nearly round ring."""
        flat = self.rng.uniform(0.8, 1.25)
        self.parts.append((self.ellipse(cx, cy, r, r * flat, squareness=1.0, wobble=0), True))
        inner = self.ellipse(cx, cy, r - thick, r * flat - thick, squareness=1.0, wobble=0)
        self.holes.append(inner)

    def _bar(self, start: Place, end: Place, width: float, pierced: bool = False) -> None:
        """Add a straight bar; a hole behind it is visible only if the bar is pierced."""
        path = np.linspace(start, end, 8).astype(np.float32)
        self.parts.append((self.tube(path, (width, width)), pierced))

    def _frame(self) -> None:  # noqa: PLR0912 - one kind after the other
        """Add bars and rings that enclose air: spectacles, bicycles, tripods, ladders, chairs, fences."""
        rng = self.rng
        kind, width = rng.integers(5), rng.uniform(0.015, 0.06)
        if kind == 0:  # spectacles
            r, apart = rng.uniform(0.1, 0.18), rng.uniform(0.02, 0.1)
            for side in (-1, 1):
                self._wheel(0.5 + side * (r + apart / 2), 0.5, r, max(width * 0.6, 0.012))
            y = 0.5 - rng.uniform(0, 0.6) * r
            self._bar((0.5 - apart, y), (0.5 + apart, y), width * 0.7, pierced=True)
            if rng.random() < 0.6:
                for side in (-1, 1):
                    x = 0.5 + side * (2 * r + apart / 2)
                    self._bar((x, y), (x + side * 0.06, y - rng.uniform(0, 0.15)), width * 0.6)
        elif kind == 1:  # vehicles, wheels with spokes
            centres = [(x, 0.62) for x in ((0.28, 0.72) if rng.random() < 0.7 else (0.5,))]
            r = rng.uniform(0.12, 0.2)
            for x, y in centres:
                self._wheel(x, y, r, max(width * 0.7, 0.012))
                if rng.random() < 0.6:
                    self.parts.append((self.ellipse(x, y, 0.03, 0.03, squareness=1.0, wobble=0), False))
                for angle in rng.uniform(0, 6.28, rng.integers(0, 4)):
                    self._bar((x, y), (x + r * np.cos(angle), y + r * np.sin(angle)), width * 0.5)
            top = [(x + rng.normal(0, 0.05), 0.35 + rng.normal(0, 0.03)) for x in (0.4, 0.65)]
            if len(centres) == 2:
                for start, end in ((centres[0], top[0]), (top[0], top[1]), (top[1], centres[1])):
                    self._bar(start, end, width * 0.7)
                self._bar(top[1], (0.5, 0.62), width * 0.7)
                self._bar((0.5, 0.62), centres[0], width * 0.7)
        elif kind == 2:  # polygons of bars: tripods, hangers, trusses
            n = rng.integers(3, 6)
            t = np.sort(rng.uniform(0, 6.28, 1) + np.arange(n) * 2 * np.pi / n)
            corners = np.stack([0.5 + 0.35 * np.cos(t), 0.5 + 0.35 * rng.uniform(0.5, 1) * np.sin(t)], 1)
            for k in range(n):
                start, end = corners[k], corners[(k + 1) % n]
                over = rng.uniform(0, 0.25) if rng.random() < 0.4 else 0
                self._bar(start - over * (end - start), end + over * (end - start), width)
            if rng.random() < 0.5:
                self._bar(corners[0], (corners[1] + corners[2]) / 2, width)
        elif kind == 3:  # ladders, chairs' backs, fences, windows
            wide, high = rng.uniform(0.12, 0.35), rng.uniform(0.15, 0.4)
            for side in (-1, 1):
                self._bar((0.5 + side * wide, 0.5 - high), (0.5 + side * wide, 0.5 + high * 1.2), width)
            for y in np.linspace(-1, rng.uniform(0.2, 1), rng.integers(2, 6)):
                self._bar((0.5 - wide, 0.5 + y * high), (0.5 + wide, 0.5 + y * high), width)
        else:  # rings: tyres, doughnuts, frames
            r, share = rng.uniform(0.2, 0.4), rng.uniform(0.3, 0.8)
            square = float(rng.choice([1.0, 1.0, 0.3]))
            flat = rng.uniform(0.6, 1)
            self.parts.append((self.ellipse(0.5, 0.5, r, r * flat, squareness=square, wobble=0), True))
            shift = rng.normal(0, 0.1, 2) * r * (1 - share)
            x, y = 0.5 + shift
            hole = self.ellipse(x, y, r * share, r * flat * share, squareness=square, wobble=0)
            self.holes.append(hole)
            if rng.random() < 0.4:
                self._icing(r, share, flat, 0.5 + shift / 2, square)
        self.merged = bool(rng.random() < 0.5)

    def _icing(self, r: float, share: float, flat: float, middle: Place, square: float) -> None:
        """Draw icing and sprinkles on a ring."""
        rng = self.rng
        wide = r * (share + rng.uniform(0.4, 0.8) * (1 - share))
        x, y = middle
        edge = self.ellipse(x, y, wide, wide * flat, squareness=square, wobble=0.03)
        self.details.append(_closed(edge))
        for angle in rng.uniform(0, 6.28, rng.integers(0, 14)):
            at = 0.5 + r * (1 + share) / 2 * np.array([np.cos(angle), flat * np.sin(angle)])
            way = rng.normal(0, 0.04 * r, 2)
            self.details.append(np.stack([at - way, at + way]).astype(np.float32))

    def _wire(self) -> None:
        """Add single lines that enclose air, mostly with something solid on them: tripods, racks, swings."""
        rng = self.rng
        top = np.array([0.5, rng.uniform(0.2, 0.4)])
        count = rng.integers(2, 5)
        feet = np.stack([np.linspace(0.25, 0.75, count) + rng.normal(0, 0.03, count),
                         rng.uniform(0.75, 0.9) + rng.normal(0, 0.03, count)], 1)  # fmt: skip
        apart = rng.uniform(0, 0.15) if rng.random() < 0.5 else rng.uniform(0.3, 0.5)
        heads = np.stack([0.5 + np.linspace(-apart, apart, count) / 2, np.full(count, top[1])], 1)
        for head, foot in zip(heads, feet, strict=True):
            self.bare.append(np.stack([head, foot]).astype(np.float32))
        self.bare.append(np.stack([heads[0], heads[-1]]).astype(np.float32))
        for share in rng.uniform(0.3, 1, rng.integers(0, 3)):
            bar = heads[[0, -1]] * (1 - share) + feet[[0, -1]] * share
            self.bare.append(bar.astype(np.float32))
        solid = rng.integers(5)
        if solid == 0:
            self.parts.append((self.ellipse(*top, *rng.uniform(0.05, 0.2, 2)), True))
        elif solid == 1:
            ends = top + np.array([[-1, 0], [1, 0]]) * rng.uniform(0.1, 0.3) + rng.normal(0, 0.05, (2, 2))
            self.parts.append((self.tube(ends, (rng.uniform(0.02, 0.1),) * 2), True))
        elif solid == 2:
            low = feet.mean(0)
            self.parts.append((self.ellipse(*low, *rng.uniform(0.04, 0.12, 2)), True))
        elif solid == 3:
            hook = top + 0.06 * np.array([[0, 0], [rng.normal(), -1.2], [rng.normal(), -0.4]])
            self.bare.append(_curve(hook.astype(np.float32)))

    def _row(self) -> None:
        """Add equal solid pieces in a row or a circle, with air between them."""
        (self._sun, self._flower, self._planks)[self.rng.integers(3)]()

    def _sun(self) -> None:
        """Add a disc with rays, either lines or points."""
        rng = self.rng
        r, count, points = rng.uniform(0.1, 0.25), rng.integers(5, 17), rng.random() < 0.3
        near, far = r * rng.uniform(1.0, 1.4), r * rng.uniform(1.5, 2.2)
        for angle in np.arange(count) * 2 * np.pi / count + rng.uniform(0, 6.28):
            way, across = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            if points:
                base = 0.98 * r * way + np.stack([-across, across]) * r * 2 / count
                self.parts.append((_dense(0.5 + np.vstack([base, far * way]).astype(np.float32)), True))
            else:
                self.bare.append((0.5 + np.stack([near, far])[:, None] * way).astype(np.float32))
        self.parts.append((self.ellipse(0.5, 0.5, r, r, squareness=1.0, wobble=0), True))
        if rng.random() < 0.3:
            self.face(0.5, 0.5, r)

    def _flower(self) -> None:
        """Add petals around a disc, on a stem."""
        rng = self.rng
        r, count, y = rng.uniform(0.04, 0.12), rng.integers(4, 10), rng.uniform(0.3, 0.5)
        long, wide = r * rng.uniform(0.8, 1.8), r * rng.uniform(0.5, 1.1)
        stem = _curve(np.array([[0.5, y + r], [0.5 + rng.normal(0, 0.08), 0.75], [0.5, 0.95]]))
        if rng.random() < 0.5:
            self.bare.append(stem)
        else:
            self.parts.append((self.tube(stem, (0.02, 0.03)), True))
        for angle in np.arange(count) * 2 * np.pi / count + rng.uniform(0, 6.28):
            x, above = (r + long * 0.8) * np.cos(angle), (r + long * 0.8) * np.sin(angle)
            petal = self.ellipse(0.5 + x, y + above, long, wide, turn=angle, squareness=1.0, wobble=0)
            self.parts.append((petal, True))
        self.parts.append((self.ellipse(0.5, y, r, r, squareness=1.0, wobble=0), True))
        if rng.random() < 0.6:
            leaf = self.ellipse(0.57, 0.8, 0.08, 0.03, turn=-0.6, squareness=1.0, wobble=0)
            self.parts.append((leaf, True))

    def _lobes(self) -> None:
        """Add solid loops on a body or a stem: wings, leaves, bows."""
        rng = self.rng
        tall = rng.uniform(0.15, 0.4)
        bend = rng.normal(0, 0.06) if rng.random() < 0.5 else 0.0
        stem = _curve(np.array([[0.5, 0.5 - tall], [0.5 + bend, 0.5], [0.5, 0.5 + tall]]))
        wings = rng.random() < 0.6
        pairs = rng.integers(1, 3) if wings else rng.integers(3, 7)
        long = rng.uniform(0.15, 0.42) if wings else min(rng.uniform(0.1, 0.3), 2 * tall / pairs)
        wide = rng.uniform(0.3, 1.0) if wings else rng.uniform(0.2, 0.5)
        start, pointed, fuller = rng.uniform(-0.8, 0.2), rng.random() < 0.4, rng.choice([-0.4, -0.2, 0.3])
        around = np.linspace(0, 2 * np.pi, _ROUND, endpoint=False)
        across = wide * np.sin(around) * (0.6 + fuller * np.cos(around))
        loop = np.stack([(1 - np.cos(around)) / 2, across * (np.abs(np.sin(around)) if pointed else 1)], 1)
        shift = rng.choice([0.0, 0.5])
        for k, side in ((k, side) for k in range(pairs) for side in (-1, 1) if rng.random() < 0.95):
            root = stem[min(int((k + 0.5 + shift * (side > 0)) / pairs * len(stem)), len(stem) - 1)]
            lean = start + rng.normal(0, 0.05) + (rng.uniform(0.7, 1.0) if wings and k else 0)
            reach = long * (rng.uniform(0.6, 0.9) if wings and k else 1)
            way = reach * np.array([np.cos(lean), np.sin(lean)])
            lobe = loop @ np.array([way, [-way[1], way[0]]]) * [side, 1] + root
            self.parts.append((lobe.astype(np.float32), True))
            if rng.random() < 0.2:  # a vein
                self.details.append(np.stack([root, 0.2 * root + 0.8 * lobe[_ROUND // 2]]).astype(np.float32))
        body = rng.integers(3)
        if body == 0:
            self.bare.append(stem)
        elif body == 1:
            self.parts.append((self.tube(stem, (0.02, 0.03)), True))
        else:
            thick = rng.uniform(0.02, 0.08)
            middle = self.ellipse(0.5 + bend / 2, 0.5, thick, tall, squareness=1.0, wobble=0)
            self.parts.append((middle, True))
            for side in (-1, 1) if rng.random() < 0.5 else ():
                feeler = np.array([[0, 0], [0.03 * side, -0.05], [0.08 * side, -0.1]]) + stem[0]
                self.bare.append(_curve(feeler.astype(np.float32)))

    def _planks(self) -> None:
        """Add planks on the rails of a fence, or legs under a top, with or without bars between them."""
        rng = self.rng
        legs = rng.random() < 0.5
        count = rng.integers(2, 5) if legs else rng.integers(3, 9)
        half, high = rng.uniform(0.25, 0.42), rng.uniform(0.12, 0.3)
        wide = half / count * (rng.uniform(0.1, 0.4) if legs else rng.uniform(0.4, 0.85))
        plank = np.array([[-wide, high], [-wide, -high], [wide, -high], [wide, high]])
        if not legs and rng.random() < 0.5:
            plank = np.insert(plank, 2, [0, -high - wide], axis=0)  # a point
        bar = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        bar = bar * [half * rng.uniform(1, 1.15), rng.uniform(0.015, 0.06)]
        at = 0.5 + np.linspace(-1, 1, count) * (half - wide)
        planks = [(_dense((plank + np.array([x, 0.5])).astype(np.float32)), True) for x in at]
        heights = 0.5 + high * rng.uniform(-0.7, 0.8, rng.integers(0 if legs else 1, 3))
        bars = [(_dense((bar + np.array([0.5, y])).astype(np.float32)), True) for y in heights]
        self.parts += planks + bars if rng.random() < 0.3 else bars + planks
        if legs:
            flat = bar[:, 1].max() if rng.random() < 0.5 else rng.uniform(0.03, 0.1)
            round_ = rng.random() < 0.5
            top = self.ellipse(0.5, 0.5 - high, half * 1.1, flat, squareness=1.0 if round_ else 0.1, wobble=0)
            self.parts.append((top, True))
        self.merged = bool(rng.random() < 0.2)

    def _snow(self) -> None:
        rng = self.rng
        y, r = 0.75, rng.uniform(0.14, 0.22)
        for _ in range(rng.integers(2, 4)):
            self.parts.append((self.ellipse(0.5, y, r, r, squareness=1.0), True))
            y -= r * 1.6
            r *= rng.uniform(0.6, 0.9)
        self.face(0.5, y + r * 1.6, r)
        for side in (-1, 1):
            if rng.random() < 0.5:
                self.bare.append(np.array([[0.5 + side * 0.15, 0.5], [0.5 + side * 0.35, 0.4]], np.float32))


def _shape(
    name: str,
    parts: list[Part],
    details: list[Points],
    bare: list[Points],
    holes: list[Points],
    overlap: bool,
    merged: bool,
    bodies: list[Part],
) -> Shape:
    """Return a shape of closed parts, later ones in front of earlier ones, without the hidden lines."""
    side = 256
    strokes: list[Points] = []
    masks = []
    for part, _ in parts:
        mask = np.zeros((side, side), np.uint8)
        cv2.fillPoly(mask, [np.rint(part * side * 16).astype(np.int32)], 1, shift=4)
        masks.append(mask)
    hole = np.zeros((side, side), np.uint8)
    for each in holes:
        cv2.fillPoly(hole, [np.rint(each * side * 16).astype(np.int32)], 1, shift=4)
    union = np.zeros((side, side), np.uint8)
    above = np.zeros((side, side), np.uint8)
    for index in range(len(parts) - 1, -1, -1):
        line = _resampled(_closed(parts[index][0]), 160)
        if overlap:
            strokes.append(line)
        else:
            strokes += _visible(line, above, side)
        above |= masks[index]
    union = above.copy()
    for (_, pierced), mask in zip(parts, masks, strict=True):
        if not pierced:  # the part lies in front of the hole
            hole &= 1 - mask
    union &= 1 - hole
    for body, _ in bodies:
        cv2.fillPoly(union, [np.rint(body * side * 16).astype(np.int32)], 1, shift=4)
    if holes:
        found, _ = cv2.findContours(hole, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        strokes += [
            _closed(_contour((c[:, 0] + 0.5).astype(np.float32) / side)) for c in found if len(c) > 12
        ]
    doubled = cv2.resize(union, None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST)
    found, _ = cv2.findContours(doubled, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    contours = [_contour((c[:, 0].astype(np.float32) + 0.5) / (2 * side)) for c in found if len(c) > 8]
    if merged:
        strokes = [_closed(each) for each in contours]
    outlines = len(strokes)
    return Shape(name, [contours], [*strokes, *details], outlines, None, bare)


def _visible(line: Points, hidden: NDArray[np.uint8], side: int) -> list[Points]:
    at = np.clip((line * side).astype(int), 0, side - 1)
    seen = hidden[at[:, 1], at[:, 0]] == 0
    if seen.all():
        return [line]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], seen, [False]]).astype(int))).reshape(-1, 2)
    pieces = [line[a:b] for a, b in edges if b - a > 2]
    if len(pieces) > 1 and seen[0] and seen[-1]:
        pieces[0] = np.concatenate([pieces.pop(), pieces[0][1:]]) if len(pieces) > 1 else pieces[0]
    return pieces


def _closed(points: Points) -> Points:
    return np.concatenate([points, points[:1]]).astype(np.float32)


def _dense(polygon: Points) -> Points:
    """Return a polygon with points along its edges, of which every third is kept later."""
    return _resampled(_closed(polygon), 160)[:-1]


def _curve(path: Points) -> Points:
    """Return a quadratic curve through three points."""
    t = np.linspace(0, 1, 16)[:, None]
    a, b, c = path
    middle = 2 * b - (a + c) / 2
    return np.asarray((1 - t) ** 2 * a + 2 * t * (1 - t) * middle + t**2 * c, np.float32)


def _resampled(path: Points, count: int) -> Points:
    away = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    at = np.linspace(0, away[-1], count)
    return np.stack([np.interp(at, away, path[:, k]) for k in (0, 1)], 1).astype(np.float32)
