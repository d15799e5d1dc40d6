"""Chromium driven by Playwright, for tests of pages; skips the test with a reason where either is missing."""

import os
import re
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
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
_open_browsers: list["Browser | BrowserContext"] = []


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
    with _playwright() as playwright:
        opened = playwright.chromium.launch(
            executable_path=executable(),
            headless=True,
            args=[*ALWAYS, *(WITH_WEBGL if webgl else WITHOUT_WEBGL)],
        )
        _open_browsers.append(opened)
        try:
            yield opened
        finally:
            _open_browsers.remove(opened)
            opened.close()


@contextmanager
def profile(folder: Path, *, width: int = 1200, height: int = 700) -> Iterator["BrowserContext"]:
    """Open a browser whose storage lies on the disk, as a user has it, without WebGL.

    `storage` and `page` keep theirs in memory, where large values never have to be fetched.

    Args:
        folder: of the profile, which keeps it all for the next time.
        width: Of the view of a page, in CSS pixels.
        height: Of the view, in CSS pixels.
    """
    with _playwright() as playwright:
        context = playwright.chromium.launch_persistent_context(
            folder,
            executable_path=executable(),
            headless=True,
            args=[*ALWAYS, *WITHOUT_WEBGL],
            viewport={"width": width, "height": height},
        )
        context.set_default_timeout(PATIENCE)
        _open_browsers.append(context)
        try:
            yield context
        finally:
            _open_browsers.remove(context)
            context.close()


@contextmanager
def _playwright() -> Iterator["Playwright"]:
    api = pytest.importorskip("playwright.sync_api", reason="Playwright for Python is not installed")
    executable()  # which skips the test
    if not _running:
        _running.append(api.sync_playwright().start())
    try:
        yield _running[0]
    finally:
        if not _open_browsers:
            _running.pop().stop()


@pytest.fixture(scope="module")
def opened() -> Iterator["Browser"]:
    """Chromium without WebGL, one for all tests of a module."""
    with browser(webgl=False) as chromium:
        yield chromium


@contextmanager
def storage(
    opened: "Browser", *, width: int, height: int, scale: float = 1, locale: str = "en-US"
) -> Iterator["BrowserContext"]:
    """Open a storage, for pages that share it; they are closed on leaving.

    Args:
        opened: The browser.
        width: Of the view of a page, in CSS pixels.
        height: Of the view, in CSS pixels.
        scale: Device pixels for a CSS pixel.
        locale: What the browser asks for.
    """
    context = opened.new_context(
        viewport={"width": width, "height": height}, device_scale_factor=scale, locale=locale
    )
    context.set_default_timeout(PATIENCE)
    try:
        yield context
    finally:
        context.close()


@contextmanager
def page(
    opened: "Browser",
    *,
    width: int = 1280,
    height: int = 800,
    scale: float = 1,
    locale: str = "en-US",
    tolerate: Sequence[str] = (),
) -> Iterator["Page"]:
    """Open an empty page with its own storage; on leaving, it must have logged no warning and no error.

    Args:
        opened: The browser.
        width: Of the view, in CSS pixels.
        height: Of the view, in CSS pixels.
        scale: Device pixels for a CSS pixel.
        locale: What the browser asks for.
        tolerate: Regular expressions of messages that are expected, such as "status of 412".
    """
    with storage(opened, width=width, height=height, scale=scale, locale=locale) as context:
        new = context.new_page()
        complaints = Complaints(new)
        yield new
    complaints.check(tolerate)


class Complaints:
    """What a page has logged as a warning or an error.

    Args:
        page: that is listened to.
    """

    def __init__(self, page: "Page") -> None:
        self._texts: list[str] = []
        page.on("console", self._note)
        page.on("pageerror", lambda error: self._texts.append(f"uncaught: {error}"))

    def _note(self, message: "ConsoleMessage") -> None:
        # Only a picture that is opened alone asks for this; a page names its icon.
        if message.type in {"warning", "error"} and not message.location["url"].endswith("/favicon.ico"):
            self._texts.append(message.text)

    def check(self, tolerate: Sequence[str] = ()) -> None:
        """Assert that there was none, but for those that are expected, and forget them."""
        unexpected = [text for text in self._texts if not any(re.search(known, text) for known in tolerate)]
        self._texts.clear()
        assert not unexpected, f"the page complained: {unexpected}"
