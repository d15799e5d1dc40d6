"""Tests of several drawings at once."""

import gc
import threading
from collections.abc import Iterator

import pytest

from normalgan.inference.parallel import stream


def test_what_came_of_each_is_told_in_order() -> None:
    def work(job: int) -> int:
        if job == 2:
            raise ValueError(str(job))
        return job * 10

    told = list(stream(range(5), work))
    assert [job for job, _ in told] == [0, 1, 2, 3, 4]
    assert [each for _, each in told if not isinstance(each, Exception)] == [0, 10, 30, 40]
    assert isinstance(told[2][1], ValueError)


def test_one_that_is_left_is_collected_by_any_thread_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Collected by a thread that is about to start, it waited for that thread: the command stood still."""
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1}, raising=False)
    busy = threading.Event()

    def work(job: int) -> int:
        if job:
            assert busy.wait(60)
        return job

    def left() -> None:
        outcomes: Iterator[tuple[int, int | Exception]] = stream(range(9), work)
        assert next(outcomes) == (0, 0)
        holder: list[object] = [outcomes]
        holder.append(holder)  # as an exception holds the frames that it passed: the collector has to find it

    left()
    collector = threading.Thread(target=gc.collect, daemon=True)
    collector.start()
    collector.join(
        30
    )  # the first of its threads is still at work: to wait for it would be to wait for this test
    stood = collector.is_alive()
    busy.set()
    collector.join(60)
    assert not stood
