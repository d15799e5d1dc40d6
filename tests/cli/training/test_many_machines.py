"""Rendering on a cluster and training from a distant store, as commands."""

from pathlib import Path

import pytest
from command import Bench

from normalgan.data.jobs import cluster
from s3_server import fresh_bucket, s3_server


@pytest.mark.slow  # starts processes that render
def test_render_takes_a_cluster(bench: Bench, tmp_path: Path) -> None:
    alone = bench.run("render", tmp_path, "--data.cache", tmp_path / "alone")
    assert alone.code == 0, alone.err
    done = bench.run("render", tmp_path, "--data.cache", tmp_path / "many", "--cluster", "local:2")
    assert done.code == 0, done.err
    assert "distributed" not in done.err
    contents = [
        {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
        for folder in (tmp_path / "alone", tmp_path / "many")
    ]
    assert contents[0] == contents[1]
    assert len(contents[0]) > 10


@pytest.mark.slow
def test_a_cluster_that_cannot_be_had_is_one_sentence(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_TIMEOUT", 1.0)
    bench.run("render", tmp_path, "--cluster", "tcp://127.0.0.1:9").refused(
        "no scheduler answers at tcp://127"
    )
    bench.run("render", tmp_path, "--cluster", "nowhere").refused("'nowhere' names no cluster; give tcp://")


@pytest.mark.slow  # of its parts, test_s3.py and test_stream.py
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # see test_s3.py
def test_training_streams_from_s3(bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with s3_server() as endpoint:
        bucket = fresh_bucket(endpoint, monkeypatch)
        settings = ("--data.cache", bucket, "--data.storage.memory", 0)
        trained = bench.run("fit", tmp_path / "run", *settings, "--trainer.max_epochs", 1)
        assert trained.code == 0, trained.err
