"""Connection: HTTP/1.1 as uvicorn speaks it, where the head of a request must come in in time."""

import asyncio
import json
from typing import Any

import h11
from uvicorn.config import Config
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.server import ServerState

__all__ = ["MOST_AT_ONCE", "PATIENCE", "Connection"]

PATIENCE = 20.0
"""Seconds for the request line and the headers; from the same machine they take a part of one."""
MOST_AT_ONCE = 128
"""Connections that may be without a whole head; a browser opens a handful."""
_TOO_SLOW = json.dumps({"error": "the request came in too slowly; send it again."}).encode()
_waiting: list["Connection"] = []
"""Oldest first."""


class Connection(H11Protocol):
    """A connection that is given up if the head of a request does not come in in `PATIENCE` seconds.

    uvicorn alone bounds the time between two requests, which ends with the first byte: heads that trickle
    would use up the sockets that a process may have. If too many connections wait for a head, the one that
    has waited for longest is given up.
    """

    def __init__(
        self,
        config: Config,
        server_state: ServerState,
        app_state: dict[str, Any],
        _loop: asyncio.AbstractEventLoop | None = None,
    ) -> None:
        super().__init__(config, server_state, app_state, _loop)
        self._limit: asyncio.TimerHandle | None = None
        self._begun = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn's
        """Begin to wait for the first head."""
        super().connection_made(transport)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        self._stop_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Go on with a request; what comes in does not lengthen the time for its head."""
        self._begun = True
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE or self.transport.is_closing():
            self._stop_waiting()
        elif self._limit is None:
            self._wait()

    def _wait(self) -> None:
        if len(_waiting) >= MOST_AT_ONCE:
            _waiting[0].give_up()
        _waiting.append(self)
        self._limit = self.loop.call_later(PATIENCE, self.give_up)

    def _stop_waiting(self) -> None:
        self._begun = False
        if self._limit is not None:
            self._limit.cancel()
            self._limit = None
            _waiting.remove(self)

    def give_up(self) -> None:
        """Close the connection; if a head had begun, after saying why."""
        begun = self._begun
        self._stop_waiting()
        if self.transport.is_closing():
            return
        if begun and self.conn.our_state is h11.IDLE:
            headers = [
                (b"content-type", b"application/json"),
                (b"content-length", str(len(_TOO_SLOW)).encode()),
                (b"connection", b"close"),
            ]
            response = h11.Response(status_code=408, headers=headers, reason=b"Request Timeout")
            for event in (response, h11.Data(data=_TOO_SLOW), h11.EndOfMessage()):
                self.transport.write(self.conn.send(event) or b"")
        self.transport.close()
