import time
from pathlib import Path

import pytest
from dask_processes import SOURCES, VIEWS, render, start_cluster
from toys import recipe

from normalgan.data.jobs import cluster
from normalgan.data.render import render_samples
from normalgan.errors import InputError, RunError


def test_no_scheduler_is_one_sentence_in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cluster._TIMEOUT == 10
    monkeypatch.setattr(cluster, "_TIMEOUT", 1.0)
    start = time.monotonic()
    with pytest.raises(InputError, match=r"^no scheduler answers at tcp://127\.0\.0\.1:9 within 1 seconds"):
        render(tmp_path, "tcp://127.0.0.1:9")
    assert time.monotonic() - start < 25  # by itself Dask would wait for 30
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_cluster_without_workers_is_given_up_in_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_NO_WORKER_TIMEOUT", 0.5)
    with (
        start_cluster(tmp_path / "dask") as alone,
        pytest.raises(RunError, match=r"no worker at .*scheduler\.json for 0 seconds; .* start workers"),
    ):
        render(tmp_path / "cache", alone.address)


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ("localhost", r"^'localhost' names no cluster; give tcp://host:port, "),
        ("local:0", "^the cluster local:0 has no worker; local:2 has two"),
        ("local:two", "names no cluster"),
        ("/nowhere/scheduler.json", "^there is no scheduler file /nowhere/scheduler.json"),
    ],
)
def test_a_name_that_is_no_cluster_is_refused(tmp_path: Path, where: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        render(tmp_path, where)


def test_memory_is_not_shared_with_a_cluster() -> None:
    with pytest.raises(InputError, match="memory://x is invisible to other processes"):
        render_samples("memory://x", SOURCES, VIEWS, recipe(), progress=False, cluster="local:1")
