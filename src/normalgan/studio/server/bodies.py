"""Bodies: read request bodies within a size limit."""

import asyncio

from starlette.requests import Request

from normalgan.studio.server.refusals import RefusedError

MOST_BYTES = 20 * 2**20
"""Maximum size of a request body in bytes."""
MOST_EXPORT_BYTES = 4 * MOST_BYTES
"""Maximum size of a request for files, which brings three pictures that the page draws itself, as base64."""
PATIENCE = 20.0
"""Maximum time in seconds for receiving a body; from the same machine it takes less than one."""


async def read_body(request: Request, most: int = MOST_BYTES) -> bytes:
    """Return the body of a request.

    Raises:
        RefusedError: if it arrives too slowly, or is, or is declared to be, longer than ``most`` bytes.
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
        raise RefusedError("the request arrived too slowly; send it again.", 408) from None
    return bytes(body)


def _too_large(most: int) -> RefusedError:
    return RefusedError(f"it is larger than {most // 2**20} MB; make it smaller.", 413)


async def read_json(request: Request) -> bytes:
    """Return the body of a JSON request; other pages cannot send this type without a preflight.

    Raises:
        RefusedError: if the type is not JSON, or it is too long or too slow.
    """
    check_type(request, "application/json")
    return await read_body(request)


def check_type(request: Request, *prefixes: str) -> None:
    """Raise `RefusedError` if the content type of a request has none of these prefixes."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if not kind.startswith(prefixes):
        raise RefusedError(f"the body is {kind or 'of no type'}; it must be {' or '.join(prefixes)}.", 415)


async def wait_disconnect(request: Request) -> None:
    """Wait until the client disconnects; the body must have been read before."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
