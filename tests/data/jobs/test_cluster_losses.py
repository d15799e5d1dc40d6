"""Results that are lost on their way: the task is done again, and only then is somebody blamed."""

from typing import Any

import pytest

from normalgan.data.jobs import cluster
from normalgan.data.jobs.cluster import Cluster
from normalgan.data.jobs.cluster_worker import worker_versions
from normalgan.data.jobs.pool import Killed
from normalgan.errors import RunError

WORKER = "tcp://10.0.0.1:4000"


class EndedFuture:
    """A task that has ended in some way."""

    def __init__(self, key: str, status: str) -> None:
        self.key = key
        self.status = status

    def add_done_callback(self, call: Any) -> None:
        call(self)

    def result(self) -> str:
        return "done"


class LosingClient:
    """A client whose tasks end as is said, one after the other, and then well.

    Args:
        endings: of the tasks.
        looks: how often it is still connecting, when it is looked at after a task was cancelled.
        then: what it is afterwards.
    """

    def __init__(self, endings: list[str], looks: int = 0, then: str = "running") -> None:
        self.endings = endings
        self.submitted = self.cancelled = 0
        self.looks = looks
        self.then = then

    @property
    def status(self) -> str:
        if not self.cancelled:
            return "running"
        self.looks -= 1
        return "connecting" if self.looks >= 0 else self.then

    def scheduler_info(self, n_workers: int) -> dict[str, Any]:
        return {"workers": {WORKER: {"nthreads": 1, "status": "running"}}}

    def run(self, *_: object, workers: list[str], **__: object) -> dict[str, Any]:
        return dict.fromkeys(workers, worker_versions())

    def submit(self, *_: object, key: str, **__: object) -> EndedFuture:
        self.submitted += 1
        ending = self.endings.pop(0) if self.endings else "finished"
        self.cancelled += ending == "cancelled"
        return EndedFuture(key, ending)

    def cancel(self, *_: object, **__: object) -> None:
        pass


def run(client: LosingClient) -> list[tuple[int, Any]]:
    pool = Cluster("tcp://cluster:8786")
    pool._client = client
    pool._update_workers()
    return list(pool.run(hash, [7]))


@pytest.mark.parametrize("ending", ["lost", "pending", "cancelled"])
def test_a_task_with_a_lost_result_is_repeated(ending: str) -> None:
    # Dask calls it lost when the worker died that had it, and pending when another is making it again.
    client = LosingClient([ending])
    assert run(client) == [(7, "done")]
    assert client.submitted == 2


def test_a_task_whose_result_is_always_lost_is_killed() -> None:
    client = LosingClient(["lost"] * 100)
    assert run(client) == [(7, Killed())]
    assert client.submitted == 6


def test_a_restored_connection_costs_only_the_task() -> None:
    assert run(LosingClient(["cancelled"], looks=3)) == [(7, "done")]


def test_a_connection_that_stays_broken_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    told = "^the scheduler at tcp://cluster:8786 is gone"
    with pytest.raises(RunError, match=told):
        run(LosingClient(["cancelled"], looks=3, then="closed"))
    monkeypatch.setattr(cluster, "_TIMEOUT", 0.0)
    monkeypatch.setattr(cluster, "_CHECK_INTERVAL", 0.1)
    with pytest.raises(RunError, match=told):
        run(LosingClient(["cancelled"], looks=10**9))
