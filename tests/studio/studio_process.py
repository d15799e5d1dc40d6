"""A studio in a process of its own, as a user starts it."""

import http.client
import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studio_client import b64, png

SLOW = 480
"""Side of a drawing whose heights take a second."""
JSON = {"Content-Type": "application/json"}


@dataclass
class Studio:
    """A server that runs.

    Args:
        process: of the command.
        port: that it serves at.
    """

    process: "subprocess.Popen[str]"
    port: int

    def ask(
        self, method: str, path: str, body: Any = None, headers: dict[str, str] | None = None
    ) -> tuple[int, Any, dict[str, str]]:
        """Return the status, the body, read if it is JSON, and the headers of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            sent = None if body is None else json.dumps(body)
            connection.request(method, path, sent, {**JSON, **(headers or {})})
            answer = connection.getresponse()
            content: Any = answer.read()
            if answer.headers.get_content_type() == "application/json":
                content = json.loads(content)
            return answer.status, content, {name.lower(): value for name, value in answer.getheaders()}
        finally:
            connection.close()


@contextmanager
def running(model: Path, folder: Path, *more: str) -> Iterator[Studio]:
    """Start a studio at a free port, and end it if it still runs."""
    command = [sys.executable, "-m", "normalgan", "studio", "--model", str(model), "--port", "0"]
    process = subprocess.Popen(
        [*command, "--projects", str(folder), "--no-browser", *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    try:
        yield Studio(process, _port(process))
    finally:
        process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def served(model: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """A studio that paints a ramp, one for all tests of a module."""
    with running(model, tmp_path_factory.mktemp("projects")) as studio:
        yield studio


def _port(process: "subprocess.Popen[str]", patience: float = 60) -> int:
    assert process.stdout is not None
    late = threading.Timer(patience, process.kill)
    late.start()
    line = process.stdout.readline()
    late.cancel()
    found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
    if found is None:
        process.kill()
        raise AssertionError(f"no studio: {line} {process.communicate()[1]}")
    return int(found[1])


def until(condition: Any, patience: float = 60) -> None:
    """Wait for something to become true."""
    end = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.01)


def slow() -> dict[str, object]:
    """Return fields of a large drawing."""

    y, x = np.mgrid[:SLOW, :SLOW]
    ring = np.abs(np.hypot(x - SLOW / 2, y - SLOW / 2) - 0.4 * SLOW) < 4
    return {"picture": b64(png(np.where(ring, 0, 255).astype(np.uint8)))}


def send(studio: Studio, path: str, body: object) -> http.client.HTTPConnection:
    """Send a request without waiting for the answer."""
    connection = http.client.HTTPConnection("127.0.0.1", studio.port, timeout=60)
    connection.request("POST", path, json.dumps(body), JSON)
    return connection
