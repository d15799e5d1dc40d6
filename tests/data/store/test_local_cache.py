import errno
import multiprocessing
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from normalgan.data.store.local_cache import BUCKETS, LocalCache
from normalgan.errors import InputError, RunError

ROOM = 10_000  # bytes a bucket


def content(key: str) -> bytes:
    """The bytes of an object: up to a third of a bucket."""
    rng = random.Random(key)
    return rng.randbytes(rng.randint(1, ROOM // 3))


def used(folder: Path) -> int:
    total = 0
    for path in folder.rglob("*"):
        try:
            total += path.stat().st_size if path.is_file() else 0
        except FileNotFoundError:
            continue
    return total


def never() -> bytes:
    raise AssertionError("it was fetched again")


def test_what_was_fetched_once_is_read_from_disk_in_parts_too(tmp_path: Path) -> None:
    cache = LocalCache(str(tmp_path / "deep" / "cache"), 16 * ROOM)
    whole = content("a")
    for start, stop in [(None, None), (5, 9), (-7, None), (3, None), (None, -2), (10**6, None)]:
        fetched = LocalCache(str(tmp_path / f"{start} {stop}"), 16 * ROOM)
        assert fetched.read("a", lambda: whole, start, stop) == whole[start:stop]
        cache.read("a", lambda: whole)
        assert cache.read("a", never, start, stop) == whole[start:stop]
    cache.forget("a")
    cache.forget("a")
    assert cache.read("a", lambda: b"other") == b"other"


def test_what_cannot_be_fetched_is_not_kept(tmp_path: Path) -> None:
    cache = LocalCache(str(tmp_path), 16 * ROOM)

    def fail() -> bytes:
        raise ValueError("no line")

    for _ in range(2):
        with pytest.raises(ValueError, match="no line"):
            cache.read("a", fail)
    assert cache.read("a", lambda: b"x") == b"x"


def test_it_never_grows_beyond_its_size_and_the_longest_unused_goes(tmp_path: Path) -> None:
    cache = LocalCache(str(tmp_path), BUCKETS * ROOM)
    most, sizes = 0, {}
    for number in range(600):
        key = f"object {number}"
        assert cache.read(key, lambda key=key: content(key)) == content(key)  # type: ignore[misc]
        bucket = cache._path(key).parent
        sizes[bucket] = used(bucket)
        most = max(most, sum(sizes.values()))
    assert used(tmp_path) == sum(sizes.values())  # no read changed another bucket
    assert 0.7 * BUCKETS * ROOM < most <= BUCKETS * ROOM
    for bucket in tmp_path.iterdir():
        assert used(bucket) <= ROOM
    for number in range(597, 600):
        assert cache.read(f"object {number}", never) == content(f"object {number}")
    old = [path for path in tmp_path.rglob("*") if path.is_file() and path.stat().st_size]
    for age, path in enumerate(old):
        os.utime(path, (10**9 + age, 10**9 + age))
    keys = {cache._path(f"object {number}"): f"object {number}" for number in range(600)}
    bucket = old[0].parent
    there = sorted((path for path in old if path.parent == bucket), key=lambda path: path.stat().st_mtime)
    cache.read(keys[there[0]], never)  # the oldest is used, and so saved from what comes
    new = next(k for k in map(str, range(10_000)) if cache._path(k).parent == bucket)
    free = ROOM - used(bucket)
    cache.read(new, lambda: b"x" * (free + 1))  # one byte more than fits
    assert there[0].exists()
    assert not there[1].exists()
    assert all(path.exists() for path in there[2:])


def test_an_object_too_large_says_what_size_it_takes(tmp_path: Path) -> None:
    cache = LocalCache(str(tmp_path), BUCKETS * ROOM)
    with pytest.raises(
        InputError,
        match=f"size is {BUCKETS * ROOM} bytes; .* {ROOM + 1} bytes it must be {(ROOM + 1) * 16} or",
    ):
        cache.read("a", lambda: b"x" * (ROOM + 1))
    assert LocalCache(str(tmp_path), (ROOM + 1) * 16).read("a", lambda: b"x" * (ROOM + 1))


@pytest.mark.parametrize("size", [0, -3])
def test_a_cache_without_room_is_refused(size: int) -> None:
    with pytest.raises(InputError, match=f"^size of LocalCache is {size}; it must be 1 or more"):
        LocalCache("x", size)


def test_a_full_disk_and_a_file_in_the_way_are_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(
        InputError, match=r"^cannot write to the local cache .*/file: .*; make room there or name"
    ):
        LocalCache(str(tmp_path / "file")).read("a", lambda: b"x")

    def full(self: Path, data: bytes) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(RunError, match="No space left on device"):
        LocalCache(str(tmp_path / "cache")).read("a", lambda: b"x")
    assert used(tmp_path / "cache") == 0


def test_it_is_read_from_a_disk_that_cannot_be_written_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache = LocalCache(str(tmp_path))
    cache.read("a", lambda: b"x")
    os.utime(cache._path("a"), (0, 0))

    def refuse(*_: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(os, "utime", refuse)
    assert cache.read("a", never) == b"x"


def use(folder: str, seed: int) -> None:
    cache = LocalCache(folder, BUCKETS * ROOM)
    rng = random.Random(seed)
    for _ in range(300):
        key = f"object {rng.randrange(200)}"
        assert cache.read(key, lambda key=key: content(key)) == content(key)  # type: ignore[misc]


def test_processes_share_it(tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    processes = [context.Process(target=use, args=(str(tmp_path), seed)) for seed in range(3)]
    for process in processes:
        process.start()
    most = 0
    while any(process.is_alive() for process in processes):
        most = max(most, used(tmp_path))
        time.sleep(0.005)
    most = max(most, used(tmp_path))
    assert [process.exitcode for process in processes] == [0, 0, 0]
    assert 0.3 * BUCKETS * ROOM < most <= BUCKETS * ROOM


KILLED = """
import os, signal, sys
from pathlib import Path
from normalgan.data.store.local_cache import LocalCache
def write_half(self, data):
    with self.open("wb") as file:
        file.write(data[: len(data) // 2])
    os.kill(os.getpid(), signal.SIGKILL)
Path.write_bytes = write_half
LocalCache(sys.argv[1], 160_000).read(sys.argv[2], lambda: b"x" * 9000)
"""


def test_a_killed_writer_leaves_no_lock_no_half_object_and_in_the_end_no_bytes(tmp_path: Path) -> None:
    cache = LocalCache(str(tmp_path), BUCKETS * ROOM)
    done = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path), "a"], check=False)
    assert done.returncode == -signal.SIGKILL
    assert used(tmp_path) == 4500
    assert not cache._path("a").exists()
    other = next(k for k in map(str, range(10_000)) if cache._path(k).parent == cache._path("a").parent)
    cache.read(other, lambda: b"y")
    assert used(tmp_path) == 1
    assert cache.read("a", lambda: b"x" * 9000) == b"x" * 9000
