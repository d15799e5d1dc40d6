import os
import shutil
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from dask_processes import HERE, SOURCES, VIEWS, MoodyRenderer, finished, render
from toys import contents, recipe

from normalgan.data.render import open_samples, render_samples
from normalgan.errors import InputError
from normalgan.rendering import Camera, EmbreeRenderer, Maps, Mesh

MOODY = replace(recipe(), renderer=MoodyRenderer(fails_at="b"))


@pytest.mark.parametrize(
    "where", ["here", *(pytest.param(each, marks=pytest.mark.slow) for each in ("pool", "cluster"))]
)
def test_a_mesh_that_fails_only_when_rendered_fails_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(HERE), prepend=os.pathsep)
    mended = tmp_path / "mended"
    moody = replace(MOODY, renderer=MoodyRenderer(fails_at="b", mended=str(mended)))
    ways: dict[str, dict[str, Any]] = {"here": {}, "pool": {"workers": 1}, "cluster": {"cluster": "local:1"}}
    cache = str(tmp_path / "cache")
    for _ in range(2):  # rendered, then found
        with pytest.warns(
            UserWarning,
            match=r"^the mesh b .* has no inside, in MoodyRenderer\.render, dask_processes\.py line \d+; "
            r"the traceback is in the cache, \w+/failed/train/[01]\.txt\.$",
        ):
            stores = render_samples(cache, SOURCES, VIEWS, moody, progress=False, **ways[where])
    for note in sorted((tmp_path / "cache").glob("*/failed/train/*.txt")):
        assert note.read_text().startswith("b:\nTraceback")
        assert "ArithmeticError" in note.read_text()
    store = open_samples(cache, SOURCES, VIEWS, moody)["train"]
    for train in (store, stores["train"]):
        assert [train.name(i) for i in range(len(train))] == [f"{m}/{v}" for m in "acd" for v in range(VIEWS)]
    assert [list(store.indices(shard)) for shard in range(3)] == [
        [*range(18)],  # 18 of a, then b
        [*range(18, 46)],  # four of b, 18 of c, ten of d
        [*range(46, 54)],
    ]
    for shard in range(3):
        stacked = store.read_shard(shard)
        assert len(stacked["mask"]) == len(store.indices(shard))
        for index, sketch in zip(store.indices(shard), stacked["sketch"], strict=True):
            mesh, view = store.name(index).split("/")
            source = {s.name: s for s in SOURCES["train"]}[mesh]
            assert (sketch == moody.render(source.load(), int(view)).sketch).all()
            assert (store.read(index).sketch == sketch).all()
    if where != "here":
        with pytest.warns(UserWarning, match="the mesh b is left out"):
            render_samples(str(tmp_path / "alone"), SOURCES, VIEWS, moody, progress=False)
        assert contents(tmp_path / "cache") == contents(tmp_path / "alone")
    mended.touch()  # what was wrong with it is right now: only a thorough run tries it again
    with pytest.warns(UserWarning, match="the mesh b is left out"):
        render_samples(cache, SOURCES, VIEWS, moody, progress=False)
    whole = render_samples(cache, SOURCES, VIEWS, moody, progress=False, thorough=True)["train"]
    assert len(whole) == 72
    assert whole.read(20).mask.any()
    assert whole.failures() == {}
    assert not list((tmp_path / "cache").glob("*/failed/train/*"))


def test_a_split_of_which_no_mesh_can_be_rendered_is_refused(tmp_path: Path) -> None:
    moody = replace(MOODY, renderer=MoodyRenderer(fails_at="e"))
    with pytest.raises(InputError, match="the only mesh for test cannot be used: e: Arith"):
        render_samples(str(tmp_path), SOURCES, VIEWS, moody, progress=False)
    assert finished(tmp_path) == 4


@dataclass(frozen=True)
class LeavingRenderer(EmbreeRenderer):
    """Ends the program, as a class whose author took it for an error might."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return nothing."""
        sys.exit(0)


def test_a_renderer_that_ends_the_program_is_a_failure_like_any_other(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a: SystemExit: 0, in LeavingRenderer.render, test_failing_mesh"):
        render_samples(
            str(tmp_path), SOURCES, VIEWS, replace(MOODY, renderer=LeavingRenderer()), progress=False
        )


@pytest.mark.slow  # every death costs the start of a process
def test_a_mesh_that_kills_its_worker_again_and_again_fails_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(HERE), prepend=os.pathsep)
    with pytest.warns(UserWarning, match="^the mesh b is left out: it kills the process that renders it"):
        folder = render(tmp_path / "cache", "local:1", dies_at="b")
    harmless = replace(recipe(dies_at="b"), renderer=MoodyRenderer(fails_at="b"))
    with pytest.warns(UserWarning, match="the mesh b is left out"):
        other = render(tmp_path / "other", made_by=harmless)
    for name in ("train/normal/c/0/0/0/0", "train/normal/c/1/0/0/0", "test/sketch/c/0/0/0"):
        assert (folder / "samples.zarr" / name).read_bytes() == (other / "samples.zarr" / name).read_bytes()
    assert finished(tmp_path / "cache") == 4


@pytest.fixture(scope="module", name="moody_store")
def make_moody_store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache with all that could be rendered, and the note of the mesh that could not; to be read alone."""
    folder = tmp_path_factory.mktemp("moody")
    with pytest.warns(UserWarning, match="the mesh b is left out"):
        render_samples(str(folder), SOURCES, VIEWS, MOODY, progress=False)
    return folder


@pytest.mark.parametrize("note", [b"{", b"{}", b'{"b": 3}', b"\xff", b"[" * 100_000])
def test_a_damaged_record_of_a_failure_is_repaired_and_other_files_are_ignored(
    moody_store: Path, tmp_path: Path, note: bytes
) -> None:
    shutil.copytree(moody_store, tmp_path, dirs_exist_ok=True)
    before = contents(tmp_path)
    (place,) = tmp_path.glob("*/failed/train")
    (place / "0.json").write_bytes(note)
    for name in (".DS_Store", "notes.txt", "x.json"):
        (place / name).write_bytes(b"\0")
    with pytest.raises(InputError, match=r"shard 0 of train in .* is unfinished or damaged; render"):
        open_samples(str(tmp_path), SOURCES, VIEWS, MOODY)
    with (
        pytest.warns(UserWarning, match="damaged, and rendered again: shard 0 of train"),
        pytest.warns(UserWarning, match="the mesh b is left out"),
    ):
        render_samples(str(tmp_path), SOURCES, VIEWS, MOODY, progress=False)
    for name in (".DS_Store", "notes.txt", "x.json"):
        (place / name).unlink()
    assert contents(tmp_path) == before
