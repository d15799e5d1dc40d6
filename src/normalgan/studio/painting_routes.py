"""Painting routes: a drawing comes, and its map, its heights, its file or points for hints go."""

import time
from collections.abc import Callable
from functools import partial
from typing import TypeVar
from urllib.parse import quote

import numpy as np
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from normalgan.normals import encode
from normalgan.painting.painting import Painted
from normalgan.painting.suggestion import suggest
from normalgan.studio.bodies import gone, read_fields
from normalgan.studio.drawing import Drawing, take_drawing
from normalgan.studio.exports import take_wish
from normalgan.studio.fields import Fields, take_integer, take_text
from normalgan.studio.painter import Painter
from normalgan.studio.request_queue import RequestQueue

T = TypeVar("T")
_LARGEST = 2**53
"""Whole numbers up to here are exact in JavaScript."""


class PaintingRoutes:
    """Responses to drawings.

    Args:
        painter: paints them.
    """

    def __init__(self, painter: Painter) -> None:
        self._painter = painter
        # Heights and exports take seconds; no stroke waits for them.
        self._quick, self._slow = RequestQueue(), RequestQueue()
        self._exports = 0

    def routes(self) -> list[Route]:
        """Return where they are asked for."""
        return [
            Route("/api/paint", self.paint, methods=["POST"]),
            Route("/api/suggest", self.suggest, methods=["POST"]),
            Route("/api/height", self.height, methods=["POST"]),
            Route("/api/export", self.export, methods=["POST"]),
        ]

    def close(self) -> None:
        """Begin nothing more."""
        self._quick.close()
        self._slow.close()

    async def paint(self, request: Request) -> Response:
        """Answer with the colours of the normals and the mask as alpha, W × H × 4 bytes."""
        start, fields = time.perf_counter(), await read_fields(request)
        drawing = take_drawing(fields)
        map_ = await self._ordered(self._quick, request, fields, partial(self._map, drawing))
        return _dropped() if map_ is None else _pixels(*map_, start)

    async def suggest(self, request: Request) -> Response:
        """Answer with places where a hint would help."""
        fields = await read_fields(request)
        work = partial(self._points, take_drawing(fields), take_integer(fields, "count", 1, 20, 5))
        points = await self._ordered(self._quick, request, fields, work)
        return _dropped() if points is None else JSONResponse({"points": points})

    async def height(self, request: Request) -> Response:
        """Answer with heights, W × H floats, none off the object."""
        start, fields = time.perf_counter(), await read_fields(request)
        heights = await self._ordered(
            self._slow, request, fields, partial(self._heights, take_drawing(fields))
        )
        return _dropped() if heights is None else _pixels(*heights, start)

    async def export(self, request: Request) -> Response:
        """Answer with a file as ``normalgan generate`` writes it."""
        fields = await read_fields(request)
        work = partial(self._file, take_drawing(fields), fields)
        self._exports += 1  # none takes another one's place
        file = await self._ordered(self._slow, request, fields, work, f"{self._exports} ")
        if file is None:
            return _dropped()
        name, content = file
        attachment = f"attachment; filename*=UTF-8''{quote(name, safe='')}"
        return Response(content, headers={"Content-Disposition": attachment}, media_type=_OCTETS)

    async def _ordered(
        self, queue: RequestQueue, request: Request, fields: Fields, work: Callable[[], T], apart: str = ""
    ) -> T | None:
        """Return what the work gives, in its turn; None if it is not wanted any more."""
        tab = f"{request.url.path} {apart}{take_text(fields, 'tab', 64)}"
        return await queue.do(tab, take_integer(fields, "number", 0, _LARGEST), work, partial(gone, request))

    def _map(self, drawing: Drawing) -> tuple[bytes, Painted]:
        painted = self._painter.paint(drawing)
        alpha = np.where(painted.mask, 255, 0).astype(np.uint8)
        return np.dstack([encode(painted.normals), alpha]).tobytes(), painted

    def _points(self, drawing: Drawing, count: int) -> list[dict[str, object]]:
        painted, hints = self._painter.paint(drawing), drawing.read()[1]
        taken = np.empty((0, 2), np.float32) if hints is None else hints.points
        found = suggest(painted.normals, painted.mask, painted.confidence, taken, count)
        return [
            {"x": point.x, "y": point.y, "normal": list(point.normal), "gain": point.gain} for point in found
        ]

    def _heights(self, drawing: Drawing) -> tuple[bytes, Painted]:
        from normalgan.painting.height import integrate  # here: its solver takes a while to import

        painted = self._painter.paint(drawing)
        height = np.where(painted.mask, integrate(painted.normals, painted.mask), np.nan)
        return height.astype("<f4").tobytes(), painted

    def _file(self, drawing: Drawing, fields: Fields) -> tuple[str, bytes]:
        wish = take_wish(fields)
        return wish.write(self._painter.paint(drawing, wish.longest))


_OCTETS = "application/octet-stream"


def _pixels(content: bytes, painted: Painted, start: float) -> Response:
    height, width = painted.mask.shape
    headers = {
        "X-Width": str(width),
        "X-Height": str(height),
        "X-Warning": quote(painted.warning),
        "X-Seconds": f"{time.perf_counter() - start:.4f}",
    }
    return Response(content, headers=headers, media_type=_OCTETS)


def _dropped() -> Response:
    return Response(status_code=204)
