"""Routes: answer requests for the map, heights, files or suggested hints of a drawing."""

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from functools import partial
from typing import TypeVar
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from normalgan.errors import InputError, RunError
from normalgan.inference.findings import Finding, finding_of, words_of
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.suggestion import suggest, uncertainty
from normalgan.normals import pixels_of
from normalgan.studio.drawings.drawing_request import to_hints
from normalgan.studio.drawings.layers import Layer, predict_layers, take_layers
from normalgan.studio.drawings.planes import CONTENT_TYPE, KeptPlanes, split_body
from normalgan.studio.drawings.schemas import ExportFields, PredictFields, RequestFields, SuggestFields, parse
from normalgan.studio.predictions.exports import read_export_request
from normalgan.studio.predictions.predictor import DrawingPredictor
from normalgan.studio.predictions.request_queue import RequestQueue, Stop
from normalgan.studio.server.bodies import (
    MOST_BYTES,
    MOST_EXPORT_BYTES,
    check_type,
    read_body,
    wait_disconnect,
)
from normalgan.studio.server.refusals import RefusedError

T = TypeVar("T")
F = TypeVar("F", bound=RequestFields)


class PredictionRoutes:
    """The routes that predict drawings.

    Args:
        predictor: predicts the drawings.
    """

    def __init__(self, predictor: DrawingPredictor) -> None:
        self._predictor = predictor
        # Heights and exports take seconds, so they have a queue of their own.
        self._quick, self._slow = RequestQueue(), RequestQueue()
        self._exports = 0
        self._kept = KeptPlanes()

    def routes(self) -> list[Route]:
        """Return the routes."""
        return [
            Route("/api/predict", self.predict, methods=["POST"]),
            Route("/api/suggest", self.suggest, methods=["POST"]),
            Route("/api/uncertainty", self.uncertainty, methods=["POST"]),
            Route("/api/height", self.height, methods=["POST"]),
            Route("/api/export", self.export, methods=["POST"]),
        ]

    def close(self) -> None:
        """Stop accepting work."""
        self._quick.close()
        self._slow.close()

    async def predict(self, request: Request) -> Response:
        """Return the map as W × H × 4 bytes: the colours of the normals, and the object's opacity as alpha.

        With ``changed_only``, only changed layers are predicted. The maps of the other layers are reused,
        although they were predicted in a different context.
        """
        start = time.perf_counter()
        fields, layers = await self._asked(request, PredictFields)
        stop = Stop() if fields.draft else None
        work = partial(self._map, layers, fields.longest, stop, any_context=fields.changed_only)
        try:
            map_ = await self._ordered(self._quick, request, fields, work, stop=stop)
        except InputError as error:
            if not _is_raw(request) or isinstance(error, RunError | RefusedError):
                raise
            # A new drawing may lack lines, and the browser would log an error status.
            return _dropped(finding_of(error))
        return _dropped() if map_ is None else _pixels(*map_, start)

    async def suggest(self, request: Request) -> Response:
        """Return points where a hint would help."""
        fields, layers = await self._asked(request, SuggestFields)
        work = partial(self._points, layers, fields.count)
        points = await self._ordered(self._quick, request, fields, work)
        return _dropped() if points is None else JSONResponse({"points": points})

    async def uncertainty(self, request: Request) -> Response:
        """Return the expected error as W × H bytes, 255 for 90°; empty if the model has no confidence."""
        start = time.perf_counter()
        fields, layers = await self._asked(request, RequestFields)
        doubts = await self._ordered(self._quick, request, fields, partial(self._doubts, layers))
        return _dropped() if doubts is None else _pixels(*doubts, start)

    async def height(self, request: Request) -> Response:
        """Return the heights as W × H floats, NaN off the object."""
        start = time.perf_counter()
        fields, layers = await self._asked(request, RequestFields)
        heights = await self._ordered(self._slow, request, fields, partial(self._heights, layers))
        return _dropped() if heights is None else _pixels(*heights, start)

    async def export(self, request: Request) -> Response:
        """Return a file as ``normalgan generate`` writes it."""
        fields, layers = await self._asked(request, ExportFields, MOST_EXPORT_BYTES)
        work = partial(self._file, layers, fields)
        self._exports += 1  # exports do not replace one another
        file = await self._ordered(self._slow, request, fields, work, f"{self._exports} ")
        if file is None:
            return _dropped()
        name, content = file
        attachment = f"attachment; filename*=UTF-8''{quote(name, safe='')}"
        return Response(content, headers={"Content-Disposition": attachment}, media_type=_OCTETS)

    async def _asked(
        self, request: Request, schema: type[F], most: int = MOST_BYTES
    ) -> tuple[F, list[Layer]]:
        """Return the fields and the layers of a request with PNGs in JSON or with raw pixels."""
        check_type(request, "application/json", CONTENT_TYPE)
        content = await read_body(request, most)
        pixels = None
        if _is_raw(request):
            content, pixels = split_body(content)
        fields = parse(schema, content)
        return fields, take_layers(fields, self._kept, pixels)

    async def _ordered(
        self,
        queue: RequestQueue,
        request: Request,
        fields: RequestFields,
        work: Callable[[], T],
        apart: str = "",
        stop: Stop | None = None,
    ) -> T | None:
        """Return the result of the work, run in turn; None if a newer request replaces it."""
        tab = f"{request.url.path} {apart}{fields.tab}"
        return await queue.do(tab, fields.number, work, partial(wait_disconnect, request), stop)

    def _predict(
        self,
        layers: Sequence[Layer],
        longest: int | None = None,
        stop: Stop | None = None,
        *,
        any_context: bool = False,
    ) -> NormalMap:
        check = (stop or Stop()).check
        predict = partial(self._predictor.predict, longest=longest, check=check, any_context=any_context)
        return predict_layers(layers, predict)

    def _map(
        self, layers: Sequence[Layer], longest: int | None, stop: Stop | None, *, any_context: bool
    ) -> tuple[bytes, NormalMap]:
        predicted = self._predict(layers, longest, stop, any_context=any_context)
        return pixels_of(predicted.extended, alpha=predicted.alpha).tobytes(), predicted

    def _points(self, layers: Sequence[Layer], count: int) -> list[dict[str, object]]:
        predicted = self._predict(layers)
        given = [hint for layer in layers for hint in layer.drawing.fields.hints]
        hints = to_hints(given, (predicted.mask.shape[0], predicted.mask.shape[1]))
        mask = predicted.mask
        lines = _lines(layers, mask)
        found = suggest(predicted.extended, mask, predicted.confidence, hints.points, count, lines)
        return [
            {"x": point.x, "y": point.y, "normal": list(point.normal), "gain": point.gain} for point in found
        ]

    def _doubts(self, layers: Sequence[Layer]) -> tuple[bytes, NormalMap]:
        predicted = self._predict(layers)
        if predicted.confidence is None:
            return b"", predicted
        shares = np.where(predicted.mask, uncertainty(predicted.confidence), 0)
        return np.rint(255 * np.clip(shares, 0, 1)).astype(np.uint8).tobytes(), predicted

    def _heights(self, layers: Sequence[Layer]) -> tuple[bytes, NormalMap]:
        predicted = self._predict(layers)
        own = replace(predicted)  # a copy, so that the cached map does not keep the heights
        height = np.where(own.mask, own.height(), np.nan)
        return height.astype("<f4").tobytes(), predicted

    def _file(self, layers: Sequence[Layer], fields: ExportFields) -> tuple[str, bytes]:
        export = read_export_request(fields)
        return export.encode(self._predict(layers, export.longest))


_OCTETS = "application/octet-stream"


def _is_raw(request: Request) -> bool:
    """Return whether a request has raw pixels, like the page's requests."""
    return request.headers["content-type"].partition(";")[0].strip().lower() == CONTENT_TYPE


def _pixels(content: bytes, predicted: NormalMap, start: float) -> Response:
    height, width = predicted.mask.shape
    headers = {
        "X-Width": str(width),
        "X-Height": str(height),
        "X-Findings": _header(predicted.findings),
        "X-Seconds": f"{time.perf_counter() - start:.4f}",
    }
    return Response(content, headers=headers, media_type=_OCTETS)


def _lines(layers: Sequence[Layer], mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the mask (H, W) of all dark pixels."""
    inked = np.zeros_like(mask)
    for layer in layers:
        picture, _ = layer.drawing.read_lines()
        dark = picture.darkness() > 0.5
        inked |= dark if picture.alpha is None else dark & (picture.alpha > 0.5)
    return inked


def _dropped(*lacks: Finding) -> Response:
    return Response(status_code=204, headers={"X-Findings": _header(lacks)})


def _header(findings: Sequence[Finding]) -> str:
    """Return findings as percent-encoded JSON, each with its text for the command line."""
    return quote(json.dumps([{**asdict(each), "words": words_of(each)} for each in findings]))
