"""A proxy before an S3 server that spoils requests, as a network and a busy server do."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import ClassVar
from urllib.parse import urlsplit

KINDS = ("reset", "busy", "cut", "forgotten")
"""Ways to spoil a request.

``reset``: the connection closes before the server has seen it. ``busy``: the server says 503 Slow Down.
``cut``: the answer ends in the middle of its body. ``forgotten``: the server does as asked, but the
connection closes before it says so.
"""

_BUSY = b"<Error><Code>SlowDown</Code><Message>Please reduce your request rate.</Message></Error>"


@dataclass
class Faults:
    """What a proxy spoils, and what it has spoilt.

    Args:
        kind: one of `KINDS`.
        every: each request of this number is spoilt; 0: none.
        away_after: requests after which every one is spoilt; None: never.
    """

    kind: str = "reset"
    every: int = 0
    away_after: int | None = None
    seen: int = 0
    spoilt: int = 0
    lock: threading.Lock = field(default_factory=threading.Lock)

    def spoils(self) -> bool:
        """Whether the next request is spoilt."""
        with self.lock:
            self.seen += 1
            spoilt = bool(self.every and not self.seen % self.every)
            spoilt |= self.away_after is not None and self.seen > self.away_after
            self.spoilt += spoilt
            return spoilt


@contextmanager
def faulty_proxy(endpoint: str, faults: Faults) -> Iterator[str]:
    """Yield the address of a proxy before an endpoint."""

    class Handler(_Handler):
        pass

    Handler.faults, Handler.upstream = faults, urlsplit(endpoint).netloc
    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, args=(0.05,))
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    faults: ClassVar[Faults]
    upstream: ClassVar[str]

    def _pass_on(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        spoilt = self.faults.spoils()
        kind = self.faults.kind if spoilt else ""
        if kind == "reset":
            return self._hang_up()
        if kind == "busy":
            return self._answer(503, [("Content-Type", "application/xml")], _BUSY)
        upstream = HTTPConnection(self.upstream)
        upstream.request(self.command, self.path, body, dict(self.headers))
        answer = upstream.getresponse()
        content = answer.read()
        upstream.close()
        if kind == "forgotten" or (kind == "cut" and len(content) < 2):
            return self._hang_up()
        own = {"content-length", "transfer-encoding", "connection"}
        headers = [(name, value) for name, value in answer.getheaders() if name.lower() not in own]
        length = answer.getheader("Content-Length") if self.command == "HEAD" else None
        self._answer(answer.status, headers, content, length, half=kind == "cut")
        return None

    do_GET = do_PUT = do_POST = do_DELETE = do_HEAD = _pass_on  # noqa: N815 - http.server's names

    def _answer(
        self,
        status: int,
        headers: list[tuple[str, str]],
        body: bytes,
        length: str | None = None,
        half: bool = False,
    ) -> None:
        with suppress(OSError):
            self.send_response(status)
            for name, value in headers:
                self.send_header(name, value)
            self.send_header("Content-Length", length or str(len(body)))
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(body[: len(body) // 2] if half else body)
        if half:
            self._hang_up()

    def _hang_up(self) -> None:
        self.close_connection = True
        with suppress(OSError):
            self.wfile.flush()
            self.connection.shutdown(socket.SHUT_RDWR)

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""
