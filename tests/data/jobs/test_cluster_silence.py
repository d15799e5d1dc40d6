"""A cluster that says nothing: the user is told what is waited for."""

import time
from collections.abc import Callable
from threading import Timer
from typing import Any

import pytest

from normalgan.data.jobs import cluster
from normalgan.data.jobs.cluster import Cluster
from normalgan.data.jobs.cluster_worker import worker_versions

WORKER = "tcp://10.0.0.1:4000"


class SlowFuture:
    """A task that ends after a while."""

    status = "finished"

    def __init__(self, key: str, seconds: float) -> None:
        self.key = key
        self.seconds = seconds

    def add_done_callback(self, call: Callable[["SlowFuture"], None]) -> None:
        Timer(self.seconds, call, [self]).start()

    def result(self) -> str:
        return "done"


class SilentClient:
    """A client of a cluster whose one worker is paused, or whose scheduler takes its time."""

    status = "running"

    def __init__(self, task: float = 0.0, answer: float = 0.0) -> None:
        self.task = task
        self.answer = answer

    def scheduler_info(self, n_workers: int) -> dict[str, Any]:
        time.sleep(self.answer)
        return {"workers": {WORKER: {"nthreads": 1, "status": "paused"}}}

    def run(self, *_: object, workers: list[str], **__: object) -> dict[str, Any]:
        return dict.fromkeys(workers, worker_versions())

    def submit(self, *_: object, key: str, **__: object) -> SlowFuture:
        return SlowFuture(key, self.task)

    def cancel(self, *_: object, **__: object) -> None:
        pass


def waited_for(
    monkeypatch: pytest.MonkeyPatch, client: SilentClient, silence: float = 0.2
) -> list[tuple[int, Any]]:
    monkeypatch.setattr(cluster, "_SILENCE", silence)
    monkeypatch.setattr(cluster, "_LOOK", 0.05)
    pool = Cluster("tcp://cluster:8786")
    pool._client = client
    pool._look()
    return list(pool.run(hash, [7]))


def test_a_worker_out_of_memory_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    told = rf"no result from tcp://cluster:8786 for 0 seconds; waiting for 1 tasks on 1 .*, of which {WORKER}"
    with pytest.warns(UserWarning, match=told):
        assert waited_for(monkeypatch, SilentClient(task=2.0)) == [(7, "done")]


def test_a_scheduler_that_does_not_answer_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    told = "the scheduler at tcp://cluster:8786 has not answered for 0 seconds; waiting for it"
    with pytest.warns(UserWarning, match=told):
        assert waited_for(monkeypatch, SilentClient(answer=1.0)) == [(7, "done")]


def test_a_cluster_that_answers_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    assert waited_for(monkeypatch, SilentClient(), silence=600) == [(7, "done")]
