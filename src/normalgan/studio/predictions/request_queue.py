"""RequestQueue: a worker thread that serves only the newest request of each tab."""

import asyncio
from collections import OrderedDict
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

T = TypeVar("T")

_TABS = 256
"""Maximum number of tabs whose newest request number is remembered."""


class GivenUpError(Exception):
    """Raised to end work whose result is no longer needed."""


class Stop:
    """A flag that asks a draft to stop; the work checks it between its steps."""

    def __init__(self) -> None:
        self._asked = False

    def ask(self) -> None:
        """Ask the work to end at its next check."""
        self._asked = True

    def check(self) -> None:
        """Raise `GivenUpError` if the work was asked to end."""
        if self._asked:
            raise GivenUpError


@dataclass(eq=False)
class _Entry(Generic[T]):
    tab: str
    work: Callable[[], T]
    stop: Stop | None
    done: "asyncio.Future[T | None]"


class RequestQueue:
    """Runs one task at a time, in the order of the tabs' requests.

    If a tab sends another request while one is waiting, the new request takes the old one's place in the
    queue. A running task is finished, because otherwise a tab that sends requests continuously would never
    get a result. Only drafts are abandoned for final requests.
    """

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "queue")
        self._newest: OrderedDict[str, int] = OrderedDict()
        self._waiting: OrderedDict[str, _Entry[object]] = OrderedDict()
        self._running: _Entry[object] | None = None

    async def do(
        self,
        tab: str,
        number: int,
        work: Callable[[], T],
        gone: Callable[[], Awaitable[None]],
        stop: Stop | None = None,
    ) -> T | None:
        """Return the result; None if the tab has sent a newer request or has disconnected.

        Args:
            tab: identifier of the tab.
            number: number of the request; a larger number is newer.
            work: function that runs in the worker thread.
            gone: coroutine that returns when the client has disconnected.
            stop: stops a draft when the tab sends a final request or disconnects; None for a final request.

        Raises:
            Exception: any exception that the work raises.
        """
        if number < self._newest.get(tab, number):
            return None
        self._remember(tab, number)
        entry: _Entry[T] = _Entry(tab, work, stop, asyncio.get_running_loop().create_future())
        older, self._waiting[tab] = self._waiting.get(tab), entry  # type: ignore[assignment]
        if older is not None:
            _settle(older, None)
        running = self._running
        if stop is None and running is not None and running.tab == tab and running.stop is not None:
            running.stop.ask()
            _settle(running, None)
        self._next()
        leaving = asyncio.ensure_future(gone())
        try:
            watched: list[asyncio.Future[Any]] = [entry.done, leaving]
            await asyncio.wait(watched, return_when=asyncio.FIRST_COMPLETED)
            if not entry.done.done():
                return None
            failure = entry.done.exception()
            if number < self._newest.get(tab, number):
                return None
            if failure is not None:
                raise failure
            return entry.done.result()
        finally:
            leaving.cancel()
            entry.done.cancel()
            if stop is not None:
                stop.ask()
            if self._waiting.get(tab) is entry:
                del self._waiting[tab]

    def close(self) -> None:
        """Stop accepting work; a running task is finished."""
        for entry in self._waiting.values():
            _settle(entry, None)
        self._waiting.clear()
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _remember(self, tab: str, number: int) -> None:
        self._newest[tab] = number
        self._newest.move_to_end(tab)
        while len(self._newest) > _TABS:
            self._newest.popitem(last=False)

    def _next(self) -> None:
        if self._running is not None or not self._waiting:
            return
        _, entry = self._waiting.popitem(last=False)
        self._running = entry
        running = asyncio.get_running_loop().run_in_executor(self._thread, entry.work)
        running.add_done_callback(lambda ended: self._end(entry, ended))

    def _end(self, entry: _Entry[object], ended: "asyncio.Future[object]") -> None:
        self._running = None
        _settle(entry, ended)
        self._next()


def _settle(entry: _Entry[object], ended: "asyncio.Future[object] | None") -> None:
    """Pass the result to the request, if it is still waiting."""
    failure = None if ended is None else ended.exception()
    if entry.done.done():
        return
    if failure is not None:
        entry.done.set_exception(failure)
    else:
        entry.done.set_result(None if ended is None else ended.result())
