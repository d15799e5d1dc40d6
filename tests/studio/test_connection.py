"""Heads of requests that trickle: given up in time, and however many there are, they shut nobody out."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import pytest
import uvicorn
from uvicorn.server import ServerState

from normalgan.studio import connection
from normalgan.studio.connection import Connection

HEAD = b"POST / HTTP/1.1\r\nHost: here\r\nContent-Length: 2\r\n\r\n"
Stream = tuple[asyncio.StreamReader, asyncio.StreamWriter]


async def app(scope: Any, receive: Any, send: Any) -> None:
    body = b""
    while len(body) < 2:
        body += (await receive())["body"]
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"2")]})
    await send({"type": "http.response.body", "body": body})


def try_out(use: Callable[[int], Awaitable[None]]) -> None:
    """Serve at a port while it is used."""

    async def serve() -> None:
        config = uvicorn.Config(app, http=Connection, log_config=None)
        state = ServerState()
        server = await asyncio.get_running_loop().create_server(
            lambda: Connection(config, state, {}), "127.0.0.1", 0
        )
        async with server:
            await asyncio.wait_for(use(server.sockets[0].getsockname()[1]), 60)

    asyncio.run(serve())
    assert connection._waiting == []


async def trickle(stream: Stream, head: bytes = HEAD) -> None:
    """Send a byte every twentieth of a second until nobody listens."""
    reader, writer = stream
    for byte in head * 100:
        if reader.at_eof() or writer.is_closing():
            return
        writer.write(bytes([byte]))
        await asyncio.sleep(0.05)


@pytest.fixture
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "PATIENCE", 0.5)


@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize("before", [0, 2])
def test_a_head_that_trickles_is_given_up_also_after_other_requests(before: int) -> None:
    async def use(port: int) -> None:
        stream = reader, writer = await asyncio.open_connection("127.0.0.1", port)
        for _ in range(before):
            writer.write(HEAD + b"ab")
            assert (await reader.readuntil(b"ab")).startswith(b"HTTP/1.1 200")
        sending = asyncio.create_task(trickle(stream, b"GET / HTTP/1.1\r\nX: " + b"a" * 1000))
        answer = await reader.read()
        assert answer.startswith(b"HTTP/1.1 408")
        assert answer.endswith(b'{"error": "the request came in too slowly; send it again."}')
        sending.cancel()
        writer.close()

    try_out(use)


@pytest.mark.usefixtures("hasty")
def test_a_connection_that_says_nothing_is_closed_without_a_word() -> None:
    async def use(port: int) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        assert await reader.read() == b""
        writer.close()

    try_out(use)


@pytest.mark.usefixtures("hasty")
def test_a_body_may_take_longer_than_a_head() -> None:
    async def use(port: int) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(HEAD + b"a")
        await asyncio.sleep(1)
        writer.write(b"b")
        assert (await reader.readuntil(b"ab")).startswith(b"HTTP/1.1 200")
        writer.close()

    try_out(use)


def test_of_too_many_heads_the_oldest_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "MOST_AT_ONCE", 3)

    async def use(port: int) -> None:
        streams = []
        for number in range(4):
            streams.append(await asyncio.open_connection("127.0.0.1", port))
            streams[-1][1].write(b"G")
            while len(connection._waiting) <= min(number, 2) or not connection._waiting[-1]._begun:
                await asyncio.sleep(0.01)
        assert (await streams[0][0].read()).startswith(b"HTTP/1.1 408")
        reader, writer = streams[1]
        writer.write(b"ET / HTTP/1.1\r\nHost: here\r\nContent-Length: 2\r\n\r\nab")
        assert (await reader.readuntil(b"ab")).startswith(b"HTTP/1.1 200")
        for _, other in streams:
            other.close()
        while connection._waiting:
            await asyncio.sleep(0.01)

    try_out(use)
