"""Firefox as its users have it, driven over Marionette; skips the test with a reason where it is missing.

Playwright drives only its own build of Firefox, and Debian has no geckodriver. Each Firefox has Marionette,
which geckodriver itself speaks: a length, a colon, and JSON over a socket. Commands:
https://searchfox.org/mozilla-central/source/remote/marionette/driver.sys.mjs
"""

import json
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from needs import FIREFOX

PATIENCE = 90.0
"""Seconds after which something never comes."""
SETTINGS = {
    "marionette.port": 0,  # a free one, which it writes into the profile
    "app.update.auto": False,
    "browser.aboutwelcome.enabled": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "toolkit.telemetry.server": "",
}


class Firefox:
    """A running Firefox with one window.

    Args:
        folder: of its profile, which keeps it all for the next time.
        process: of it.
    """

    def __init__(self, folder: Path, process: subprocess.Popen[bytes]) -> None:
        self._process = process
        self._number = 0
        end = time.monotonic() + PATIENCE
        told = folder / "MarionetteActivePort"
        while not (told.exists() and told.read_text().strip()):
            assert time.monotonic() < end, "Firefox does not start"
            assert process.poll() is None, "Firefox has ended"
            time.sleep(0.05)
        self._socket = socket.create_connection(("127.0.0.1", int(told.read_text())), PATIENCE)
        self._stream = self._socket.makefile("rb")
        self._read()  # who it is
        self.command(
            "WebDriver:NewSession", {"capabilities": {"alwaysMatch": {"timeouts": {"script": 90_000}}}}
        )

    def command(self, name: str, values: dict[str, Any] | None = None) -> Any:
        """Return the answer to a command."""
        self._number += 1
        text = json.dumps([0, self._number, name, values or {}]).encode()
        self._socket.sendall(b"%d:%b" % (len(text), text))
        _, _, error, result = self._read()
        assert error is None, f"{name}: {error}"
        return result.get("value") if isinstance(result, dict) else result

    def _read(self) -> Any:
        length = b""
        while (letter := self._stream.read(1)) != b":":
            assert letter, "Firefox has gone"
            length += letter
        return json.loads(self._stream.read(int(length)))

    def go(self, url: str) -> None:
        """Open a page, or open it again."""
        self.command("WebDriver:Navigate", {"url": url})

    def run(self, body: str, *arguments: object) -> Any:
        """Return what a function body in the page returns, awaited."""
        script = (
            f"const done = arguments[arguments.length - 1], work = async (...given) => {{ {body} }};"
            "work(...arguments).then(done, (error) => done(`failed: ${error}`));"
        )
        return self.command("WebDriver:ExecuteAsyncScript", {"script": script, "args": list(arguments)})

    def wait_for(self, condition: str) -> None:
        """Wait until an expression of the page is true."""
        end = time.monotonic() + PATIENCE
        while self.run(f"return Boolean({condition})") is not True:
            assert time.monotonic() < end, (
                f"{condition} does not come: {self.run(f'return String({condition})')}"
            )
            time.sleep(0.05)

    def click(self, selector: str) -> None:
        """Click an element."""
        self.command("WebDriver:ElementClick", {"id": self._find(selector)})

    def choose_file(self, selector: str, file: Path) -> None:
        """Have a field take a file."""
        self.command("WebDriver:ElementSendKeys", {"id": self._find(selector), "text": str(file)})

    def _find(self, selector: str) -> str:
        found = self.command("WebDriver:FindElement", {"using": "css selector", "value": selector})
        (identity,) = found.values()
        return str(identity)

    def drag(self, *points: tuple[float, float], kind: str = "mouse") -> None:
        """Press the mouse at a point of the window, move it through others, and release it.

        Args:
            points: x and y in pixels of the window.
            kind: "mouse", or "touch" for a finger.
        """
        moves = [{"type": "pointerMove", "x": round(x), "y": round(y), "duration": 20} for x, y in points]
        actions = [
            moves[0],
            {"type": "pointerDown", "button": 0},
            *moves[1:],
            {"type": "pointerUp", "button": 0},
        ]
        pointer = {"type": "pointer", "id": kind, "parameters": {"pointerType": kind}, "actions": actions}
        self.command("WebDriver:PerformActions", {"actions": [pointer]})

    def kill(self) -> None:
        """End it without a warning."""
        self._process.kill()
        self._process.wait(PATIENCE)

    def close(self) -> None:
        """End it."""
        if self._process.poll() is None:
            self.command("Marionette:Quit", {"flags": ["eForceQuit"]})
            self._process.wait(PATIENCE)
        self._stream.close()
        self._socket.close()


@contextmanager
def firefox(folder: Path) -> Iterator[Firefox]:
    """Open Firefox on a profile; costs some seconds."""
    named = os.environ.get("NORMALGAN_FIREFOX")
    path = shutil.which(named or "firefox") or shutil.which(named or "firefox-esr")
    if path is None:
        pytest.skip(FIREFOX.reason(f"there is none at {named}" if named else "it is not installed"))
    folder.mkdir(exist_ok=True)
    (folder / "MarionetteActivePort").unlink(missing_ok=True)
    lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in SETTINGS.items()]
    (folder / "user.js").write_text("".join(lines))
    command = [path, "--headless", "--marionette", "--no-remote", "--width", "1200", "--height", "800"]
    with (folder / "said.txt").open("wb") as said:
        process = subprocess.Popen([*command, "--profile", str(folder)], stdout=said, stderr=said)
    try:
        running = Firefox(folder, process)
        try:
            yield running
        finally:
            running.close()
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
