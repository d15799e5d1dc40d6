import contextlib
import socket
import time
import urllib.request
import warnings
from pathlib import Path

import fsspec  # type: ignore[import-untyped]
import pytest
from torch.utils.data import DataLoader, Subset
from toys import Octahedron, assert_same, contents, recipe

from normalgan.data.dataset import SampleDataset
from normalgan.data.render import open_samples, render_samples
from normalgan.data.store import fsspec_storage
from normalgan.data.store.fsspec_storage import ObjectFolder, options
from normalgan.errors import InputError
from s3_server import download, forget

# Tests that change the credentials drop file systems, whose connections close when the garbage is collected.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

SOURCES = {"train": [Octahedron("a"), Octahedron("b", 0.3)], "test": [Octahedron("c", 0.8)]}
VIEWS = 18  # 36 samples to train on are two shards, 18 to test on are one


def render(cache: str, cluster: str | None = None, **settings: object) -> None:
    render_samples(cache, SOURCES, VIEWS, recipe(), progress=False, cluster=cluster, **settings)  # type: ignore[arg-type]


@pytest.mark.slow
def test_the_store_holds_the_same_bytes_and_is_read_from_every_process(bucket: str, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        render(f"{bucket}/deep/cache")
    render(str(tmp_path / "disk"))
    assert contents(download(f"{bucket}/deep/cache", tmp_path / "copy")) == contents(tmp_path / "disk")
    near = open_samples(str(tmp_path / "disk"), SOURCES, VIEWS, recipe())["train"]
    far = open_samples(f"{bucket}/deep/cache", SOURCES, VIEWS, recipe())["train"]
    for index in (0, 17, 35):
        assert_same(far.read(index), near.read(index))
    whole, piecemeal = SampleDataset(near), SampleDataset(far, memory=0)
    some = [0, 1, 17, 31, 32, 35]  # of both shards
    for workers in (0, 2):  # forked: what this process has opened must not be used there
        loader = DataLoader(Subset(piecemeal, some), batch_size=3, num_workers=workers)
        batches = list(loader)
        assert [name for batch in batches for name in batch["name"]] == [near.name(i) for i in some]
        assert (batches[1]["normal"][2] == whole[35]["normal"]).all()


@pytest.mark.slow
def test_a_cluster_renders_into_it(bucket: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1]), prepend=":")
    render(f"{bucket}/cache", cluster="local:2")
    render(str(tmp_path / "disk"))
    assert contents(download(f"{bucket}/cache", tmp_path / "copy")) == contents(tmp_path / "disk")


@pytest.mark.slow
def test_lost_and_damaged_objects_are_found(bucket: str) -> None:
    render(bucket)
    store = open_samples(bucket, SOURCES, VIEWS, recipe())["train"]
    folder = ObjectFolder(store.url) / "samples.zarr"
    path = "train/sketch/c/1/0/0"
    whole = folder.read(path) or b""
    folder.delete(path)
    with pytest.raises(InputError, match=r"shard 1 of train in s3://.* is unfinished or damaged"):
        open_samples(bucket, SOURCES, VIEWS, recipe())["train"].read(35)
    with pytest.warns(UserWarning, match="damaged, and rendered again: shard 1 of train"):
        render(bucket)
    assert folder.read(path) == whole
    folder.write(path, whole[:9] + bytes([whole[9] ^ 1]) + whole[10:])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        render(bucket)  # names alone do not tell
    with pytest.warns(UserWarning, match="damaged, and rendered again: shard 1 of train"):
        render(bucket, thorough=True)
    assert folder.read(path) == whole


@pytest.mark.slow
def test_an_object_that_vanishes_there_is_not_read_as_zeros(bucket: str) -> None:
    render(bucket)
    store = open_samples(bucket, SOURCES, VIEWS, recipe())["train"]
    store.read(20)
    ObjectFolder(store.url).delete("samples.zarr/train/normal/c/0/0/0/0")
    with pytest.raises(InputError, match=r"shard 0 of train in s3://.* is unfinished or damaged"):
        store.read(21)


def test_a_writer_that_fails_leaves_the_old_object(bucket: str, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = ObjectFolder(bucket)
    folder.write("a", b"old" * 1000)
    files = fsspec.filesystem("s3", **options(bucket))
    monkeypatch.setattr(type(files), "_call_s3", _broken)
    with pytest.raises(
        InputError, match=r"cannot write the samples to s3://.*: the line went dead; free some space"
    ):
        folder.write("a", b"new" * 1000)
    monkeypatch.undo()


async def _broken(*_: object, **__: object) -> None:
    raise OSError("the line went dead")


@pytest.mark.slow
def test_objects_above_the_size_of_a_part_appear_whole(bucket: str) -> None:
    content = bytes(range(256)) * 4096 * 52  # 52 MiB: s3fs uploads it in parts
    ObjectFolder(bucket).write("deep/large", content)
    assert ObjectFolder(bucket).size("deep/large") == len(content)
    assert ObjectFolder(bucket).read("deep/large", -256) == bytes(range(256))
    assert ObjectFolder(bucket).names("deep") == {"large"}


def test_an_unknown_bucket_is_named(bucket: str) -> None:
    start = time.monotonic()
    with pytest.raises(
        InputError, match=r"^the bucket of s3://nowhere-at-all/x/\w+ does not exist; create it"
    ):
        render("s3://nowhere-at-all/x")
    assert time.monotonic() - start < 60  # by itself botocore would take minutes


def test_wrong_credentials_are_one_sentence(bucket: str, endpoint: str) -> None:
    def authentication(calls: bytes) -> None:
        plain = {"Content-Type": "text/plain"}
        request = urllib.request.Request(f"{endpoint}/moto-api/reset-auth", calls, plain)
        urllib.request.urlopen(request).close()

    authentication(b"0")
    try:
        with pytest.raises(InputError, match=r"^cannot read s3://.*: .*\(are the credentials right\?\)\.$"):
            render(bucket)
    finally:
        authentication(b"1000000000")


def test_missing_credentials_are_one_sentence(
    bucket: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(tmp_path / "none"))
    forget()
    with pytest.raises(InputError, match=r"^cannot read s3://.*: .*credentials\.$"):
        render(bucket)


@pytest.mark.slow
def test_an_endpoint_that_does_not_answer_is_one_sentence_in_time(
    bucket: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
    forget()
    start = time.monotonic()
    with pytest.raises(InputError, match=r"^cannot read s3://.*: Could not connect to the endpoint URL"):
        render(bucket)
    assert time.monotonic() - start < 60  # by itself botocore would take minutes


@pytest.mark.slow
def test_an_endpoint_that_accepts_and_never_answers_is_given_up(
    bucket: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fsspec_storage, "_SECONDS", 1)  # in place of 10
    with socket.create_server(("127.0.0.1", 0), backlog=64) as silent:
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{silent.getsockname()[1]}")
        forget()
        silent.setblocking(False)
        with pytest.raises(InputError, match=r"^cannot read s3://.*: .*[Tt]imeout"):
            render(bucket)
        requests = 0
        with contextlib.suppress(BlockingIOError):
            while True:
                silent.accept()[0].close()
                requests += 1
    assert 1 < requests <= 12  # three attempts, twice, and that twice


def test_the_limits_are_the_users_to_change(monkeypatch: pytest.MonkeyPatch) -> None:
    assert options("s3://b")["config_kwargs"]["retries"] == {"total_max_attempts": 3, "mode": "standard"}
    monkeypatch.setenv("AWS_MAX_ATTEMPTS", "9")
    assert "retries" not in options("s3://b")["config_kwargs"]
    monkeypatch.setitem(fsspec.config.conf, "s3", {"config_kwargs": {"connect_timeout": 99}})
    assert "config_kwargs" not in options("s3://b")
