import os
import pickle
import uuid
from pathlib import Path

import numpy as np
import pytest
import zarr
from toys import assert_same, contents, samples

from normalgan.data.store.fsspec_storage import ObjectFolder
from normalgan.data.store.sample_layout import Layout, chunk_path
from normalgan.data.store.shards import ShardedSamples, write_shard
from normalgan.errors import InputError
from normalgan.rendering.samples import Sample

LAYOUT = Layout(("a", "b"), views=5, size=16, per_shard=4)  # shards of 4, 4 and 2
SAMPLES = samples(10)


def write(store: ShardedSamples, shard: int, given: list[Sample]) -> None:
    write_shard(ObjectFolder(store.url), store.layout.shard(store.split, shard), given)


def fill(url: str, shards: tuple[int, ...] = (0, 1, 2)) -> ShardedSamples:
    store = ShardedSamples(url, "train", LAYOUT)
    store.create()
    for shard in shards:
        write(store, shard, [SAMPLES[i] for i in LAYOUT.indices(shard)])
    return store


def chunk(folder: Path, name: str, shard: int) -> Path:
    return (
        folder / "samples.zarr" / "train" / name / "c" / str(shard) / "0" / "0" / ("0" * (name == "normal"))
    )


@pytest.mark.parametrize("scheme", ["path", "file", "memory"])
def test_samples_are_written_and_read_on_any_file_system(tmp_path: Path, scheme: str) -> None:
    url = {"path": str(tmp_path), "file": tmp_path.as_uri(), "memory": f"memory://{uuid.uuid4()}/deep"}[
        scheme
    ]
    store = fill(url)
    assert store.missing() == store.verify() == []
    for reader in (store, ShardedSamples(url, "train", LAYOUT), pickle.loads(pickle.dumps(store))):
        for index, sample in enumerate(SAMPLES):
            assert_same(reader.read(index), sample)
    stacked = store.read_shard(2)
    np.testing.assert_array_equal(stacked["normal"], np.stack([s.normal for s in SAMPLES[8:]]))


def test_any_zarr_reader_opens_the_arrays(tmp_path: Path) -> None:
    fill(str(tmp_path))
    group = zarr.open_group(str(tmp_path / "samples.zarr"), mode="r")
    normal = group["train/normal"]
    assert isinstance(normal, zarr.Array)
    assert (normal.shape, normal.chunks, normal.shards) == ((10, 16, 16, 3), (1, 16, 16, 3), (4, 16, 16, 3))
    np.testing.assert_array_equal(normal[3], SAMPLES[3].normal)
    codecs = str(normal.metadata.to_dict()["codecs"])
    assert "zstd" in codecs
    assert codecs.count("crc32c") == 2  # of every sample, and of the index of the shard


def test_names_follow_the_layout() -> None:
    store = ShardedSamples("memory://nothing", "train", LAYOUT)
    assert [store.name(i) for i in (0, 4, 5, 9)] == ["a/0", "a/4", "b/0", "b/4"]
    assert LAYOUT.shard("train", 0).meshes == ("a",)
    assert LAYOUT.shard("train", 1).meshes == ("a", "b")
    assert len(store) == 10
    assert LAYOUT.shards == 3


def test_an_unfinished_shard_is_missing_and_not_read_as_zeros(tmp_path: Path) -> None:
    store = fill(str(tmp_path), shards=(0, 2))
    assert store.missing() == [1]
    assert store.verify() == []
    with pytest.raises(
        InputError, match=r"shard 1 of train in .* is unfinished or damaged; render the data set again"
    ):
        store.read(5)
    with pytest.raises(IndexError):
        store.read(10)


@pytest.mark.parametrize("name", ["sketch", "normal", "mask"])
@pytest.mark.parametrize("damage", ["bit at start", "bit in the middle", "bit at end", "cut", "gone"])
def test_damage_is_found_in_exactly_the_shard_it_is_in(tmp_path: Path, name: str, damage: str) -> None:
    store = fill(str(tmp_path))
    before = contents(tmp_path)
    path = chunk(tmp_path, name, 1)
    content = bytearray(path.read_bytes())
    if damage == "gone":
        path.unlink()
    else:
        place = {"bit at start": 0, "bit in the middle": len(content) // 2, "bit at end": -1, "cut": -1}[
            damage
        ]
        content[place] ^= 16
        path.write_bytes(content[:-9] if damage == "cut" else content)
    assert store.verify() == [1]
    assert_same(store.read(3), SAMPLES[3])
    assert_same(store.read(8), SAMPLES[8])
    with pytest.raises(InputError, match="shard 1 of train"):
        store.read_shard(1)
    write(store, 1, SAMPLES[4:8])
    assert store.verify() == []
    assert contents(tmp_path) == before


@pytest.mark.parametrize("scheme", ["path", "memory"])
@pytest.mark.parametrize("name", ["sketch", "normal", "mask"])
def test_a_chunk_that_vanishes_after_its_shard_was_read_is_not_read_as_zeros(
    tmp_path: Path, scheme: str, name: str
) -> None:
    url = str(tmp_path) if scheme == "path" else f"memory://{uuid.uuid4()}"
    store = fill(url)
    assert_same(store.read(5), SAMPLES[5])
    ObjectFolder(url).delete(f"samples.zarr/{chunk_path('train', name, 1)}")
    for read in (lambda: store.read(6), lambda: store.read_shard(1)):
        with pytest.raises(InputError, match=r"^shard 1 of train in .* is unfinished or damaged; render"):
            read()
    assert_same(store.read(3), SAMPLES[3])


@pytest.mark.parametrize("text", [b"", b"{", b"[]", b"{}", b"null"])
def test_a_damaged_marker_vouches_for_nothing(tmp_path: Path, text: bytes) -> None:
    store = fill(str(tmp_path))
    (tmp_path / "done/train/2.json").write_bytes(text)
    assert store.verify() == [2]


def test_a_shard_is_marked_only_after_all_of_it_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = fill(str(tmp_path))
    written: list[str] = []

    def note(self: ObjectFolder, path: str, content: bytes) -> None:
        assert store.missing() == [0]  # also when it was finished before
        written.append(path)

    monkeypatch.setattr(ObjectFolder, "write", note)
    write(store, 0, SAMPLES[:4])
    assert written[-1] == "done/train/0.json"
    assert len(written) == 4


def test_wrong_number_or_size_of_samples_is_refused(tmp_path: Path) -> None:
    store = fill(str(tmp_path), shards=())
    with pytest.raises(ValueError, match="shard 0"):
        write(store, 0, SAMPLES[:3])
    with pytest.raises(ValueError, match="shard 0"):
        write(store, 0, samples(4, size=8))
    assert store.missing() == [0, 1, 2]


def test_an_empty_picture_is_stored_like_any_other(tmp_path: Path) -> None:
    store = ShardedSamples(str(tmp_path), "train", Layout(("a",), 1, 16))
    store.create()
    empty = Sample(
        np.zeros_like(SAMPLES[0].sketch), np.zeros_like(SAMPLES[0].normal), np.zeros_like(SAMPLES[0].mask)
    )
    write(store, 0, [empty])
    assert_same(store.read(0), empty)
    assert store.verify() == []


def test_a_full_disk_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = fill(str(tmp_path), shards=(0,))

    def full(self: Path, content: bytes) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(
        InputError, match=r"^cannot write the samples to .*: No space left on device; free some space"
    ):
        write(store, 1, SAMPLES[4:8])
    monkeypatch.undo()
    assert store.missing() == [1, 2]
    assert_same(store.read(0), SAMPLES[0])
    assert list((tmp_path / ".partial").iterdir()) == []


def test_a_file_in_place_of_the_folder_is_said(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("")
    with pytest.raises(InputError, match=r"cannot write the samples to .*cache/x: Not a directory"):
        ShardedSamples(str(tmp_path / "cache" / "x"), "train", LAYOUT).create()


def test_an_unknown_scheme_is_said() -> None:
    with pytest.raises(
        InputError, match="no samples can be kept at nonsense://x: Protocol not known: nonsense"
    ):
        ObjectFolder("nonsense://x")


def test_old_leftovers_are_swept_away(tmp_path: Path) -> None:
    old, new = tmp_path / ".partial" / "old", tmp_path / ".partial" / "new"
    old.parent.mkdir()
    old.touch()
    new.touch()
    os.utime(old, (0, 0))
    ObjectFolder(str(tmp_path)).sweep()
    assert {*old.parent.iterdir()} == {new}
    ObjectFolder(str(tmp_path / "none")).sweep()
