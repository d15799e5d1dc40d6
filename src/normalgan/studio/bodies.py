"""Bodies: what comes with a request, read no further than it may be long."""

from starlette.requests import Request

from normalgan.studio.fields import Fields, parse_fields
from normalgan.studio.refusals import TooLargeError, WrongTypeError

MOST_BYTES = 20 * 2**20
"""Longest body of a request."""


async def read_body(request: Request, most: int = MOST_BYTES) -> bytes:
    """Return the body of a request.

    Raises:
        TooLargeError: as soon as it is longer than ``most`` bytes, or says that it will be.
    """
    said = request.headers.get("content-length", "")
    body = bytearray()
    if not (said.isdecimal() and int(said[:20]) > most):
        async for chunk in request.stream():
            body += chunk
            if len(body) > most:
                break
        else:
            return bytes(body)
    raise TooLargeError(f"that is more than {most // 2**20} MB; send less.")


async def read_json(request: Request) -> bytes:
    """Return the body of a request that says it is JSON; other pages cannot send such without being asked.

    Raises:
        WrongTypeError: if it says something else.
        TooLargeError: if it is too long.
    """
    check_type(request, "application/json")
    return await read_body(request)


async def read_fields(request: Request) -> Fields:
    """Return the JSON object that a request brings.

    Raises:
        InputError: if it brings none.
    """
    return parse_fields(await read_json(request))


def check_type(request: Request, *prefixes: str) -> None:
    """Raise `WrongTypeError` if a request's body is of none of these types."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if not kind.startswith(prefixes):
        raise WrongTypeError(f"the body is {kind or 'of no type'}; it is to be {' or '.join(prefixes)}.")


async def gone(request: Request) -> None:
    """Return when the client has gone; its request must have been read."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
