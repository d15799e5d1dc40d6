"""Samples in S3 over a bad line: they are whole, or one sentence says what is wrong and nothing is lost."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from toys import Octahedron, assert_same, contents, recipe

from faulty_proxy import KINDS, Faults, faulty_proxy
from normalgan.data.render import open_samples, render_samples
from normalgan.errors import InputError
from s3_server import download, forget

pytestmark = [
    pytest.mark.slow,  # s3fs waits before it tries again
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

SOURCES = {"train": [Octahedron("a"), Octahedron("b", 0.3)], "test": [Octahedron("c", 0.8)]}
VIEWS = 18


@pytest.fixture(name="faults")
def make_faults(endpoint: str, bucket: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[Faults]:
    """Faults of a proxy before the bucket, which everything in this process uses."""
    faults = Faults()
    with faulty_proxy(endpoint, faults) as address:
        monkeypatch.setenv("AWS_ENDPOINT_URL", address)
        forget()
        yield faults
    forget()


@pytest.fixture(scope="module", name="whole")
def render_nearby(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same samples on a disk."""
    folder = tmp_path_factory.mktemp("disk")
    render(str(folder))
    return folder


def render(cache: str) -> None:
    render_samples(cache, SOURCES, VIEWS, recipe(), progress=False)


@pytest.mark.parametrize("kind", KINDS)
def test_single_faults_are_not_noticed(
    bucket: str, faults: Faults, kind: str, whole: Path, tmp_path: Path
) -> None:
    faults.kind, faults.every = kind, 6
    render(f"{bucket}/cache")
    store = open_samples(f"{bucket}/cache", SOURCES, VIEWS, recipe())["train"]
    near = open_samples(str(whole), SOURCES, VIEWS, recipe())["train"]
    for index in (0, 17, 35):
        assert_same(store.read(index), near.read(index))
    assert faults.spoilt >= 3
    faults.every = 0
    assert contents(download(f"{bucket}/cache", tmp_path / "copy")) == contents(whole)


@pytest.mark.parametrize("kind", ["busy", "cut"])
def test_a_server_that_goes_away_while_samples_are_written_costs_one_sentence(
    bucket: str, faults: Faults, kind: str, whole: Path, tmp_path: Path
) -> None:
    faults.kind, faults.away_after = kind, 13  # amid the shards
    with pytest.raises(InputError, match=r"^cannot (read|write|remove) [^\n]*s3://[^\n]*\.$"):
        render(f"{bucket}/cache")
    assert faults.spoilt
    faults.away_after = None  # it is back: what was written serves, the rest is rendered
    render(f"{bucket}/cache")
    assert contents(download(f"{bucket}/cache", tmp_path / "copy")) == contents(whole)


@pytest.mark.parametrize("kind", ["busy", "cut"])
def test_a_server_that_goes_away_while_samples_are_read_gives_no_wrong_ones(
    bucket: str, faults: Faults, kind: str, whole: Path
) -> None:
    render(bucket)
    store = open_samples(bucket, SOURCES, VIEWS, recipe())["train"]
    near = open_samples(str(whole), SOURCES, VIEWS, recipe())["train"]
    assert_same(store.read(0), near.read(0))
    faults.kind, faults.away_after = kind, faults.seen
    with pytest.raises(InputError, match=r"^[^\n]*s3://[^\n]*\.$"):
        store.read(35)  # of another shard
    faults.away_after = None
    assert_same(store.read(35), near.read(35))
