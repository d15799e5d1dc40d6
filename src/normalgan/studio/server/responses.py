"""Responses: errors as JSON, and the headers of every response."""

import os
import sys
import traceback

from starlette.datastructures import MutableHeaders
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from normalgan.errors import InputError, RunError, brief
from normalgan.studio.server.refusals import RefusedError

_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' data: blob:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'; object-src 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


def failed(sentence: str, status: int, headers: dict[str, str] | None = None) -> JSONResponse:
    """Return an error as JSON for the page."""
    return JSONResponse({"error": " ".join(sentence.split())}, status, headers)


def refused(error: InputError) -> JSONResponse:
    """Return the response to an `InputError`."""
    status = error.status if isinstance(error, RefusedError) else 500 if isinstance(error, RunError) else 400
    return failed(str(error), status)


class ResponseMiddleware:
    """Adds headers to each response, and turns unexpected exceptions into responses.

    Args:
        app: the application.
        kept: prefix of the addresses that browsers may cache forever.
    """

    def __init__(self, app: ASGIApp, kept: str) -> None:
        self._app = app
        self._kept = kept

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun = False

        async def sealed(message: Message) -> None:
            nonlocal begun
            if message["type"] == "http.response.start":
                begun = True
                headers = MutableHeaders(scope=message)
                headers.update(_HEADERS)
                headers["Cache-Control"] = self._caching(scope["path"], message["status"])
            await send(message)

        try:
            await self._app(scope, receive, sealed)
        except Exception as error:
            _report(error)
            if begun:  # too late for an error response: the client sees a truncated body
                raise
            await failed(_sentence(error), 500)(scope, receive, sealed)

    def _caching(self, path: str, status: int) -> str:
        if path.startswith("/api/"):
            return "no-store"
        if path.startswith(self._kept) and status in {200, 304}:
            return "max-age=31536000, immutable"
        return "no-cache"  # another version of the package may serve a different page here


def _sentence(error: Exception) -> str:
    """Return a message about a failure that does not reveal paths of this machine."""
    if isinstance(error, OSError):
        return f"the server could not read or write a file: {error.strerror or type(error).__name__}."
    if isinstance(error, MemoryError):
        return "out of memory; make the drawing smaller."
    return f"the server failed: {type(error).__name__}; see the terminal for details."


def _report(error: Exception) -> None:
    """Print an error to the terminal, with its traceback if NORMALGAN_TRACEBACK is set."""
    if os.environ.get("NORMALGAN_TRACEBACK"):
        traceback.print_exception(error)
    print(f"normalgan: studio: {type(error).__name__}: {brief(error)}", file=sys.stderr, flush=True)
