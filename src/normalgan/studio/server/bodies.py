"""Bodies: read request bodies within a size limit."""

import asyncio

from starlette.requests import Request

from normalgan.studio.server.refusals import TooLargeError, TooSlowError, WrongTypeError

__all__ = [
    "MOST_BYTES",
    "PATIENCE",
    "check_type",
    "read_body",
    "read_json",
    "wait_disconnect",
]

MOST_BYTES = 20 * 2**20
"""Longest body of a request."""
PATIENCE = 20.0
"""Seconds for a body to come in; from the same machine it takes a part of one."""


async def read_body(request: Request, most: int = MOST_BYTES) -> bytes:
    """Return the body of a request.

    Raises:
        TooLargeError: if it is longer than ``most`` bytes, or its Content-Length says so.
        TooSlowError: if it arrives too slowly.
    """
    said = request.headers.get("content-length", "")
    if said.isdecimal() and int(said[:20]) > most:
        raise _too_large(most)
    body = bytearray()
    try:
        async with asyncio.timeout(PATIENCE):
            async for chunk in request.stream():
                body += chunk
                if len(body) > most:
                    raise _too_large(most)
    except TimeoutError:
        raise TooSlowError("the request came in too slowly; send it again.") from None
    return bytes(body)


def _too_large(most: int) -> TooLargeError:
    return TooLargeError(f"it is larger than {most // 2**20} MB; make it smaller.")


async def read_json(request: Request) -> bytes:
    """Return the body of a JSON request; browsers let no other page send that type without a preflight.

    Raises:
        WrongTypeError: if the type is not JSON.
        TooLargeError: if it is too long.
    """
    check_type(request, "application/json")
    return await read_body(request)


def check_type(request: Request, *prefixes: str) -> None:
    """Raise `WrongTypeError` if a request's body is of none of these types."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if not kind.startswith(prefixes):
        raise WrongTypeError(f"the body is {kind or 'of no type'}; it must be {' or '.join(prefixes)}.")


async def wait_disconnect(request: Request) -> None:
    """Return when the client has disconnected; read its body before."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
