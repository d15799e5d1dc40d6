import time
from pathlib import Path

import pytest
from dask_processes import render
from toys import contents

from normalgan.data.jobs import cluster_address
from normalgan.errors import InputError, RunError


def test_no_scheduler_is_one_sentence_in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cluster_address.TIMEOUT == 10
    monkeypatch.setattr(cluster_address, "TIMEOUT", 1.0)
    start = time.monotonic()
    with pytest.raises(InputError, match=r"^no scheduler answers at tcp://127\.0\.0\.1:9 within 1 seconds"):
        render(tmp_path, "tcp://127.0.0.1:9")
    assert time.monotonic() - start < 25  # by itself Dask would wait for 30
    assert list(tmp_path.iterdir()) == []


YAML = """
class_path: distributed.LocalCluster
init_args: {n_workers: 0, threads_per_worker: 1, dashboard_address: ":0", processes: false}
"""


def test_a_cluster_class_can_be_named_and_scaled(tmp_path: Path) -> None:
    file = tmp_path / "threads.yaml"
    file.write_text(YAML + "scale: {n: 1}\n")
    assert contents(render(tmp_path / "0", str(file))) == contents(render(tmp_path / "1"))


def test_a_cluster_without_workers_is_given_up_in_time(tmp_path: Path) -> None:
    file = tmp_path / "none.yml"
    file.write_text(YAML + "patience: 0.5\n")
    with pytest.raises(
        RunError, match=r"^there has been no worker at .*none\.yml for 0 seconds; .* start workers"
    ):
        render(tmp_path / "cache", str(file))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            "class_path: distributed.LocalCluster\nworkers: 3\n",
            "may hold init_args, scale, adapt and patience",
        ),
        ("- 3\n", "must hold class_path"),
        ("a: [", "cannot be read: "),
        (
            "class_path: distributed.NoSuchCluster\n",
            r"distributed\.NoSuchCluster in the cluster file .* cannot be imported",
        ),
        ("class_path: nosuch.Cluster\n", r"nosuch\.Cluster in the cluster file .* cannot be imported"),
        ("class_path: Cluster\n", "Cluster in the cluster file .* cannot be imported"),
        (
            "class_path: subprocess.Popen\n",
            r"subprocess\.Popen in the cluster file .* is no class of Dask clusters",
        ),
        (
            "class_path: distributed.LocalCluster\n"
            "init_args: {processes: false, dashboard_address: null, wings: 3}\n",
            "cannot be started: ",
        ),
    ],
)
def test_a_cluster_file_that_makes_no_sense_is_refused(tmp_path: Path, content: str, message: str) -> None:
    file = tmp_path / "cluster.yaml"
    file.write_text(content)
    with pytest.raises(InputError, match=message):
        render(tmp_path / "cache", str(file))


def test_any_package_has_classes_of_clusters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "nearby.py").write_text(
        "from distributed import LocalCluster\n\nclass Nearby(LocalCluster):\n    pass\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    file = tmp_path / "own.yaml"
    file.write_text(YAML.replace("distributed.LocalCluster", "nearby.Nearby") + "patience: 0.5\n")
    with pytest.raises(RunError, match="there has been no worker"):
        render(tmp_path / "cache", str(file))


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ("localhost", r"^'localhost' names no cluster; give tcp://host:port, "),
        ("local:0", "^the cluster local:0 has no worker; local:2 has two"),
        ("local:two", "names no cluster"),
        ("/nowhere/scheduler.json", "^there is no scheduler file /nowhere/scheduler.json"),
        ("/nowhere/cluster.yaml", "^the cluster file /nowhere/cluster.yaml cannot be read: .*No such file"),
    ],
)
def test_a_name_that_is_no_cluster_is_refused(tmp_path: Path, where: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        render(tmp_path, where)
