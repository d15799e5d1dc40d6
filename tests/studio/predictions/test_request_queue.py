import asyncio
from collections.abc import Awaitable, Callable
from threading import Event

import pytest

from normalgan.studio.predictions.request_queue import GivenUpError, RequestQueue, Stop


async def never() -> None:
    await asyncio.Event().wait()


class Work:
    """Something that takes as long as the test wants."""

    def __init__(self, result: str, failure: Exception | None = None) -> None:
        self.begun, self.finish, self.result, self.failure = Event(), Event(), result, failure

    def __call__(self) -> str:
        self.begun.set()
        assert self.finish.wait(60)
        if self.failure:
            raise self.failure
        return self.result


class Draft(Work):
    """Work that asks between its two steps whether it is to end."""

    def __init__(self, result: str) -> None:
        super().__init__(result)
        self.stop, self.second = Stop(), Event()

    def __call__(self) -> str:
        super().__call__()
        self.stop.check()
        self.second.set()
        return self.result


async def until(event: Event) -> None:
    while not event.is_set():
        await asyncio.sleep(0.001)


def ask(
    queue: RequestQueue,
    tab: str,
    number: int,
    work: Callable[[], str],
    gone: Callable[[], Awaitable[None]] = never,
) -> "asyncio.Task[str | None]":
    stop = work.stop if isinstance(work, Draft) else None
    return asyncio.ensure_future(queue.do(tab, number, work, gone, stop))


def test_the_newest_of_a_tab_wins() -> None:
    async def play() -> None:
        queue = RequestQueue()
        running, skipped, newest, other = Work("1"), Work("2"), Work("3"), Work("other")
        tasks = [ask(queue, "a", 1, running)]
        await until(running.begun)
        tasks += [ask(queue, "a", 2, skipped), ask(queue, "b", 1, other)]
        await asyncio.sleep(0)
        tasks.append(ask(queue, "a", 3, newest))
        assert await tasks[1] is None  # at once, while the first is still being done
        for work in (running, newest, other):
            work.finish.set()
        # What is done for nothing is not answered, and a tab keeps its place.
        assert await asyncio.gather(*tasks) == [None, None, "other", "3"]
        assert not skipped.begun.is_set()
        assert await queue.do("a", 2, skipped, never) is None
        assert await queue.do("a", 3, lambda: "again", never) == "again"

    asyncio.run(play())


def test_who_has_gone_is_not_worked_for() -> None:
    async def play() -> None:
        queue = RequestQueue()
        running, dropped = Work("1"), Work("2")
        first = ask(queue, "a", 1, running)
        await until(running.begun)
        leave = asyncio.Event()

        async def gone() -> None:
            await leave.wait()

        second = ask(queue, "b", 1, dropped, gone)
        await asyncio.sleep(0)
        leave.set()
        assert await second is None
        running.finish.set()
        assert await first == "1"
        assert await queue.do("c", 1, lambda: "next", never) == "next"
        assert not dropped.begun.is_set()

    asyncio.run(play())


def test_who_goes_while_it_is_done_harms_nobody() -> None:
    async def play() -> None:
        queue = RequestQueue()
        running = Work("1", ValueError("nobody hears this"))
        leave = asyncio.Event()

        async def gone() -> None:
            await leave.wait()

        first = ask(queue, "a", 1, running, gone)
        await until(running.begun)
        leave.set()
        assert await first is None
        running.finish.set()
        assert await queue.do("b", 1, lambda: "next", never) == "next"

    asyncio.run(play())


def test_a_failure_goes_to_the_one_who_asked() -> None:
    async def play() -> None:
        queue = RequestQueue()
        failing, late = Work("", ValueError("no line")), Work("", ValueError("of an old one"))
        failing.finish.set()
        with pytest.raises(ValueError, match="no line"):
            await queue.do("a", 1, failing, never)
        old = ask(queue, "a", 2, late)
        await until(late.begun)
        new = ask(queue, "a", 3, lambda: "new")
        await asyncio.sleep(0)
        late.finish.set()
        assert [await old, await new] == [None, "new"]

    asyncio.run(play())


def test_what_waits_is_let_go_when_it_closes() -> None:
    async def play() -> None:
        queue = RequestQueue()
        running, waiting = Work("1"), Work("2")
        tasks = [ask(queue, "a", 1, running), ask(queue, "b", 1, waiting)]
        await until(running.begun)
        queue.close()
        assert await tasks[1] is None
        running.finish.set()
        assert await tasks[0] == "1"
        assert not waiting.begun.is_set()

    asyncio.run(play())


def test_a_draft_is_given_up_for_what_is_none() -> None:
    async def play() -> None:
        queue = RequestQueue()
        draft = Draft("draft")
        first = ask(queue, "a", 1, draft)
        await until(draft.begun)
        second = ask(queue, "a", 2, lambda: "whole")
        assert await first is None  # at once, while its first step is still being done
        draft.finish.set()
        assert await second == "whole"
        assert not draft.second.is_set()

    asyncio.run(play())


def test_a_draft_is_finished_for_drafts_and_for_other_tabs_and_what_is_none_is_always() -> None:
    async def play() -> None:
        queue = RequestQueue()
        draft, newer, whole, last = Draft("draft"), Draft("newer"), Work("whole"), Work("last")
        tasks = [ask(queue, "a", 1, draft)]
        await until(draft.begun)
        tasks += [ask(queue, "b", 1, whole), ask(queue, "a", 2, newer)]
        await asyncio.sleep(0)
        draft.finish.set()
        await until(whole.begun)
        assert draft.second.is_set()
        tasks.append(ask(queue, "b", 2, last))
        await asyncio.sleep(0)
        for work in (whole, newer, last):
            work.finish.set()
        # A running one that something newer overtook is not answered, but done: its map is remembered.
        assert await asyncio.gather(*tasks) == [None, None, "newer", "last"]

    asyncio.run(play())


def test_a_draft_is_given_up_for_who_has_gone() -> None:
    async def play() -> None:
        queue = RequestQueue()
        draft, leave = Draft("draft"), asyncio.Event()

        async def gone() -> None:
            await leave.wait()

        first = ask(queue, "a", 1, draft, gone)
        await until(draft.begun)
        leave.set()
        assert await first is None
        draft.finish.set()
        assert await queue.do("b", 1, lambda: "next", never) == "next"
        assert not draft.second.is_set()

    asyncio.run(play())


def test_work_ends_where_it_asks() -> None:
    stop = Stop()
    stop.check()
    stop.ask()
    with pytest.raises(GivenUpError):
        stop.check()
