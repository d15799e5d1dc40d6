"""Training pages for the reader: objects drawn as people draw them, on the grounds that occur in practice.

A page is a picture with its true ink, its presence (0 in holes), the offset from each pixel of an object to
the object's centre, and a weight for each pixel.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from shapes import Points, Rng, Shape, darkness, doodle, sheet

Floats = NDArray[np.floating]
Bools = NDArray[np.bool_]
Box = tuple[float, float, float]
"""Centre and side of an object's square in pixels: x, y, span."""
Stroke = tuple[Points, bool]
"""A line, and whether it is an outline."""
Drawn = tuple[Points, bool, int]
"""A line, whether it is an outline, and the number of the hand's pass over it."""
Move = Callable[[Points], Points]
Contours = list[list[Points]]
KINDS = (
    "clean",
    "gaps",
    "sketchy",
    "coloured",
    "photo",
    "ruled",
    "flat",
    "scenery",
    "inverted",
    "several",
    "tiny",
    "child",
    "framed",
    "bordering",
    "strokes",
    "silhouette",
    "blank",
)
SHARES = (0.09, 0.1, 0.05, 0.08, 0.09, 0.05, 0.09, 0.02, 0.07, 0.06, 0.03, 0.09, 0.05, 0.06, 0.02, 0.04, 0.01)
FRAME, CARD = 0.07, 0.09
"""Distances from the edge, as shares of the longer side: up to the first, a line around a drawing is a frame;
from the second, it is the outline of a card."""
BLACK = 90
"""Highest channel, of 255, of a filled area that is ink; a lighter area is paint, and its edge is ink."""
SEEN = 40
"""Smallest difference of a channel, of 255, at which an edge between a colour and its ground is visible."""


@dataclass
class Page:
    """A page and its truth.

    Args:
        picture: (H, W, 3) uint8.
        ink: (H, W) in [0, 1].
        presence: (H, W) in [0, 1].
        middle: (2, H, W), offsets x and y from each pixel to its object's centre, as shares of the longer
            side.
        weight: (H, W), weight of the presence.
        ink_weight: (H, W), weight of the ink.
        kind: kind of difficulty.
    """

    picture: NDArray[np.uint8]
    ink: Floats
    presence: Floats
    middle: Floats
    weight: Floats
    ink_weight: Floats
    kind: str


def page(rng: Rng, shapes: list[Shape], size: tuple[int, int], kind: str | None = None) -> Page:
    """Return a page of (H, W) pixels."""
    kind = kind or str(rng.choice(KINDS, p=SHARES))
    return _Writer(rng, shapes, size, kind).write()


class _Writer:
    def __init__(self, rng: Rng, shapes: list[Shape], size: tuple[int, int], kind: str) -> None:
        self.rng, self.shapes, self.kind = rng, shapes, kind
        self.h, self.w = size
        self.long = max(size)
        self.page: Floats = np.full((self.h, self.w, 3), 255, np.float32)
        self.ink: Floats = np.zeros(size, np.float32)
        self.presence: Floats = np.zeros(size, np.float32)
        self.middle = np.zeros((2, *size), np.float32)
        self.weight: Floats = np.ones(size, np.float32)
        self.ink_weight = np.ones(size, np.float32)

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def write(self) -> Page:
        rng, kind = self.rng, self.kind
        self.coloured = {
            "clean": 0.12,
            "coloured": 1.0,
            "flat": 0.6,
            "scenery": 0.75,
            "photo": 0.15,
            "inverted": 0.4,
            "several": 0.3,
            "tiny": 0.2,
        }.get(kind, 0.08)
        self.damage = {
            "clean": 0.0,
            "gaps": 1.0,
            "sketchy": 0.6,
            "photo": 0.45,
            "ruled": 0.4,
            "coloured": 0.3,
            "inverted": 0.3,
            "several": 0.35,
            "tiny": 0.3,
            "child": 0.4,
            "strokes": 0.0,
            "bordering": 0.1,
        }.get(kind, 0.25)
        if self.chance(0.3) and kind != "gaps":
            self.damage = 0.0
        self.framed = False
        self._ground()
        boxes = [] if kind == "blank" else self._boxes()
        style = _Style(rng, self)
        if kind == "framed" or (kind in ("several", "coloured") and self.chance(0.1)):
            boxes = self._frame(boxes, style)
        for box in boxes:
            self._draw(box, style)
        if kind != "clean" and self.chance(0.16):
            self._text()
        self._degrade()
        picture: NDArray[Any] = np.clip(self.page, 0, 255)
        if kind != "clean" and self.chance(0.3):
            code = cv2.imencode(
                ".jpg", picture.astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(25, 90))]
            )[1]
            picture = np.asarray(cv2.imdecode(code, cv2.IMREAD_COLOR))
        return Page(
            np.rint(picture).astype(np.uint8),
            self.ink,
            self.presence,
            self.middle,
            self.weight,
            self.ink_weight,
            kind,
        )

    # --- where objects are
    def _boxes(self) -> list[Box]:
        """Return (cx, cy, span) of each object, in pixels."""
        rng, kind, h, w = self.rng, self.kind, self.h, self.w
        small: float = min(h, w)
        if kind == "tiny":
            count = 1 if self.chance(0.7) else 2
            return [
                (rng.uniform(0.2, 0.8) * w, rng.uniform(0.2, 0.8) * h, rng.uniform(0.12, 0.4) * small)
                for _ in range(count)
            ]
        if kind == "several":
            if self.chance(0.6):
                columns, rows = rng.integers(1, 6), rng.integers(1, 4)
                if columns * rows == 1:
                    columns = columns + 1
                cell = min(w / columns, h / rows)
                span: float = cell * rng.uniform(0.6, 0.95)
                jitter = (cell - span) / 2
                grid: list[Box] = [
                    (
                        (c + 0.5) * w / columns + rng.uniform(-1, 1) * jitter,
                        (r + 0.5) * h / rows + rng.uniform(-1, 1) * jitter,
                        span,
                    )
                    for r in range(rows)
                    for c in range(columns)
                    if rng.random() < 0.93
                ]
                return grid[:12] or [(w / 2, h / 2, small * 0.7)]
            boxes: list[Box] = []
            many = self.chance(0.35)  # a flock, a page of tracks
            for _ in range(rng.integers(10, 36) if many else rng.integers(2, 6)):
                for _ in range(12):
                    span = (rng.uniform(0.06, 0.2) if many else rng.uniform(0.2, 0.6)) * small
                    cx, cy = rng.uniform(span / 2, w - span / 2), rng.uniform(span / 2, h - span / 2)
                    if all(
                        abs(cx - x) > (span + s) * 0.52 or abs(cy - y) > (span + s) * 0.52
                        for x, y, s in boxes
                    ):
                        boxes.append((cx, cy, span))
                        break
            return boxes
        if kind == "bordering":
            margin = rng.uniform(1, 0.1 * self.long * rng.choice([1, 2]))
            card = w / 2, h / 2, self.long - 2 * margin
            if margin > CARD * self.long and self.chance(0.4):  # a card with a drawing on it
                return [card, (w / 2, h / 2, (small - 2 * margin) * rng.uniform(0.3, 0.8))]
            return [card]
        span = small * rng.uniform(0.55, 0.97)
        if h != w and self.chance(0.4):
            span = self.long * rng.uniform(0.6, 0.95)
        room = (np.array([w, h]) - span) / 2
        off = rng.uniform(-1, 1, 2) * np.maximum(room, 0)
        if self.chance(0.12) and kind not in ("clean", "framed"):  # cut at the border
            off = rng.uniform(-0.4, 0.4, 2) * np.array([w, h])
        return [(w / 2 + off[0], h / 2 + off[1], span)]

    # --- an object
    def _draw(self, box: Box, style: "_Style") -> None:  # noqa: PLR0912, PLR0915 - one choice after the other
        rng = self.rng
        cx, cy, span = box
        on_card = self.kind == "bordering" and bool(self.presence.any())
        if self.kind == "bordering" and not on_card:
            shape = sheet(
                rng,
                1 - (self.long - min(self.h, self.w)) / span * np.array([self.h > self.w, self.w > self.h]),
            )
        elif self.kind in ("child", "strokes") and (self.kind == "strokes" or self.chance(0.75)):
            shape = doodle(rng, self.kind)
        elif not self.shapes or self.chance(0.3):
            shape = doodle(rng)
        else:
            shape = self.shapes[rng.integers(len(self.shapes))]
        while self.framed and shape.name == "doodle/plain":  # here the line around it is the object
            shape = doodle(rng)
        if self.kind == "silhouette":
            self._silhouette(shape, box, style)
            return
        if shape.name == "doodle/plain" and self.chance(0.5):
            span *= rng.uniform(0.3, 1)
        if shape.paint is not None and self.chance(0.6) and self._paste(shape, box, style):
            return
        move = self._placement(shape, cx, cy, span)
        contours = [_moved(move, group) for group in shape.contours]
        mask = self._filled(contours)
        if mask.max(initial=0) < 0.5 and not shape.bare:
            return
        span = max(span, 8)
        strokes = [(s, k < shape.outlines) for k, s in enumerate(_moved(move, shape.strokes))]
        if not shape.bare and self.chance(0.1 if self.kind == "clean" else 0.2):
            mask, strokes = self._ended(mask, strokes)
        if self.chance(0.35):
            strokes += [(spot, False) for spot in self._spots(mask, span)]
        if style.double and span > 60:
            strokes += [(line, True) for line in self._within(mask, style.double * style.width(span))]
        bare = _moved(move, shape.bare)
        if shape.normal is not None and not bare and self.chance(0.06):
            bare = self._whiskers(contours, span)
        painted = None
        solid = bool(mask.max(initial=0) > 0.5)
        if solid and self.rng.random() < self.coloured:
            painted = self._painted(shape, mask, move, strokes, style)
        outline_drawn = painted is None or self.chance(0.5) or self._unseen(mask, painted)
        body = painted is not None or (self.see_through < 1 and style.covered)
        merged = solid and body and outline_drawn and self._merged(mask, style)
        if merged:  # the visible part of such an outline is the end of the body
            strokes = [(line, outer) for line, outer in strokes if not outer]
        lines = self._hand(strokes, span, style)
        loose = self._hand([(s, True) for s in bare], span, style)
        width = style.width(span)
        if shape.name == "doodle/plain" and self.chance(0.25):  # a broad-pen disc, not a ring
            width = span * rng.uniform(0.02, 0.09)
        ink = self._strokes(lines, width, style) if outline_drawn else np.zeros_like(mask)
        whisker = self._strokes(loose, width, style) if loose else np.zeros_like(mask)
        drawn = np.maximum(ink, whisker)
        pale = self._strokes([*lines, *loose], 0.5 * width, style) * style.pale if style.pale else 0.0
        # paint lies below the lines
        if painted is not None:
            self.page = self.page * (1 - mask[..., None]) + painted * mask[..., None]
        elif self.see_through < 1 and style.covered:
            paper = np.float32(style.cover)
            cover = mask * (1 - self.see_through)
            self.page = self.page * (1 - cover[..., None]) + paper * cover[..., None]
        black = None
        if solid and painted is None and style.blacks and self.chance(0.5):
            black = self._blacks(mask, drawn, style)
        if solid and style.hatched and painted is None:
            hatching = self._hatching(shape, mask, move, style)
            drawn = np.maximum(drawn, hatching)
            self.ink_weight[hatching > 0.2] = 0.3
        if solid and black is None and self.chance(0.05):
            drawn = np.maximum(drawn, self._letters(mask))
        colour = np.float32(style.pen)
        if black is not None:
            dark = np.maximum(black * (1 - ink), 0) if style.white_details else np.maximum(black, drawn)
            edge = np.maximum(dark, whisker)
            edge = np.maximum(edge, drawn * (1 - black)) if style.white_details else edge
            self.page = self.page * (1 - edge[..., None]) + colour * edge[..., None]
            if style.white_details:
                inner = drawn * black
                self.page = (
                    self.page * (1 - inner[..., None]) + np.float32(style.paper_like) * inner[..., None]
                )
            target = edge
            if style.pen.max() > BLACK:
                target = np.maximum(drawn, self._rim(black, None, None))
        else:
            shade = (drawn * (1 - pale))[..., None] * style.darkness
            self.page = self.page * (1 - shade) + colour * shade
            target = drawn
        if not outline_drawn or merged or (painted is not None and style.outline_target):
            target = np.maximum(target, self._rim(mask, painted, ink if outline_drawn else None))
        if painted is not None and style.pen.max() <= BLACK:
            target = np.maximum(target, mask * (painted.max(-1) <= BLACK))
        if body or self.kind in {"inverted", "flat"}:
            self.ink_weight[target > 0.5] = 1.3
        present = np.maximum(mask, np.where(whisker > 0.3, whisker, 0))
        # overlapping objects: the later one covers the earlier one's middle
        self.ink = np.maximum(self.ink * (1 - mask), target)
        if not on_card:
            self._place_middle(present > 0.5)
        self.presence = np.maximum(self.presence, present)
        self._weigh(contours, mask, whisker > 0.3, drawn)
        if solid and style.construction and painted is None:
            self._construction(contours, span, style)

    def _silhouette(self, shape: Shape, box: Box, style: "_Style") -> None:
        """Draw an object in one flat colour without an outline, or as lines with one half black."""
        rng = self.rng
        move = self._placement(shape, *box)
        contours = [_moved(move, group) for group in shape.contours]
        mask = self._filled(contours)
        if (mask > 0.5).sum() < 20:
            return
        dark = self.chance(0.8)
        colour = (
            np.full(3, rng.uniform(0, 30)) if self.chance(0.5) else rng.uniform(0, BLACK if dark else 255, 3)
        )
        width = style.width(max(box[2], 8))
        whole = [(line, True, 0) for line in _moved(move, shape.strokes)]
        eyes = [(eye, True, 0) for eye in (self._spots(mask, box[2]) if self.chance(0.25) else [])]
        if dark and self.chance(0.25):
            lines = self._strokes([*whole, *eyes], width, style)
            area = np.maximum(mask * self._half(mask), lines)
        else:
            if self.chance(0.4):
                mask = mask * (1 - self._opening(mask))
            inner = whole[shape.outlines :] if self.chance(0.3) else []
            area = mask * (1 - self._strokes([*inner, *eyes], 0.6 * width, style))
        if self._unseen(mask, np.broadcast_to(np.float32(colour), self.page.shape)):
            return
        self.page = self.page * (1 - area[..., None]) + np.float32(colour) * area[..., None]
        self.ink = np.maximum(
            self.ink * (1 - mask), area if colour.max() <= BLACK else self._rim(mask, None, None)
        )
        self._place_middle(mask > 0.5)
        self.presence = np.maximum(self.presence, mask)
        self._weigh(contours, mask, np.zeros(mask.shape, bool), area)

    def _half(self, mask: Floats) -> Floats:
        """Return one side of a wavy line through an object, (H, W)."""
        rng = self.rng
        way = rng.normal(0, 1, 2)
        away = np.add.outer(np.arange(self.h) * way[1], np.arange(self.w) * way[0])
        away = away + _clouds(rng, self.h, self.w, self.long / 4) * rng.uniform(0, 0.1) * self.long
        last = np.quantile(away[mask > 0.5], rng.uniform(0.25, 0.75))
        return np.asarray(away > last, np.float32)

    def _opening(self, mask: Floats) -> Floats:
        """Return round or angular openings through an object, (H, W), too large for eyes."""
        rng = self.rng
        canvas = np.zeros((self.h, self.w), np.uint8)
        solid = np.pad((mask > 0.5).astype(np.uint8), 1)
        for _ in range(rng.integers(1, 4)):
            depth = cv2.distanceTransform(solid, cv2.DIST_L2, 5)[1:-1, 1:-1]
            deepest = float(depth.max())
            if deepest < 6:
                break
            places = np.argwhere(depth > 0.8 * deepest)
            y, x = places[rng.integers(len(places))]
            n = int(rng.choice([3, 4, 4, 6, 40, 40]))
            t = np.arange(n) * 2 * np.pi / n + (np.pi / 4 if n == 4 else rng.uniform(0, 6.28))
            outline = np.array([x, y]) + deepest * rng.uniform(0.35, 0.8) * np.stack(
                [np.cos(t), np.sin(t)], 1
            )
            cv2.fillPoly(canvas, [np.rint(outline * 16).astype(np.int32)], 255, cv2.LINE_AA, 4)
            solid[1:-1, 1:-1][canvas > 0] = 0
        return canvas.astype(np.float32) / 255

    def _letters(self, mask: Floats) -> Floats:
        """Return words on an object, (H, W): on a sign, a shirt, a box."""
        rng = self.rng
        canvas = np.zeros((self.h, self.w), np.uint8)
        inside = (mask > 0.9).astype(np.uint8)
        for _ in range(rng.integers(1, 3)):
            depth = cv2.distanceTransform(np.pad(inside, 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
            y, x = np.unravel_index(int(depth.argmax()), depth.shape)
            word = "".join(rng.choice(list("ABCDEGHKMNORSTUXabdeghkmnoprst0123456789"), rng.integers(1, 7)))
            font = int(rng.choice([0, 2, 3, 4]))
            (wide, high), _ = cv2.getTextSize(word, font, 1, 1)
            scale = rng.uniform(0.8, 1.7) * float(depth[y, x]) / np.hypot(wide / 2, high / 2)
            if scale * high < 5:
                break
            thick = max(round(scale * rng.choice([1, 2, 5])), 1)
            fresh = np.zeros_like(canvas)
            start = (round(float(x) - scale * wide / 2), round(float(y) + scale * high / 2))
            cv2.putText(fresh, word, start, font, scale, 255, thick, cv2.LINE_AA)
            canvas = np.maximum(canvas, fresh)
            inside[cv2.dilate(fresh, np.ones((5, 5), np.uint8)) > 0] = 0
        return np.where(mask > 0.9, canvas, 0).astype(np.float32) / 255

    def _ended(self, mask: Floats, strokes: list[Stroke]) -> tuple[Floats, list[Stroke]]:
        """Remove a part without a line at the cut, as for a bust or a hand without its arm."""
        rng = self.rng
        way = np.array([rng.normal(0, 0.4), 1.0]) if self.chance(0.7) else rng.normal(0, 1, 2)
        away = np.add.outer(np.arange(self.h) * way[1], np.arange(self.w) * way[0])
        last = np.quantile(away[mask > 0.5], rng.uniform(0.45, 0.92))
        kept = [(line[a:b], o) for line, o in strokes for a, b in _runs(line @ way <= last) if b - a > 1]
        return mask * (away <= last).astype(np.float32), kept

    def _place_middle(self, inside: Bools) -> None:
        ys, xs = np.nonzero(inside)
        if len(xs):
            mx, my = (xs.min() + xs.max()) / 2, (ys.min() + ys.max()) / 2
            self.middle[0][inside] = (mx - xs) / self.long
            self.middle[1][inside] = (my - ys) / self.long

    def _paste(self, shape: Shape, box: Box, style: "_Style") -> bool:
        """Draw clip art in its colours or as its dark lines alone, and return whether it is visible."""
        rng = self.rng
        contours, lines, colour, mask = self._warped(shape, box)
        if (mask > 0.5).sum() < 20:
            return False
        if lines:
            dark = mask * darkness(colour)
            dark *= self._kept(contours, box[2], style)
            if style.covered or self.see_through == 0:
                cover = mask * (1 - self.see_through)
                self.page = self.page * (1 - cover[..., None]) + np.float32(style.cover) * cover[..., None]
            shade = dark[..., None] * style.darkness
            self.page = self.page * (1 - shade) + np.float32(style.pen) * shade
            target = dark
        else:
            if self.chance(0.2):
                colour = np.repeat(colour.mean(2, keepdims=True), 3, 2)
            if self.chance(0.2):
                colour = 255 * (colour / 255) ** np.exp(rng.normal(0, 0.4))
            if self._unseen(mask, colour):
                return False
            self.page = self.page * (1 - mask[..., None]) + colour * mask[..., None]
            dark = mask * darkness(colour) if shape.lined else 0.0 * mask
            area = cv2.morphologyEx(dark, cv2.MORPH_OPEN, np.ones((9, 9), np.uint8))
            # A shade is not ink.
            dark = np.where(area > 0.1, area > darkness(np.full((1, 1, 3), BLACK)), dark)
            target = np.maximum(dark, self._rim(mask, colour.astype(np.float32), None) * (dark < 0.3))
        self.ink = np.maximum(self.ink * (1 - mask), target)
        count, labels, stats, _ = cv2.connectedComponentsWithStats((mask > 0.5).astype(np.uint8))
        self._place_middle(mask > 0.5)
        large = stats[:, cv2.CC_STAT_AREA] > 0.25 * stats[1:, cv2.CC_STAT_AREA].max(initial=0)
        for k in range(1, count):  # several parts in one file are several objects
            if large[k]:
                self._place_middle(labels == k)
        self.presence = np.maximum(self.presence, mask)
        self._weigh(contours, mask, np.zeros(mask.shape, bool), target)
        return True

    def _warped(self, shape: Shape, box: Box) -> tuple[Contours, bool, Floats, Floats]:
        """Return the contours of clip art, whether only its lines are drawn, its colours and opacity."""
        cx, cy, span = box
        span = max(span, 16)
        move = self._placement(shape, cx, cy, span, bent=False)
        contours = [_moved(move, group) for group in shape.contours]
        drawn = shape.drawn()
        side = len(drawn)
        corners = move(np.array([[0, 0], [1, 0], [0, 1]], np.float32))
        share = float(np.sqrt(abs(np.linalg.det(corners[1:] - corners[0])))) / side
        lines = shape.lined and self.chance(0.75)
        if lines and share < 1 and self.chance(0.5):  # thin lines would nearly vanish
            drawn[..., :3] = cv2.erode(drawn[..., :3], np.ones((3, 3), np.uint8))
        opacity: NDArray[Any]
        paint: NDArray[Any]
        if share < 0.7:
            small = max(round(side * share), 8)
            opacity = drawn[..., 3:].astype(np.float32) / 255
            paint = cv2.resize(drawn[..., :3] * opacity, (small, small), interpolation=cv2.INTER_AREA)
            opacity = cv2.resize(opacity, (small, small), interpolation=cv2.INTER_AREA)
        else:
            small, opacity = side, drawn[..., 3].astype(np.float32) / 255
            paint = drawn[..., :3] * opacity[..., None]
        ends = np.array([[0, 0], [small, 0], [0, small]], np.float32) - 0.5
        warp = cv2.getAffineTransform(ends, corners - 0.5)
        paint = cv2.warpAffine(paint, warp, (self.w, self.h), flags=cv2.INTER_LINEAR)
        mask: NDArray[Any] = cv2.warpAffine(opacity, warp, (self.w, self.h), flags=cv2.INTER_LINEAR)
        colour = np.clip(paint / np.maximum(mask[..., None], 1e-3), 0, 255).astype(np.float32)
        return contours, lines, colour, mask

    def _unseen(self, mask: Floats, colour: Floats) -> bool:
        """Return whether a third of the painted area's edge looks like its ground."""
        solid = (mask > 0.5).astype(np.uint8)
        rim = solid > cv2.erode(solid, np.ones((3, 3), np.uint8), borderValue=1)
        return bool((np.abs(colour - self.page)[rim].max(-1) < SEEN).mean() > 1 / 3) if rim.any() else True

    def _merged(self, mask: Floats, style: "_Style") -> bool:
        """Return whether an outline looks like the ground that it lies on."""
        solid = (mask > 0.3).astype(np.uint8)
        beside = cv2.dilate(solid, np.ones((5, 5), np.uint8)) > solid
        return bool(beside.any() and np.abs(self.page[beside].mean(0) - style.pen).max() < SEEN)

    def _kept(self, contours: Contours, span: float, style: "_Style") -> Floats:
        """Return 0 where lines of an outline are left out, and a pencil's uneven tone elsewhere."""
        rng = self.rng
        kept = np.ones((self.h, self.w), np.float32)
        if style.pressure:
            kept -= 0.6 * style.pressure * np.clip(_clouds(rng, self.h, self.w, span / 5), 0, 1)
        if self.damage:
            width = rng.uniform(0.02, 0.12) * span
            for contour in (each for group in contours for each in group):
                for _ in range(rng.poisson(self.damage * len(contour) / 200)):
                    at = np.rint(contour[rng.integers(len(contour))]).astype(int)
                    cv2.circle(kept, at.tolist(), max(round(width * rng.uniform(0.1, 0.5)), 1), 0.0, -1)
        return kept

    def _placement(self, shape: Shape, cx: float, cy: float, span: float, bent: bool = True) -> Move:
        rng = self.rng
        points = np.concatenate([c for group in shape.contours for c in group] + shape.bare)
        low, high = points.min(0), points.max(0)
        turn = rng.normal(0, 0.12) if self.chance(0.8) else rng.uniform(-3.14, 3.14)
        if self.kind == "clean" and self.chance(0.5):
            turn = 0.0
        flip = -1 if self.chance(0.5) else 1
        stretch = np.exp(rng.normal(0, 0.12))
        if self.kind == "bordering":
            turn, stretch, bent = 0.0, 1.0, bent and self.chance(0.3)
        a, b = np.cos(turn), np.sin(turn)
        matrix = np.array([[a, -b], [b, a]]) @ np.diag([flip * stretch, 1 / stretch])
        waves = [
            (
                rng.uniform(1, 3.2) * 2 * np.pi * rng.choice([-1, 1]),
                rng.uniform(0, 6.28),
                rng.uniform(0, 6.28),
            )
            for _ in range(3)
        ]
        bend = rng.choice([0, 0.004, 0.012, 0.02]) if self.kind != "clean" else rng.choice([0, 0, 0.006])
        bend *= bent

        def turned(p: Points) -> Points:
            p = p - (low + high) / 2
            q = p.copy()
            for f, one, two in waves:
                q[:, 0] += bend * np.sin(f * p[:, 1] + one)
                q[:, 1] += bend * np.sin(f * p[:, 0] + two)
            return np.asarray(q @ matrix.T)

        corners = turned(points)
        lo, hi = corners.min(0), corners.max(0)
        scale = span / max((hi - lo).max(), 1e-3)
        centre = (lo + hi) / 2
        return lambda p: ((turned(p) - centre) * scale + np.array([cx, cy])).astype(np.float32)

    def _filled(self, groups: Contours) -> Floats:
        """Return the even-odd filling, antialiased with 4 × 4 samples."""
        k = 3
        mask = np.zeros((self.h * k, self.w * k), np.uint8)
        for group in groups:
            fresh = np.zeros_like(mask)
            cv2.fillPoly(fresh, [np.rint((c * k - 0.5) * 16).astype(np.int32) for c in group], 255, shift=4)
            mask |= fresh
        return cv2.resize(mask, (self.w, self.h), interpolation=cv2.INTER_AREA).astype(np.float32) / 255

    def _whiskers(self, contours: Contours, span: float) -> list[Points]:
        rng, found = self.rng, []
        outline = max((c for group in contours for c in group), key=len)
        middle = outline.mean(0)
        for _ in range(rng.integers(1, 6)):
            start = outline[rng.integers(len(outline))]
            way = (start - middle) / max(np.linalg.norm(start - middle), 1e-3)
            way = way + rng.normal(0, 0.5, 2)
            length = span * rng.uniform(0.05, 0.25)
            t = np.linspace(0, 1, 10)[:, None]
            found.append(
                (start + way * length * t + rng.normal(0, 0.1, 2) * length * t**2).astype(np.float32)
            )
        return found

    def _within(self, mask: Floats, away: float) -> list[Points]:
        """Return a second outline inside the first."""
        depth = cv2.distanceTransform(np.pad((mask > 0.5).astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
        inner = (depth > away).astype(np.uint8)
        found, _ = cv2.findContours(inner, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
        return [np.concatenate([c[:, 0], c[:1, 0]]).astype(np.float32) + 0.5 for c in found if len(c) > 20]

    def _frame(self, boxes: list[Box], style: "_Style") -> list[Box]:
        """Draw a frame around all objects, and return their boxes inside it."""
        rng, h, w = self.rng, self.h, self.w
        self.framed = True
        edge = rng.uniform(0.01, FRAME) * self.long
        canvas = np.zeros((h, w), np.uint8)
        thick = int(rng.choice([1, 1, 2, 3, 5, 8]))
        for k in range(int(rng.choice([1, 1, 2]))):
            away = edge - k * rng.uniform(0.01, 0.03) * self.long
            if away < 1:
                break
            corners = np.array([[away, away], [w - away, away], [w - away, h - away], [away, h - away]])
            path: Floats = _even(
                (closed := np.concatenate([corners, corners[:1]])),
                np.linalg.norm(np.diff(closed, axis=0), axis=1), 120,
            )  # fmt: skip
            if self.chance(0.4):
                path = path + _noise(rng, 120, 3) * rng.uniform(0.2, 3)
            if self.chance(0.05):  # an oval
                t = np.linspace(0, 2 * np.pi, 120)
                path = np.stack([w / 2 + (w / 2 - away) * np.cos(t), h / 2 + (h / 2 - away) * np.sin(t)], 1)
            cv2.polylines(canvas, [np.rint(path * 16).astype(np.int32)], False, 255, thick, cv2.LINE_AA, 4)
        if self.chance(0.12):  # panels, as of a comic or a sheet of cards
            x = round(rng.uniform(0.3, 0.7) * w)
            cv2.line(canvas, (x, int(edge)), (x, int(h - edge)), 255, thick, cv2.LINE_AA)
        dark = canvas[..., None].astype(np.float32) / 255
        self.page = self.page * (1 - dark) + np.float32(style.pen) * dark
        self.ink_weight[canvas > 0] = 0.5
        room = 1 - 2.3 * (edge + thick) / min(h, w)
        return [
            (w / 2 + (x - w / 2) * room, h / 2 + (y - h / 2) * room, max(s * room * 0.93, 8))
            for x, y, s in boxes
        ]

    def _spots(self, mask: Floats, span: float) -> list[Points]:
        """Return small closed lines inside an object: eyes, buttons, spots, windows."""
        rng, found = self.rng, []
        depth = cv2.distanceTransform(np.pad((mask > 0.5).astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
        size = span * np.exp(rng.uniform(np.log(0.008), np.log(0.1)))
        for _ in range(rng.integers(1, 9)):
            radius = max(size * np.exp(rng.normal(0, 0.3)), 1.5)
            rows, columns = np.nonzero(depth > 1.3 * radius + 1)
            if not len(rows):
                continue
            pick = rng.integers(len(rows))
            centres = [np.array([columns[pick], rows[pick]], np.float32)]
            if self.chance(0.35):  # a pair of eyes
                beside = centres[0] + np.array([rng.uniform(2.3, 5) * radius, 0])
                x, y = np.rint(beside).astype(int)
                if x < self.w and depth[y, x] > 1.3 * radius:
                    centres.append(beside)
            corners = int(rng.choice([40, 40, 40, 4, 3, 6]))
            t = np.linspace(0, 2 * np.pi, corners + 1) + rng.uniform(0, 6.28)
            r = radius * (1 + (0.3 * (np.arange(corners + 1) % 2) if corners == 6 else 0.0))
            outline = np.stack([r * np.cos(t), r * rng.uniform(0.6, 1.2) * np.sin(t)], 1)
            outline[-1] = outline[0]
            pupil = rng.uniform(0.25, 0.7) if self.chance(0.35) else 0
            for centre in centres:
                found.append((centre + outline).astype(np.float32))
                if pupil:
                    found.append((centre + pupil * outline).astype(np.float32))
        return found

    # --- lines
    def _hand(  # noqa: PLR0912 - one choice after the other
        self, strokes: list[Stroke], span: float, style: "_Style"
    ) -> list[Drawn]:
        """Return lines as the hand draws them."""
        rng, drawn = self.rng, []
        damage = self.damage
        wobble = style.wobble * span
        least = rng.uniform(0.0, 0.12) if damage else 0.0
        # the widest gap of this drawing
        allowed = (
            (rng.uniform(0.1, 0.22) if self.chance(0.3) else rng.uniform(0.02, 0.12)) * span * (damage > 0)
        )
        open_end = damage and self.chance(0.4 * damage)
        if open_end:
            way = rng.normal(0, 1, 2) if self.chance(0.4) else np.array([0.0, 1.0])
            ends = [(p @ way).max() for p, o in strokes if o]
            last = max(ends) if ends else 0
        for points, outline in strokes:
            steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
            length = float(steps.sum())
            if length < 1.0:
                continue
            if not outline and self.chance(style.missed):
                continue
            if damage and length < least * span * 0.6 and self.chance(0.6 * damage):
                continue
            count = max(int(length / 1.5), 3)
            path = _even(points, steps, count)
            passes = 1 + (int(rng.integers(1, 4)) if self.chance(style.sketchy) else 0)
            for each in range(passes):
                line = path
                if wobble:
                    line = path + _noise(rng, len(path), length / max(span, 1)) * wobble * (
                        1.6 if each else 1
                    )
                keep = np.ones(len(line), bool)
                if damage:
                    for _ in range(
                        rng.poisson(
                            damage * 1.1 * (length / span) + (0.3 * damage if length > 0.1 * span else 0)
                        )
                    ):
                        gap = rng.uniform(0.005, 1) ** 1.7 * allowed * 1.0
                        gap = min(gap, 0.6 * length)
                        at, half = rng.integers(len(line)), max(int(gap / 1.5 / 2), 1)
                        keep[max(at - half, 0) : at + half] = False
                        if at - half < 0 and np.array_equal(points[0], points[-1]):
                            keep[at - half :] = False
                if open_end and outline:
                    cut = (line @ way) > last - allowed * 0.5
                    keep &= ~cut
                for a, b in _runs(keep):
                    if b - a < 2:
                        continue
                    piece = line[a:b]
                    if damage and style.overshoot and self.chance(0.5):
                        piece = _longer(piece, rng.exponential(style.overshoot) * span)
                    if each and self.chance(0.5):
                        first = rng.integers(0, max(len(piece) // 2, 1))
                        piece = piece[first : first + max(len(piece) // 2, 3)]
                    drawn.append((piece, outline, each))
        return drawn

    def _strokes(self, lines: list[Drawn], width: float, style: "_Style") -> Floats:
        rng, k = self.rng, 2 if self.long <= 400 else 1
        canvas = np.zeros((self.h * k, self.w * k), np.uint8)
        light = np.zeros_like(canvas) if style.pressure or style.sketchy else None
        for points, outline, each in lines:
            wide = width * (1 if outline else style.inner) * k
            line = np.rint((points * k - 0.5) * 16).astype(np.int32)
            target = canvas if light is None or (each == 0 and not style.pressure) else light
            if style.taper or style.pressure:
                n = max(len(line) // 6, 1)
                cuts = np.linspace(0, len(line) - 1, n + 1).astype(int)
                s = (cuts[:-1] + cuts[1:]) / 2 / len(line)
                profile = 1 - style.taper * np.abs(2 * s - 1) ** 2
                profile = profile * np.exp(style.pressure * rng.normal(0, 0.25, n))
                for a, b, share in zip(cuts[:-1], cuts[1:], profile, strict=True):
                    level = (
                        255
                        if not style.pressure
                        else int(np.clip(255 * (0.45 + 0.55 * share * rng.uniform(0.7, 1.1)), 90, 255))
                    )
                    cv2.polylines(
                        canvas, [line[a : b + 1]], False, level, max(round(wide * share), 1), cv2.LINE_AA, 4
                    )
            else:
                cv2.polylines(
                    target,
                    [line],
                    False,
                    255 if target is canvas else int(rng.integers(90, 230)),
                    max(round(wide), 1),
                    cv2.LINE_AA,
                    4,
                )
        if light is not None:
            canvas = np.maximum(canvas, light)
        ink = cv2.resize(canvas, (self.w, self.h), interpolation=cv2.INTER_AREA).astype(np.float32) / 255
        if k == 2 and width < 1:
            ink = ink * max(width / 0.8, 0.4) if width < 0.8 else ink
        return ink

    def _hatching(self, shape: Shape, mask: Floats, move: Move, style: "_Style") -> Floats:
        rng = self.rng
        canvas = np.zeros((self.h, self.w), np.uint8)
        angle, step = rng.uniform(0, 3.14), rng.uniform(3, 8)
        way, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        middle = np.array([self.w, self.h]) / 2
        for k in np.arange(-self.long, self.long, step):
            a, b = middle + across * k - way * self.long, middle + across * k + way * self.long
            start, end = (np.rint(p * 16).astype(int).tolist() for p in (a, b))
            cv2.line(canvas, start, end, 200, 1, cv2.LINE_AA, 4)
        ys, xs = np.nonzero(mask > 0.5)
        pick = rng.integers(len(xs))
        y, x = np.mgrid[: self.h, : self.w]
        r = rng.uniform(0.1, 0.4) * max(int(np.ptp(xs)), int(np.ptp(ys)), 4)
        region = (np.hypot(x - xs[pick], y - ys[pick]) < r) & (mask > 0.5)
        return np.where(region, canvas, 0).astype(np.float32) / 255

    def _blacks(self, mask: Floats, drawn: Floats, style: "_Style") -> Floats:
        """Return areas filled with black: the object as a whole, or some of its regions."""
        rng = self.rng
        if self.chance(0.35):
            return mask
        free = ((drawn < 0.3) & (mask > 0.6)).astype(np.uint8)
        count, labels, stats, _ = cv2.connectedComponentsWithStats(free, connectivity=4)
        chosen = np.zeros(count, bool)
        for k in range(1, count):
            chosen[k] = stats[k, cv2.CC_STAT_AREA] > 4 and rng.random() < style.black_share
        if count == 2 and self.chance(0.7):
            chosen[:] = False
        chosen[0] = False
        dark = chosen[labels].astype(np.uint8)
        return np.minimum(cv2.dilate(dark, np.ones((3, 3), np.uint8)).astype(np.float32), mask)

    def _painted(
        self, shape: Shape, mask: Floats, move: Move, strokes: list[Stroke], style: "_Style"
    ) -> Floats:
        """Return colours of the object, (H, W, 3), by region or shaded."""
        rng = self.rng
        lines = np.zeros((self.h, self.w), np.uint8)
        for points, _ in strokes:
            cv2.polylines(lines, [np.rint((points - 0.5) * 16).astype(np.int32)], False, 1, 1, cv2.LINE_4, 4)
        free = ((lines == 0) & (mask > 0.3)).astype(np.uint8)
        count, labels = cv2.connectedComponents(free, connectivity=4)
        grown = cv2.dilate(labels.astype(np.float32), np.ones((3, 3), np.uint8))
        labels = np.where(labels > 0, labels, grown).astype(int)
        palette = style.colours(count)
        if self.chance(0.25):
            palette[:] = palette[0]
        if self.chance(0.25):  # some are left as white as paper
            palette[rng.random(count) < 0.4] = style.paper_like
        # a white figure with eyes as dark as its ground
        if self.kind in {"inverted", "flat"} and self.chance(0.35):
            palette[:] = rng.uniform(215, 255)
            small = np.bincount(labels.ravel(), minlength=count) < 0.02 * np.count_nonzero(mask > 0.5)
            palette[small & (rng.random(count) < 0.6)] = np.clip(self.page.mean((0, 1)), 0, BLACK)
        colour = palette[labels]
        if shape.normal is not None and self.chance(0.5):
            box = _box(mask)
            # The shading need not match the bent shape, but must vary like that of a shaded surface.
            light = rng.normal(0, 1, 3) + np.array([0, 0, 1.2])
            shade = np.clip(shape.normal @ (light / np.linalg.norm(light)), 0, 1)
            rows, columns = np.nonzero(np.abs(shape.normal).sum(-1) > 0.1)
            if len(rows):
                cut = shade[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1].astype(np.float32)
                big = cv2.resize(cut, (box[3] - box[2], box[1] - box[0]))
                field: Floats = np.ones((self.h, self.w), np.float32)
                field[box[0] : box[1], box[2] : box[3]] = big
                if self.chance(0.5):
                    field = np.round(field * 2) / 2
                colour = colour * (0.55 + 0.45 * field[..., None])
        if self.chance(0.2):
            colour = colour + _clouds(rng, self.h, self.w, rng.uniform(4, 30))[..., None] * rng.uniform(5, 25)
        return np.asarray(np.clip(colour, 0, 255), np.float32)

    def _rim(self, mask: Floats, painted: Floats | None, ink: Floats | None) -> Floats:
        """Return the missing lines of painted areas: around them, and between their colours."""
        solid = (mask > 0.5).astype(np.uint8)
        inner = cv2.erode(solid, np.ones((3, 3), np.uint8), borderValue=0)
        rim = (solid - inner).astype(np.float32)
        if painted is not None and ink is None:
            low, high = (
                cv2.erode(painted, np.ones((3, 3), np.uint8)),
                cv2.dilate(painted, np.ones((3, 3), np.uint8)),
            )
            rim = np.maximum(rim, ((high - low).max(-1) > 70) & (solid > 0))
        if ink is not None:
            near = cv2.dilate(ink, np.ones((5, 5), np.uint8))
            rim = rim * (near < 0.3)
        return rim.astype(np.float32)

    def _construction(self, contours: Contours, span: float, style: "_Style") -> None:
        rng = self.rng
        points = np.concatenate([c for group in contours for c in group])
        low, high = points.min(0), points.max(0)
        canvas = np.zeros((self.h, self.w), np.uint8)
        for _ in range(rng.integers(1, 5)):
            c = rng.uniform(low, high)
            if self.chance(0.5):
                r = rng.uniform(0.1, 0.4, 2) * span
                cv2.ellipse(
                    canvas,
                    tuple(map(int, c)),
                    tuple(map(int, r + 1)),
                    rng.uniform(0, 180),
                    0,
                    360,
                    255,
                    1,
                    cv2.LINE_AA,
                )
            else:
                d = rng.normal(0, 1, 2)
                d = d / np.linalg.norm(d) * span * rng.uniform(0.3, 0.8)
                cv2.line(canvas, tuple(map(int, c - d)), tuple(map(int, c + d)), 255, 1, cv2.LINE_AA)
        faint = canvas.astype(np.float32)[..., None] / 255 * rng.uniform(0.15, 0.5) * style.darkness
        self.page = self.page * (1 - faint) + np.float32(style.pen) * faint
        self.ink_weight[canvas > 40] *= 0.3

    def _weigh(self, contours: Contours, mask: Floats, thin: Bools, drawn: Floats) -> None:
        """Raise the weight of parts that a mean over the page would lose: holes, eyes, rims, bare lines."""
        solid = (mask > 0.5).astype(np.uint8)
        near = cv2.dilate(solid, np.ones((int(0.06 * self.long) | 1,) * 2, np.uint8))
        self.weight[(near > 0) & (solid == 0)] = 2.0
        filled = np.zeros_like(solid)
        for group in contours:
            for c in group:
                cv2.fillPoly(filled, [np.rint(c - 0.5).astype(np.int32)], 1)
        reached = np.pad(thin | (solid > 0), 1).astype(np.uint8)
        cv2.floodFill(reached, None, (0, 0), 2)
        hole = ((filled > 0) | (reached[1:-1, 1:-1] == 0)) & (mask < 0.3) & ~thin
        area = hole.sum()
        if area:
            self.weight[hole] = np.clip(0.04 * self.h * self.w / area, 2, 8)
        # Eyes, buttons and other small closed shapes inside an object are not holes.
        free = ((drawn < 0.3) & (mask > 0.6)).astype(np.uint8)
        _, labels, stats, _ = cv2.connectedComponentsWithStats(free, connectivity=4)
        weights = np.clip(0.02 * solid.sum() / np.maximum(stats[:, cv2.CC_STAT_AREA], 1), 1, 4)
        weights[0] = 0
        self.weight = np.maximum(self.weight, weights.astype(np.float32)[labels])
        self.weight[thin] = 3.0

    # --- the ground
    def _ground(self) -> None:
        rng, kind, h, w = self.rng, self.kind, self.h, self.w
        self.see_through = 1.0
        self.ground_dark = False
        if kind == "blank":
            self.kind = kind = str(rng.choice(["clean", "photo", "ruled", "flat", "sketchy"]))
        if kind == "clean":
            self.page[:] = 255 if self.chance(0.9) else rng.uniform(235, 255, 3)
            return
        if kind in ("flat", "inverted"):
            choices = [
                (255, 0, 255),
                (0, 0, 0),
                (128, 128, 128),
                (0, 200, 0),
                (90, 40, 20),
                (255, 128, 0),
                (60, 60, 60),
                (200, 180, 160),
                (0, 255, 255),
            ]
            colour = (
                np.array(choices[rng.integers(len(choices))], np.float32)
                if self.chance(0.7)
                else rng.uniform(0, 255, 3)
            )
            if kind == "inverted":
                colour = np.array(
                    [(0, 0, 0), (40, 40, 40), (80, 40, 20), (40, 60, 30), (25, 25, 60)][rng.integers(5)],
                    np.float32,
                ) + rng.uniform(0, 15)
            self.page[:] = colour
            self.see_through = 0.0 if kind == "flat" else 1.0
            if kind == "inverted" and self.chance(0.4):
                self.page += _clouds(rng, h, w, 30)[..., None] * 12
            return
        if kind == "scenery":
            self.see_through = 0.0
            self._scenery()
            return
        tint = rng.uniform(200, 255) + rng.normal(0, 6, 3) + np.array([-12, 0, 6]) * rng.uniform(0, 2)
        self.page[:] = np.clip(tint if self.chance(0.7) else 255, 120, 255)
        if self.chance(0.5):
            self.page += (_clouds(rng, h, w, rng.uniform(1, 40)) * rng.uniform(1, 6))[..., None]
        if kind == "ruled" or (kind in ("photo", "child") and self.chance(0.2)):
            self._rules()
        if self.chance(0.15) or (kind == "photo" and self.chance(0.4)):
            self._crumple()

    def _rules(self) -> None:
        rng = self.rng
        step = self.long / rng.uniform(6, 36)
        canvas = np.zeros((self.h, self.w), np.uint8)
        lean = rng.normal(0, 0.02) if self.chance(0.5) else 0
        thick = 1 if self.long < 500 and self.chance(0.75) else 2
        squared = self.chance(0.5)
        start = rng.uniform(0, step)
        weak = int(rng.integers(60, 200)) if squared and self.chance(0.25) else 255  # but every fifth
        for k, y in enumerate(np.arange(start - self.h * 0.2, self.h * 1.2, step)):
            cv2.line(
                canvas,
                (0, round(y * 16)),
                (self.w * 16, round((y + lean * self.w) * 16)),
                weak if k % 5 else 255,
                thick,
                cv2.LINE_AA,
                4,
            )
        if squared:
            for k, x in enumerate(np.arange(start - self.w * 0.2, self.w * 1.2, step)):
                cv2.line(
                    canvas,
                    (round(x * 16), 0),
                    (round((x - lean * self.h) * 16), self.h * 16),
                    weak if k % 5 else 255,
                    thick,
                    cv2.LINE_AA,
                    4,
                )
        elif self.chance(0.4):
            x = round(rng.uniform(0.05, 0.2) * self.w)
            cv2.line(canvas, (x, 0), (x, self.h), 255, thick, cv2.LINE_AA)
        colour = np.array(
            [[230, 160, 120], [200, 200, 200], [160, 160, 230], [190, 200, 150], [120, 120, 120]][
                rng.integers(5)
            ],
            np.float32,
        )
        line = canvas[..., None].astype(np.float32) / 255 * rng.uniform(0.4, 1.0)
        self.page = self.page * (1 - line) + colour * line

    def _crumple(self) -> None:
        rng = self.rng
        for _ in range(rng.integers(1, 7)):
            a, way = rng.uniform(0, 1, 2) * [self.w, self.h], rng.normal(0, 1, 2)
            way /= np.linalg.norm(way)
            y, x = np.mgrid[: self.h, : self.w]
            d = (x - a[0]) * way[0] + (y - a[1]) * way[1]
            d = d.astype(np.float32)
            self.page += (np.sign(d) * np.exp(-np.abs(d) / rng.uniform(2, 25)) * rng.uniform(2, 14))[
                ..., None
            ]

    def _scenery(self) -> None:
        rng, h, w = self.rng, self.h, self.w
        top, bottom = rng.uniform(60, 255, 3), rng.uniform(60, 255, 3)
        self.page[:] = top + (bottom - top) * np.linspace(0, 1, h)[:, None, None]
        for _ in range(rng.integers(1, 5)):
            x = np.linspace(0, 1, 24)
            y = rng.uniform(0.3, 0.95) + 0.15 * np.cumsum(rng.normal(0, 0.35, 24)) / 3
            outline = np.concatenate([np.stack([x * w, y * h], 1), [[w, h * 1.5], [0, h * 1.5]]])
            cv2.fillPoly(
                self.page, [np.rint(outline).astype(np.int32)], rng.uniform(20, 240, 3).tolist(), cv2.LINE_AA
            )
        for _ in range(rng.integers(0, 7)):
            c, r = rng.uniform(0, 1, 2) * [w, h], rng.uniform(0.03, 0.2, 2) * self.long
            cv2.ellipse(
                self.page,
                tuple(map(int, c)),
                tuple(map(int, r + 1)),
                rng.uniform(0, 180),
                0,
                360,
                rng.uniform(20, 250, 3).tolist(),
                -1,
                cv2.LINE_AA,
            )
        if self.chance(0.5):
            self.page += _clouds(rng, h, w, rng.uniform(3, 30))[..., None] * rng.uniform(3, 20)

    def _text(self) -> None:
        """Write words and signatures off the objects."""
        rng = self.rng
        for _ in range(rng.integers(1, 4)):
            word = "".join(
                rng.choice(list("abcdefghiklmnoprstuvwxyzABDEHKMRST0123456789 ."), rng.integers(2, 14))
            )
            scale = rng.uniform(0.25, 0.7) * self.long / 320
            font = int(rng.choice([0, 1, 2, 3, 4, 5, 6, 7]))
            (tw, th), _ = cv2.getTextSize(word, font, scale, 1)
            for _ in range(6):
                x, y = rng.integers(0, max(self.w - tw, 1)), rng.integers(th, max(self.h, th + 1))
                if self.presence[max(y - th - 3, 0) : y + 4, max(x - 3, 0) : x + tw + 3].max(initial=0) < 0.1:
                    canvas = np.zeros((self.h, self.w), np.uint8)
                    cv2.putText(
                        canvas,
                        word,
                        (int(x), int(y)),
                        font,
                        scale,
                        255,
                        1 + int(self.chance(0.2)),
                        cv2.LINE_AA,
                    )
                    dark = canvas[..., None].astype(np.float32) / 255
                    self.page = self.page * (1 - dark) + np.float32(rng.uniform(0, 90, 3)) * dark
                    break

    def _degrade(self) -> None:
        rng, kind, h, w = self.rng, self.kind, self.h, self.w
        if kind == "clean":
            return
        if kind == "photo" or (kind == "child" and self.chance(0.5)):
            y, x = np.mgrid[:h, :w].astype(np.float32) / self.long
            light = 1 + rng.normal(0, 0.25) * (x - 0.5) + rng.normal(0, 0.25) * (y - 0.5)
            if self.chance(0.6):  # the shadow of a hand or a head
                shadow: NDArray[Any] = np.zeros((h, w), np.float32)
                points = (
                    rng.uniform(-0.2, 1.2, 2) * [w, h]
                    + rng.normal(0, 0.35, (rng.integers(4, 9), 2)) * self.long
                )
                cv2.fillPoly(shadow, [cv2.convexHull(np.rint(points).astype(np.int32))], 1.0)
                shadow = cv2.GaussianBlur(shadow, (0, 0), rng.uniform(1.0, 25))
                light = light * (1 - rng.uniform(0.1, 0.5) * shadow)
            self.page *= np.clip(light, 0.25, 1.4)[..., None] * rng.uniform(0.6, 1.05)
            self.page *= np.array([rng.uniform(0.8, 1), rng.uniform(0.9, 1), 1.0])
            if self.chance(0.4):
                self._desk()
            for _ in range(rng.integers(1, 4) if self.chance(0.25) else 0):
                self._lying()
        if self.chance(0.25):
            sigma = rng.uniform(0.4, 1.1)
            self.page = np.asarray(cv2.GaussianBlur(self.page, (0, 0), sigma), self.page.dtype)
        if self.chance(0.4):
            self.page = self.page + rng.normal(0, rng.uniform(0.5, 7), (h, w, 1 if self.chance(0.5) else 3))
        if self.chance(0.2):
            gamma = np.exp(rng.normal(0, 0.25))
            self.page = 255 * np.clip(self.page / 255, 0, 1) ** gamma

    def _lying(self) -> None:
        """Draw a finger, a hand or a pencil that reaches in from the border, with its shadow."""
        rng, h, w = self.rng, self.h, self.w
        way = rng.uniform(0, 2 * np.pi)
        out = np.array([w, h]) / 2 + np.array([np.cos(way), np.sin(way)]) * self.long * 0.75
        tip = out - np.array([np.cos(way), np.sin(way)]) * self.long * rng.uniform(0.1, 0.4)
        shape = np.zeros((h, w), np.uint8)
        wide = max(round(self.long * rng.uniform(0.02, 0.12)), 2)
        start, end = (np.rint(p).astype(int).tolist() for p in (out, tip))
        cv2.line(shape, start, end, 1, wide, cv2.LINE_AA)
        if (self.presence[shape > 0] > 0.2).any():
            return
        shadow = cv2.GaussianBlur(shape.astype(np.float32), (0, 0), wide / 4 + 1)
        self.page *= (1 - 0.4 * shadow)[..., None]
        depth = cv2.distanceTransform(shape, cv2.DIST_L2, 3) / (wide / 2)
        skin = (
            np.array([150, 180, 225]) * rng.uniform(0.3, 1.05)
            if self.chance(0.6)
            else rng.uniform(20, 240, 3)
        )
        lit = np.float32(skin) * (0.6 + 0.4 * depth.clip(0, 1))[..., None]
        self.page = np.where(shape[..., None] > 0, lit, self.page)
        self.ink[shape > 0] = 0

    def _desk(self) -> None:
        """Lay the sheet on a desk: outside a quadrilateral, the page is wood, cloth or shade."""
        rng, h, w = self.rng, self.h, self.w
        lo, hi = -0.02, 0.11
        corners = np.array(
            [
                [rng.uniform(lo, hi), rng.uniform(lo, hi)],
                [1 - rng.uniform(lo, hi), rng.uniform(lo, hi)],
                [1 - rng.uniform(lo, hi), 1 - rng.uniform(lo, hi)],
                [rng.uniform(lo, hi), 1 - rng.uniform(lo, hi)],
            ]
        ) * [w, h]
        sheet = np.zeros((h, w), np.float32)
        cv2.fillPoly(sheet, [np.rint(corners * 16).astype(np.int32)], 1.0, cv2.LINE_AA, 4)
        desk = np.full((h, w, 3), rng.uniform(20, 220, 3), np.float32)
        desk += _clouds(rng, h, w, rng.uniform(2, 25))[..., None] * rng.uniform(2, 25)
        sheet[self.presence > 0.5] = 1
        shadow = cv2.GaussianBlur(sheet, (0, 0), 3)
        desk *= (1 - 0.4 * shadow)[..., None]
        self.page = self.page * sheet[..., None] + desk * (1 - sheet[..., None])
        self.ink *= sheet


class _Style:
    """The pens and colours of a page, common to all its objects."""

    def __init__(self, rng: Rng, writer: _Writer) -> None:
        self.rng = rng
        kind = writer.kind
        ground = writer.page.mean((0, 1))
        self.paper_like = np.clip(ground if writer.see_through else np.full(3, 250.0), 0, 255)
        inverted = kind == "inverted" or (kind == "flat" and ground.mean() < 60 and rng.random() < 0.3)
        self.pen = rng.uniform(0, 45, 3) if rng.random() < 0.75 else rng.uniform(0, 190, 3)
        if rng.random() < 0.4 or kind == "clean":
            self.pen = np.zeros(3) + rng.uniform(0, 25)
        if inverted:
            self.pen = np.full(3, rng.uniform(190, 255)) if rng.random() < 0.7 else rng.uniform(150, 255, 3)
        self.share = float(np.exp(rng.uniform(np.log(0.0022), np.log(0.022))))  # of the span
        if rng.random() < (0.4 if kind in ("child", "strokes") else 0.15):
            self.share = rng.uniform(0.015, 0.05)
        if rng.random() < 0.3 and kind in ("child", "photo"):  # a felt pen
            self.pen = rng.uniform(0, 255, 3) * np.array([1, 0.4, 0.7])
        self.inner = rng.choice([1.0, 0.6, 0.3, 0.2], p=[0.5, 0.25, 0.15, 0.1])
        if self.inner < 0.5:
            self.share = max(self.share, 0.012)
        self.darkness = rng.uniform(0.75, 1) if kind != "sketchy" else rng.uniform(0.35, 1)
        if kind == "photo":
            self.darkness = rng.uniform(0.5, 1)
        rough = {"clean": 0.0, "gaps": 0.5, "sketchy": 1.0, "photo": 0.8, "ruled": 0.6, "child": 0.9}.get(
            kind, 0.35
        )
        self.wobble = rough * rng.choice([0, 0.002, 0.005, 0.008])
        self.sketchy = rng.uniform(0.3, 1) if kind == "sketchy" else 0.15 if rng.random() < 0.2 * rough else 0
        self.double = rng.uniform(0.8, 4) if rng.random() < (0.25 if kind == "child" else 0.03) else 0.0
        self.pale = rng.uniform(0.2, 0.9) if rng.random() < (0.3 if kind == "child" else 0.03) else 0.0
        self.overshoot = rng.choice([0, 0.006, 0.02]) if rough else 0
        self.taper = rng.choice([0, 0.4, 0.8]) if rng.random() < 0.4 else 0
        self.pressure = rng.uniform(0.3, 1) if rng.random() < 0.4 * rough else 0
        self.missed = float(rng.choice([0, 0, 0.3, 0.8]))
        self.construction = kind == "sketchy" and rng.random() < 0.5
        self.hatched = rng.random() < (0.02 if kind == "clean" else 0.07)
        self.blacks = rng.random() < (0.12 if kind == "clean" else 0.2) and kind not in (
            "inverted",
            "sketchy",
            "photo",
        )
        self.black_share = rng.uniform(0.1, 0.7)
        self.white_details = rng.random() < 0.6
        self.outline_target = True
        # on a flat ground other than paper, an unpainted object is white or light
        self.covered = writer.see_through < 1 and not (inverted and rng.random() < 0.6)
        self.cover = rng.uniform(200, 255, 3) if rng.random() < 0.5 else np.full(3, rng.uniform(235, 255))
        if writer.see_through == 0 and not self.covered and not inverted and ground.mean() < 90:
            self.pen = np.full(3, rng.uniform(190, 255))
        if writer.see_through == 1 and abs(ground.mean() - self.pen.mean()) < 60:
            self.pen = np.full(3, 255.0) if ground.mean() < 110 else np.zeros(3)

    def width(self, span: float) -> float:
        return max(self.share * span, 0.7)

    def colours(self, count: int) -> NDArray[np.float64]:
        rng = self.rng
        if rng.random() < 0.3:
            return np.clip(rng.uniform(60, 250, 3) + rng.normal(0, 30, (count, 3)), 0, 255)
        if rng.random() < 0.25:  # greys
            return np.repeat(rng.uniform(BLACK, 235, (count, 1)), 3, 1)
        colours = rng.uniform(10, 255, (count, 3))
        return np.where(colours.max(1, keepdims=True) > BLACK, colours, colours + BLACK)


def _moved(move: Move, lines: list[Points]) -> list[Points]:
    return (
        np.split(move(np.concatenate(lines)), np.cumsum([len(line) for line in lines])[:-1]) if lines else []
    )


def _even(points: Points, steps: Floats, count: int) -> Points:
    away = np.concatenate([[0], np.cumsum(steps)])
    at = np.linspace(0, away[-1], count)
    return np.stack([np.interp(at, away, points[:, k]) for k in (0, 1)], 1).astype(np.float32)


def _noise(rng: Rng, count: int, waves: float) -> Points:
    knots = max(int(waves * rng.uniform(3, 12)), 3)
    return np.stack(
        [
            np.interp(np.linspace(0, 1, count), np.linspace(0, 1, knots), rng.normal(0, 1, knots))
            for _ in (0, 1)
        ],
        1,
    ).astype(np.float32)


def _runs(keep: Bools) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], keep.view(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _longer(piece: Points, length: float) -> Points:
    way = piece[-1] - piece[max(-4, -len(piece))]
    norm = float(np.linalg.norm(way))
    return (
        piece if norm < 1e-3 else np.concatenate([piece, piece[-1:] + way / norm * length]).astype(np.float32)
    )


def _clouds(rng: Rng, h: int, w: int, grain: float) -> Floats:
    small = rng.normal(0, 1, (max(int(h / grain), 2), max(int(w / grain), 2))).astype(np.float32)
    return np.asarray(cv2.resize(small, (w, h), interpolation=cv2.INTER_CUBIC), np.float32)


def _box(mask: Floats) -> tuple[int, int, int, int]:
    rows, columns = np.flatnonzero((mask > 0.3).any(1)), np.flatnonzero((mask > 0.3).any(0))
    return (rows[0], rows[-1] + 1, columns[0], columns[-1] + 1) if len(rows) else (0, 1, 0, 1)
