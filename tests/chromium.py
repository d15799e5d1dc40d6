"""Chromium driven by Playwright, for tests of pages; skips the test with a reason where either is missing."""

import os
import re
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

from needs import CHROMIUM

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, Playwright

ALWAYS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
# SwiftShader draws WebGL on the CPU: the same pixels on every machine, and no graphics card needed.
WITH_WEBGL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
WITHOUT_WEBGL = ("--disable-gpu", "--disable-webgl", "--disable-3d-apis")

PATIENCE = 90_000
"""Milliseconds after which something never comes to a page, be the machine as busy as it may."""

_running: list["Playwright"] = []  # one for all browsers open: a thread cannot hold two
_open_browsers: list["Browser"] = []


def executable() -> str:
    """Path of Chromium: NORMALGAN_CHROMIUM, Debian's, or any on the PATH; skips the test if there is none."""
    named = os.environ.get("NORMALGAN_CHROMIUM")
    found = shutil.which(named or "chromium") or shutil.which(named or "chromium-browser")
    if found is None:
        pytest.skip(CHROMIUM.reason(f"there is none at {named}" if named else "it is not installed"))
    return found


@contextmanager
def browser(*, webgl: bool = True) -> Iterator["Browser"]:
    """Open a browser; costs a second or two, so open it in a fixture of the module.

    Not longer than that: while one is open, its event loop runs in this thread, and `asyncio.run` is refused.
    """
    api = pytest.importorskip("playwright.sync_api", reason="Playwright for Python is not installed")
    path = executable()
    if not _running:
        _running.append(api.sync_playwright().start())
    opened = None
    try:
        opened = _running[0].chromium.launch(
            executable_path=path, headless=True, args=[*ALWAYS, *(WITH_WEBGL if webgl else WITHOUT_WEBGL)]
        )
        _open_browsers.append(opened)
        yield opened
    finally:
        if opened is not None:
            _open_browsers.remove(opened)
            opened.close()
        if not _open_browsers:
            _running.pop().stop()


@pytest.fixture(scope="module")
def opened() -> Iterator["Browser"]:
    """Chromium without WebGL, one for all tests of a module."""
    with browser(webgl=False) as chromium:
        yield chromium


@contextmanager
def storage(opened: "Browser", *, width: int, height: int, scale: float = 1) -> Iterator["BrowserContext"]:
    """Open a storage, for pages that share it; they are closed on leaving.

    Args:
        opened: The browser.
        width: Of the view of a page, in CSS pixels.
        height: Of the view, in CSS pixels.
        scale: Device pixels for a CSS pixel.
    """
    context = opened.new_context(viewport={"width": width, "height": height}, device_scale_factor=scale)
    context.set_default_timeout(PATIENCE)
    try:
        yield context
    finally:
        context.close()


@contextmanager
def page(
    opened: "Browser", *, width: int = 1280, height: int = 800, scale: float = 1, tolerate: Sequence[str] = ()
) -> Iterator["Page"]:
    """Open an empty page with its own storage; on leaving, it must have logged no warning and no error.

    Args:
        opened: The browser.
        width: Of the view, in CSS pixels.
        height: Of the view, in CSS pixels.
        scale: Device pixels for a CSS pixel.
        tolerate: Regular expressions of messages that are expected, such as "status of 412".
    """
    complaints: list[str] = []

    def note(message: "ConsoleMessage") -> None:
        if message.type in {"warning", "error"}:
            complaints.append(message.text)

    with storage(opened, width=width, height=height, scale=scale) as context:
        new = context.new_page()
        new.on("console", note)
        new.on("pageerror", lambda error: complaints.append(f"uncaught: {error}"))
        yield new
    unexpected = [text for text in complaints if not any(re.search(known, text) for known in tolerate)]
    assert not unexpected, f"the page complained: {unexpected}"
