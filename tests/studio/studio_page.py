"""The studio as a user has it: its server as a process, its page in Chromium, and hands that draw on it."""

import io
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from chromium import PATIENCE, Complaints, storage
from chromium import page as open_page

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Locator, Page, Request

SIDE = 256
"""Of the drawings."""
RADIUS = 80
AWAY = r"ERR_(CONNECTION_REFUSED|CONNECTION_RESET|SOCKET_NOT_CONNECTED|EMPTY_RESPONSE|INCOMPLETE_CHUNKED)"
"""What Chromium says of a server that is away, whatever the page does about it."""

STORED = """() => new Promise((resolve) => {
  indexedDB.open("normalgan-studio").onsuccess = ({ target: { result: database } }) => {
    database.transaction("unsaved").objectStore("unsaved").getAll().onsuccess = ({ target: { result } }) => {
      database.close();
      resolve(result);
    };
  };
})"""
"""What the browser's own store holds of unsaved work: a document and its history for each tab."""
SENT = """async () => {
  const read = (path) => fetch(`/api/autosave${path}`).then((answer) => answer.json());
  return Promise.all((await read("")).map(({ name }) => read(`/${name}`)));
}"""
"""What the server holds of unsaved work: a document for each tab."""

Point = tuple[float, float]
T = TypeVar("T")


class Server:
    """A studio's process.

    Args:
        model: what paints.
        projects: its folder.
        more: further words of the command line.
    """

    def __init__(self, model: Path, projects: Path, *more: str) -> None:
        self._command = [sys.executable, "-m", "normalgan", "studio", *more, "--no-browser"]
        self._command += ["--model", str(model), "--projects", str(projects)]
        self.port = 0
        self._projects = projects
        self.start()

    def start(self) -> None:
        """Start it, where it was before."""
        self._process = subprocess.Popen(
            [*self._command, "--port", str(self.port)],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
        assert found, line
        self.url, self.port = found[0], int(found[1])

    def kill(self) -> None:
        """End it without a warning."""
        self.signal(signal.SIGKILL)
        self.wait()

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def reset(self) -> None:
        """Forget all projects and unsaved work; start it, if a test has ended it."""
        for document in self._projects.rglob("*.normalgan"):
            document.unlink()
        if self._process.poll() is not None:
            self.start()

    def stop(self) -> None:
        """End it."""
        self._process.terminate()
        self.wait()

    def wait(self) -> None:
        """Wait for its end."""
        self._process.wait(60)
        assert self._process.stdout is not None
        self._process.stdout.close()


@contextmanager
def serving(model: Path, projects: Path, *more: str) -> Iterator[Server]:
    """Run a studio."""
    server = Server(model, projects, *more)
    try:
        yield server
    finally:
        server.stop()


@pytest.fixture(scope="session")
def only_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A studio that paints a ramp and, near hints, what they say; one for all tests of this process."""
    from onnx_models import write_model

    folder = tmp_path_factory.mktemp("studio")
    with serving(write_model(folder / "ramp.onnx", reach=3), folder / "projects") as running:
        yield running


@pytest.fixture
def server(only_server: Server) -> Server:
    """That studio, running, which has forgotten what other tests did.

    Unsaved work is offered above the drawing: what lies where may not depend on what an earlier test sent.
    """
    only_server.reset()
    return only_server


class Studio:
    """A page of the studio.

    Args:
        page: an empty one.
        url: the server's.
    """

    def __init__(self, page: "Page", url: str) -> None:
        self.page = page
        # A hand seems to hold still while the machine is busy, which would make a shape of its stroke.
        page.add_init_script(
            "addEventListener('DOMContentLoaded', () => { document.documentElement.dataset.held = 1e9; })"
        )
        self.open(url)

    def open(self, url: str) -> None:
        """Go to the studio's address, and wait until the page is there."""
        self.page.goto(url)
        self.page.wait_for_selector("html[data-ready]")

    def new(self, width: int = SIDE, height: int = SIDE) -> None:
        """Begin with an empty drawing; there must be nothing unsaved."""
        if self.page.locator("#menu-toggle").is_visible():
            self.page.locator("#menu-toggle").click()
        self.page.locator("#new").click()
        self.page.locator("#new-width").fill(str(width))
        self.page.locator("#new-height").fill(str(height))
        with self.answering("new-dialog"):
            self.page.locator("#new-dialog button.strong").click()
        self.size = width, height

    def dismiss(self, dialog: str) -> None:
        """Close a dialog by Escape: the browser's own process closes it, after the key has come back."""
        self.page.keyboard.press("Escape")
        self.page.locator(f"#{dialog}-dialog").wait_for(state="hidden")

    @contextmanager
    def answering(self, dialog: str) -> Iterator[None]:
        """Wait, after what is done inside, until a dialog has closed and the page has gone on from there.

        It is told so by an event, which comes after the click; what the mouse does next may overtake that.
        """
        self.page.evaluate(
            """dialog => {
              window.answered = new Promise((done) => {
                document.getElementById(dialog).addEventListener("close", () => done(), { once: true });
              });
            }""",
            dialog,
        )
        yield
        self.page.evaluate("answered")

    def on_board(self, x: float, y: float) -> tuple[float, float]:
        """Return where a point of the drawing is on the screen."""
        (at,) = self._on(self.page.locator("#board"), (x, y))
        return at

    def on_result(self, x: float, y: float) -> tuple[float, float]:
        """Return where a point of the drawing is on the screen, in the pane of the result."""
        (at,) = self._on(self.page.locator("#overlay"), (x, y))
        return at

    def along(self, *points: Point) -> list[Point]:
        """Return where points of the drawing are on the screen, asked for once: it stays while one draws."""
        return self._on(self.page.locator("#board"), *points)

    def _on(self, canvas: "Locator", *points: Point) -> list[Point]:
        box = canvas.bounding_box()
        assert box is not None
        margin = min(24, box["width"] / 20)
        scale = min((box["width"] - 2 * margin) / self.size[0], (box["height"] - 2 * margin) / self.size[1])
        left = box["x"] + (box["width"] - scale * self.size[0]) / 2
        top = box["y"] + (box["height"] - scale * self.size[1]) / 2
        return [(left + scale * x, top + scale * y) for x, y in points]

    def line(self, *points: Point) -> None:
        """Draw with the mouse through points of the drawing."""
        first, *others = self.along(*points)
        self.page.mouse.move(*first)
        self.page.mouse.down()
        for point in others:
            self.page.mouse.move(*point)
        self.page.mouse.up()

    def circle(self, x: float = SIDE / 2, y: float = SIDE / 2, radius: float = RADIUS) -> None:
        """Draw a circle with the mouse."""
        angles = [2 * math.pi * i / 24 for i in range(25)]
        self.line(*((x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles))

    @contextmanager
    def repainting(self, *, begun: bool = False) -> Iterator[None]:
        """Wait, after what is done inside, until a new map is on show and nothing is being painted.

        Args:
            begun: whether a gesture goes on, of which something may be painted; else what was asked for
                before is on show first, lest its map be taken for the new one.
        """
        if not begun:
            self.page.wait_for_function("() => document.getElementById('result').ariaBusy !== 'true'")
        before = self.predicted()
        yield
        self.page.wait_for_function(
            "before => Number(document.getElementById('result').dataset.painted ?? 0) > before "
            "&& document.getElementById('result').ariaBusy === 'false'",
            arg=before,
        )

    def predicted(self) -> int:
        """Return how many maps were on show."""
        return int(self.page.locator("#result").get_attribute("data-painted") or 0)

    def pin(self, x: float, y: float) -> None:
        """Pin a point, with the tool for it."""
        self.page.locator("#tool-hint").click()
        self.page.mouse.click(*self.on_board(x, y))

    def turn(self, x: float, y: float) -> None:
        """Turn the ball to a normal: x to the right, y upwards."""
        box = self.page.locator("#ball").bounding_box()
        assert box is not None
        radius = box["width"] / 2 / 1.03
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.move(*middle)
        self.page.mouse.down()
        self.page.mouse.move(middle[0] + x * radius, middle[1] - y * radius, steps=4)
        self.page.mouse.up()

    def wait_for_frame(self) -> None:
        """Wait until what was done is drawn: the page draws, and learns of new sizes, with its next frame."""
        self.page.evaluate(
            "new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(() => done())); })"
        )

    def until(self, look: Callable[[], T], wanted: Callable[[T], bool] = bool) -> T:
        """Look until what is seen is as wanted, and return it: it may come some time after what was done."""
        end = time.monotonic() + PATIENCE / 1000
        while not wanted(seen := look()):
            assert time.monotonic() < end, f"only this is seen: {seen}"
            self.page.wait_for_timeout(20)
        return seen

    def restored(self) -> None:
        """Make sure that unsaved work was restored without a question, and wait until its map is on show."""
        words = self.page.locator("#toast-words")
        self.until(words.inner_text, lambda said: said.startswith("Restored"))
        self.page.wait_for_function(
            "() => document.getElementById('result').dataset.painted "
            "&& document.getElementById('result').ariaBusy === 'false'"
        )

    def save_as(self, name: str) -> None:
        """Save a drawing that has no name yet as a project."""
        with self.saying(f"Saved “{name}”."):
            self.page.keyboard.press("Control+s")
            self.page.locator("#name-field").fill(name)
            self.page.keyboard.press("Enter")

    def wait_for_store(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Wait until the browser's own store holds some unsaved work, and return it."""
        return self._kept(STORED, wanted)

    def wait_for_server(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Wait until the server holds a document of unsaved work, and return it: it may have an older one."""
        return self._kept(SENT, wanted)

    def _kept(self, script: str, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        # `wait_for_function` takes a promise for true.
        kept: list[dict[str, Any]]
        kept = self.until(lambda: self.page.evaluate(script), lambda kept: any(map(wanted, kept)))
        return next(each for each in kept if wanted(each))

    def screen(self) -> NDArray[np.uint8]:
        """Return what the window shows."""
        self.wait_for_frame()
        return np.asarray(Image.open(io.BytesIO(self.page.screenshot())).convert("RGB"))

    def shown(self, x: float, y: float) -> NDArray[np.float64]:
        """Return the normal on show at a point of the drawing, in the view of the map."""
        column, row = self.on_result(x, y)
        show = "visible => { document.getElementById('overlay').style.visibility = visible ? '' : 'hidden'; }"
        self.page.evaluate(show, False)  # marks cover the map
        colour: NDArray[np.float64] = self.screen()[round(row), round(column)] / 127.5 - 1
        self.page.evaluate(show, True)
        return colour

    def inked(self, x: float, y: float) -> bool:
        """Return whether there is ink at a point of the drawing."""
        column, row = self.on_board(x, y)
        self.page.mouse.move(2, 2)  # away with the nib
        return bool(self.screen()[round(row), round(column)].max() < 128)

    def status(self) -> str:
        """Return what the status says, or the toast of what went wrong."""
        said = self.page.locator("#problem-words, #status").all_text_contents()
        return " ".join(words for words in said if words)

    @contextmanager
    def saying(self, words: str, *, whole: bool = False) -> Iterator[None]:
        """Wait, after what is done inside, until the page says something; what it said before is gone.

        Inside of `repainting`: what was done is said for some seconds only, and a map may take as long.

        Args:
            words: a part of what it says.
            whole: whether that is all that it says.
        """
        said = "['status', 'problem-words'].map((each) => document.getElementById(each))"
        self.page.evaluate(f"() => {{ for (const each of {said}) each.textContent = ''; }}")
        yield
        now = f"{said}.map((each) => each.textContent)"
        is_said = f"{now}.join('') === words" if whole else f"{now}.some((each) => each.includes(words))"
        self.page.wait_for_function(f"words => {is_said}", arg=words)

    def stop_clock(self) -> None:
        """Have what follows come at once on the page's clock, however busy the machine is."""
        self.page.evaluate("() => { const now = performance.now(); performance.now = () => now; }")


class Hand:
    """Fingers on the screen, as Chromium gets them from a touch screen.

    Args:
        studio: what they touch; all points are in pixels of the window.
        pace: seconds from one event to the next that the page is told of, however busy the machine is; None:
            those that really went by.
    """

    def __init__(self, studio: Studio, pace: float | None = None) -> None:
        self._session = studio.page.context.new_cdp_session(studio.page)
        self._pace, self._now = pace, time.time()

    def put(self, *fingers: Point) -> None:
        """Lay further fingers down; name those that lie there already first."""
        self._tell("touchStart", fingers)

    def move(self, *fingers: Point) -> None:
        """Move the fingers that lie there."""
        self._tell("touchMove", fingers)

    def lift(self) -> None:
        """Take all away."""
        self._tell("touchEnd", ())

    def _tell(self, kind: str, fingers: tuple[Point, ...]) -> None:
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(fingers)]
        event: dict[str, Any] = {"type": kind, "touchPoints": points}
        if self._pace is not None:
            self._now += self._pace
            event["timestamp"] = self._now
        self._session.send("Input.dispatchTouchEvent", event)


class Pen:
    """A pen on the screen, as Chromium gets it from a tablet; all points are in pixels of the window.

    Args:
        studio: where it draws.
    """

    def __init__(self, studio: Studio) -> None:
        self._session = studio.page.context.new_cdp_session(studio.page)

    def hover(self, at: Point) -> None:
        """Hold it above the screen."""
        self._tell("mouseMoved", at)

    def down(self, at: Point, pressure: float = 0.5) -> None:
        """Put it down."""
        self._tell("mousePressed", at, pressure, button="left", buttons=1, clickCount=1)

    def move(self, at: Point, pressure: float = 0.5) -> None:
        """Draw."""
        self._tell("mouseMoved", at, pressure, button="left", buttons=1)

    def up(self, at: Point) -> None:
        """Lift it."""
        self._tell("mouseReleased", at, button="left", clickCount=1)

    def _tell(self, kind: str, at: Point, pressure: float = 0, **more: Any) -> None:
        event = {"type": kind, "x": at[0], "y": at[1], "pointerType": "pen", "force": pressure, "tiltX": 20}
        self._session.send("Input.dispatchMouseEvent", event | more)


@contextmanager
def sending_nothing_late(page: "Page") -> Iterator[None]:
    """Once a page is left, have it ask the server for nothing more; wait for what it sends of unsaved work.

    As it is closed it would send more, which would come when the next test has begun, and be offered there.
    """
    under_way: set[Request] = set()

    def begun(request: "Request") -> None:
        if "/api/autosave/" in request.url:
            under_way.add(request)

    def ended(request: "Request") -> None:
        under_way.discard(request)

    listeners: list[tuple[Any, Callable[[Request], None]]]
    listeners = [("request", begun), ("requestfinished", ended), ("requestfailed", ended)]
    for event, listener in listeners:
        page.on(event, listener)
    try:
        yield
    finally:  # also of a test that has failed: the next one would fail as well
        if not page.is_closed():
            # In the page: what a closed page still sends passes by Playwright's routes.
            page.evaluate("() => { window.fetch = () => new Promise(() => {}); }")
            end = time.monotonic() + 60
            while under_way:
                assert time.monotonic() < end, f"{[request.url for request in under_way]} have no answer"
                page.wait_for_timeout(10)
            for event, listener in listeners:
                page.remove_listener(event, listener)


@contextmanager
def open_studio(
    opened: "Browser", url: str, *, width: int = 1200, height: int = 700, tolerate: tuple[str, ...] = ()
) -> Iterator[Studio]:
    """Open the studio in a page of its own storage."""
    with open_page(opened, width=width, height=height, tolerate=tolerate) as page, sending_nothing_late(page):
        yield Studio(page, url)


@contextmanager
def begun(context: "BrowserContext", server: Server, *, room: int | None = None) -> Iterator[Studio]:
    """Open the studio in a tab of a browser, and close it.

    Args:
        context: of the browser.
        server: of the studio.
        room: bytes that the browser has for it.
    """
    page = context.new_page()
    if room is not None:  # before the page asks for any: the browser remembers for a while how much there is
        wanted = {"origin": server.url.rstrip("/"), "quotaSize": room}
        context.new_cdp_session(page).send("Storage.overrideQuotaForOrigin", wanted)
    with sending_nothing_late(page):
        studio = Studio(page, server.url)
        studio.size = SIDE, SIDE
        yield studio
    page.close()


class OnlyPage:
    """One page for the tests of a module: its files are loaded once, which takes longer than most tests do.

    Args:
        context: its storage.
        server: that it comes from.
    """

    def __init__(self, context: "BrowserContext", server: Server) -> None:
        self._context, self._server = context, server
        server.reset()
        page = context.new_page()
        self._complaints = Complaints(page)
        self._studio = Studio(page, server.url)
        self._size, self._fresh = page.viewport_size, True

    @contextmanager
    def renewed(self, tolerate: tuple[str, ...] = ()) -> Iterator[Studio]:
        """Open the studio in a storage that is empty again; on leaving, it must have logged nothing else.

        The server has forgotten too what other tests did.
        """
        if not self._fresh:
            self._forget()
        self._fresh = False
        with sending_nothing_late(self._studio.page):
            yield self._studio
        self._complaints.check(tolerate)

    def _forget(self) -> None:
        page = self._studio.page
        page.goto(f"{self._server.url}page/icon.svg")  # of the same origin, but without a program
        page.mouse.up()  # a test that has failed may have left it down
        page.evaluate("sessionStorage.clear()")
        session = self._context.new_cdp_session(page)
        origin = self._server.url.rstrip("/")
        session.send("Storage.clearDataForOrigin", {"origin": origin, "storageTypes": "all"})
        session.detach()
        self._context.clear_permissions()
        if self._size is not None:
            page.set_viewport_size(self._size)
        self._server.reset()
        self._studio.open(self._server.url)


@pytest.fixture(scope="module")
def only_page(opened: "Browser", only_server: Server) -> Iterator[OnlyPage]:
    """The page of a module."""
    with storage(opened, width=1200, height=700) as context:
        yield OnlyPage(context, only_server)


@pytest.fixture
def studio(only_page: OnlyPage) -> Iterator[Studio]:
    """An empty drawing."""
    with only_page.renewed() as page:
        page.new()
        yield page


@pytest.fixture
def ball(studio: Studio) -> Studio:
    """A circle, painted."""
    with studio.repainting():
        studio.circle()
    return studio
