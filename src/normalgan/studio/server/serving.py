"""Serving: run an application on a local port until Ctrl-C or SIGTERM."""

import errno
import ipaddress
import signal
import socket
import sys
from types import FrameType

import uvicorn
from starlette.types import ASGIApp

from normalgan.errors import CommandExit, InputError

_GRACE = 10
"""Seconds that running requests have to finish when the server is stopped."""


def listen(port: int, address: str = "127.0.0.1") -> socket.socket:
    """Return a socket that listens on a port.

    Args:
        port: port to listen on; 0 picks a free one.
        address: IPv4 address: 127.0.0.1 for this machine only, 0.0.0.0 for all interfaces.

    Raises:
        InputError: if the port is taken, or the address or port is invalid.
    """
    try:
        ipaddress.IPv4Address(address)
    except ValueError:
        raise InputError(
            f"--address {address} is not an IPv4 address; use 127.0.0.1, or 0.0.0.0 in a container."
        ) from None
    if not 0 <= port <= 65535:
        raise InputError(f"port is {port}; use 1 to 65535, or 0 for a free port.")
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if sys.platform != "win32":  # on Windows it would let two servers share a port
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((address, port))
        listening.listen(128)
    except OSError as error:
        listening.close()
        if error.errno == errno.EADDRINUSE:
            raise InputError(
                f"port {port} is taken, perhaps by another studio; give another --port, or 0 for a free one."
            ) from None
        raise InputError(f"port {port} of {address} cannot be used: {error.strerror}.") from None
    return listening


def serve(app: ASGIApp, listening: socket.socket) -> None:
    """Serve until a signal; SIGTERM exits with code 0.

    Raises:
        KeyboardInterrupt: after Ctrl-C, once all requests have been answered.
    """
    signal.signal(signal.SIGTERM, _leave)  # uvicorn raises the signal again after its shutdown
    config = uvicorn.Config(
        app,
        http="h11",
        ws="none",
        loop="asyncio",
        lifespan="on",
        access_log=False,
        log_level="error",
        server_header=False,
        proxy_headers=False,
        timeout_graceful_shutdown=_GRACE,
    )
    server = _Server(config)
    server.run(sockets=[listening])
    if server.interrupted:  # Python drops a KeyboardInterrupt that is raised within a destructor
        raise KeyboardInterrupt


class _Server(uvicorn.Server):
    """A server that remembers whether Ctrl-C stopped it."""

    interrupted = False

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Stop serving."""
        self.interrupted = self.interrupted or sig == signal.SIGINT
        super().handle_exit(sig, frame)


def _leave(number: int, frame: FrameType | None) -> None:
    raise CommandExit(0)
