"""What the tests of the studio's server share: a client, and requests that paint."""

import base64
import io
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from starlette.testclient import TestClient

from normalgan.studio.app import build_app
from normalgan.studio.predictions.predictor import DrawingPredictor
from normalgan.studio.projects.document_store import DocumentStore
from normalgan.studio.projects.opening import Opened

PORT = 8400
HEIGHT, WIDTH = 120, 160
CENTRE, RADIUS = (70.0, 60.0), 42.0
Pixels = NDArray[np.uint8]


@contextmanager
def serving(model: Path, folder: Path, opened: Opened | None = None) -> Iterator[TestClient]:
    """Give a client of a studio in this process."""
    app = build_app(DrawingPredictor(model), DocumentStore(folder), PORT, opened)
    with TestClient(app, base_url=f"http://127.0.0.1:{PORT}") as client:
        yield client


def away() -> NDArray[np.float64]:
    """Return how far each pixel is from the circle's middle."""
    y, x = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    return np.asarray(np.hypot(x - CENTRE[0], y - CENTRE[1]))


def circle() -> Pixels:
    """Return a circle, black on white, with an edge as smooth as a pen's."""
    return np.rint(255 * np.clip(np.abs(away() - RADIUS) - 0.8, 0, 1)).astype(np.uint8)


def findings(answer: Any) -> list[dict[str, Any]]:
    """Return what is said about the map that was answered, or about a drawing that has none."""
    found: list[dict[str, Any]] = json.loads(unquote(answer.headers["x-findings"]))
    return found


def codes(answer: Any) -> list[tuple[str, str]]:
    """Return the layer and the code of each finding."""
    return [(each["layer"], each["code"]) for each in findings(answer)]


def png(pixels: Pixels) -> bytes:
    """Return the PNG of some pixels."""
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def b64(content: bytes) -> str:
    """Return bytes as JSON carries them."""
    return base64.b64encode(content).decode()


def asking(number: int = 1, **fields: Any) -> dict[str, Any]:
    """Return a request that paints."""
    return {
        "tab": "tab",
        "number": number,
        "picture": b64(png(circle())),
        "hints": [],
        "mask": None,
        "source": None,
        **fields,
    }


def document(**fields: Any) -> dict[str, Any]:
    """Return a project."""
    return {
        "format": "normalgan-studio",
        "version": 1,
        "width": 160,
        "height": 120,
        "strokes": [],
        "hints": [],
        "layers": [],
        "settings": {},
        **fields,
    }
