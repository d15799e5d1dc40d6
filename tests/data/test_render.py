import dataclasses
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Sequence
from pathlib import Path

import pytest
from toys import BallRenderer, Counted, Octahedron, assert_same, contents, recipe, surroundings

from normalgan.data.jobs import tasks
from normalgan.data.jobs.pool import Killed
from normalgan.data.jobs.workers import Workers
from normalgan.data.render import open_samples, render_samples
from normalgan.data.store.manifest import dataset_key, fingerprints
from normalgan.data.store.sample_layout import Layout
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import InputError
from normalgan.rendering import Views
from normalgan.rendering.lines.contours import OccludingContours
from normalgan.rendering.samples import Recipe

SOURCES = {"train": [Octahedron("a"), Octahedron("b", 0.3)], "val": [], "test": [Octahedron("c", 0.8)]}
AGAIN = "damaged, and written again: the manifest of "
VIEWS = 18  # 36 samples to train on are two shards, 18 to test on are one


def render(
    cache: Path, workers: int = 0, sources: dict[str, list[Octahedron]] | None = None, **renderer: object
) -> Path:
    """Render the toys and return the one folder of the data set."""
    render_samples(str(cache), sources or SOURCES, VIEWS, recipe(**renderer), workers, progress=False)  # type: ignore[arg-type]
    (folder,) = cache.iterdir()
    return folder


@pytest.fixture(scope="module", name="rendered")
def make_rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the rendered toys, to be read alone."""
    return render(tmp_path_factory.mktemp("rendered"))


@pytest.fixture(name="folder")
def make_folder(rendered: Path, tmp_path: Path) -> Path:
    """The folder of the rendered toys, in the test's own folder."""
    return Path(shutil.copytree(rendered, tmp_path / rendered.name))


def test_every_sample_is_what_the_recipe_says(tmp_path: Path) -> None:
    stores = render_samples(str(tmp_path), SOURCES, {"train": 18, "test": 3}, recipe(), progress=False)
    assert {split: len(store) for split, store in stores.items()} == {"train": 36, "test": 3}
    assert stores["train"].name(20) == "b/2"
    assert_same(stores["train"].read(20), recipe().render(SOURCES["train"][1].load(), 2))
    assert_same(stores["test"].read(2), recipe().render(SOURCES["test"][0].load(), 2))
    again = open_samples(str(tmp_path), SOURCES, {"train": 18, "test": 3}, recipe())
    assert_same(again["train"].read(35), stores["train"].read(35))
    described = json.loads((Path(stores["train"].url) / "dataset.json").read_text())
    assert described["splits"]["train"]["meshes"] == ["a", "b"]
    assert described["samples"] == {"train": 36, "test": 3}
    lines = described["recipe"]["lines"]
    assert len(lines.pop("code")) == 16  # of a class that is not ours
    assert lines == {"class": "RimDrawing", "threshold": 0.4, "supersampling": 2}


@pytest.mark.slow
def test_workers_write_the_same_bytes_as_this_process(rendered: Path, tmp_path: Path) -> None:
    alone, together = rendered, render(tmp_path / "2", workers=2)
    assert alone.name == together.name
    assert contents(alone) == contents(together)
    assert len(contents(alone)) == 1 + 1 + 2 * 4 + 3 * 4  # manifest, groups and arrays, objects and markers


def test_finished_samples_are_not_rendered_again(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    monkeypatch.setattr(BallRenderer, "render", None)
    monkeypatch.setattr(Octahedron, "load", None)
    render(tmp_path, workers=2)
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before


def test_an_interrupted_rendering_continues(folder: Path, tmp_path: Path) -> None:
    whole = contents(folder)
    (folder / "done" / "train" / "1.json").unlink()  # killed between the objects and the marker
    (folder / "samples.zarr" / "train" / "normal" / "c" / "1" / "0" / "0" / "0").unlink()
    (folder / "dataset.json").unlink()  # killed before it began
    (folder / "samples.zarr" / "test" / "mask" / "zarr.json").unlink()
    assert contents(render(tmp_path)) == whole


def test_a_damaged_shard_is_reported_and_rendered_again(folder: Path, tmp_path: Path) -> None:
    whole = contents(folder)
    path = folder / "samples.zarr" / "train" / "sketch" / "c" / "1" / "0" / "0"
    content = bytearray(path.read_bytes())
    content[7] ^= 1
    path.write_bytes(content)
    with pytest.warns(UserWarning, match=r"damaged, and rendered again: shard 1 of train in "):
        render(tmp_path)
    assert contents(folder) == whole


@pytest.mark.parametrize(
    ("name", "old", "new", "warning"),
    [
        ("dataset.json", '"views": 18', '"views": 19', AGAIN),
        ("dataset.json", '"per_shard": 32', '"per_shard": 36', AGAIN),
        ("dataset.json", '"sha256"', '"sha257"', AGAIN),
        ("dataset.json", "{", "[", AGAIN),
        ("samples.zarr/train/normal/zarr.json", '"float16"', '"float17"', None),
        ("samples.zarr/test/zarr.json", "{", "[", None),
    ],
)
def test_damaged_metadata_is_repaired(
    folder: Path, tmp_path: Path, name: str, old: str, new: str, warning: str | None
) -> None:
    whole = contents(folder)
    path = folder / name
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        render(tmp_path)
    assert [str(one.message).startswith(warning or "") for one in caught] == ([True] if warning else [])
    assert contents(folder) == whole


@pytest.mark.slow
def test_a_killed_run_leaves_no_workers_and_can_be_continued(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from test_render import render\n"
        "if __name__ == '__main__':\n"
        "    render(Path(sys.argv[1]), workers=1, waits_at='c', until=sys.argv[2])"
    )
    go = tmp_path / "go"
    (tmp_path / "main.py").write_text(code)
    cache = tmp_path / "cache"
    paths = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    process = subprocess.Popen(
        [sys.executable, str(tmp_path / "main.py"), str(cache), str(go)],
        env={**os.environ, "PYTHONPATH": paths},
        start_new_session=True,
    )
    deadline = time.monotonic() + 120
    while not list(cache.glob("*/done/*/*.json")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    process.kill()
    assert process.wait() == -signal.SIGKILL
    while _alive(process.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not _alive(process.pid)
    finished = len(list(cache.glob("*/done/*/*.json")))
    assert 0 < finished < 3
    go.touch()
    whole = render(tmp_path / "whole", waits_at="c", until=str(go))
    assert contents(render(cache, waits_at="c", until=str(go))) == contents(whole)


def _alive(session: int) -> bool:
    """Whether a process of the session is left, but for those that only wait to be reaped."""
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, in_session = stat.read_text().rpartition(")")[2].split()[:4]
        except OSError:
            continue
        if int(in_session) == session and state != "Z":
            return True
    return False


def test_a_mesh_that_cannot_be_used_is_named_and_left_out(tmp_path: Path) -> None:
    sources = {"train": [Octahedron("a"), Octahedron("bad", flaw="has no faces"), Octahedron("b", 0.3)]}
    for _ in range(2):  # rendered, then found
        with pytest.warns(UserWarning, match="the mesh bad is left out: bad has no faces"):
            stores = render_samples(str(tmp_path), sources, 2, recipe(), progress=False)
    assert [stores["train"].name(i) for i in range(4)] == ["a/0", "a/1", "b/0", "b/1"]
    assert_same(stores["train"].read(3), recipe().render(Octahedron("b", 0.3).load(), 1))


def test_each_mesh_but_the_first_of_a_split_is_loaded_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tasks, "_last", None)
    meshes = [Counted(name) for name in "abcd"]
    render_samples(str(tmp_path), {"train": meshes}, 2, recipe(), progress=False)
    assert [mesh.loads for mesh in meshes] == [["a"], ["b"], ["c"], ["d"]]


@pytest.mark.parametrize(
    ("sources", "views", "workers", "message"),
    [
        (
            {"train": [Octahedron("a", flaw="is flat")]},
            2,
            0,
            "the only mesh for train cannot be used: a is flat",
        ),
        ({"train": [Octahedron("a")], "val": [Octahedron("a")]}, 2, 0, "two meshes are named a"),
        ({"train": []}, 2, 0, "there are no meshes"),
        ({"train": [Octahedron("a")]}, 0, 0, "0 views per mesh are requested for train"),
        ({"train": [Octahedron("a")]}, {"val": 3}, 0, "0 views per mesh are requested for train"),
        ({"train": [Octahedron("a")]}, 2, -1, "-1 workers were requested"),
        ({"train": [Octahedron("a")]}, 2, 2, "memory://x is invisible to other processes; set workers to 0"),
    ],
)
def test_invalid_requests_are_refused(
    sources: dict[str, Sequence[Octahedron]], views: int, workers: int, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        render_samples("memory://x", sources, views, recipe(), workers, progress=False)


def test_a_renderer_that_does_not_run_here_says_so_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="this machine has no room for a ball"):
        render(tmp_path, radius=0.0)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow  # every death costs the start of a process
def test_a_mesh_that_kills_its_worker_is_left_out_and_the_others_are_rendered(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="^the mesh b is left out: it kills the process that renders it"):
        folder = render(tmp_path, workers=1, dies_at="b")
    store = ShardedSamples(str(folder), "train", Layout(("a", "b"), 18, 16))
    alone = recipe(dies_at="b").render(SOURCES["train"][0].load(), 17)
    assert_same(store.read(17), alone)
    assert not store.read(18).mask.any()
    assert store.failures().keys() == {0, 1}
    assert store.missing() == []


@pytest.mark.slow
def test_a_full_disk_in_a_worker_is_one_sentence(folder: Path, tmp_path: Path) -> None:
    (folder / "done" / "test" / "0.json").unlink()
    mask = folder / "samples.zarr" / "test" / "mask" / "c" / "0" / "0"
    (mask / "0").unlink()
    mask.rmdir()
    mask.write_text("in the way")  # works for root too, whom permissions do not bind
    with pytest.raises(
        InputError, match=r"^cannot write the samples to .*; free some space there or name another folder\.$"
    ):
        render(tmp_path, workers=1)
    assert sorted(str(path.relative_to(folder)) for path in folder.glob("done/*/*")) == [
        "done/train/0.json",
        "done/train/1.json",
    ]


def test_memory_needs_no_disk_and_a_bar_goes_to_the_error_stream(capsys: pytest.CaptureFixture[str]) -> None:
    sources = {"train": [Octahedron("a")]}
    stores = render_samples("memory://bar", sources, 3, recipe(seed=9))
    assert_same(stores["train"].read(1), recipe(seed=9).render(sources["train"][0].load(), 1))
    out, err = capsys.readouterr()
    assert out == ""
    assert "3/3 samples" in err


def test_samples_that_are_not_there_are_not_opened(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"not all of these samples are in .*; render them first"):
        open_samples(str(tmp_path), SOURCES, VIEWS, recipe())
    folder = render(tmp_path)
    assert isinstance(open_samples(str(tmp_path), SOURCES, VIEWS, recipe())["test"], ShardedSamples)
    (folder / "done" / "test" / "0.json").unlink()
    with pytest.raises(InputError, match=r"not all of these samples"):
        open_samples(str(tmp_path), SOURCES, VIEWS, recipe())


def test_the_key_changes_with_anything_the_samples_depend_on() -> None:
    def key(sources: dict[str, list[Octahedron]], views: int = 2, made_by: Recipe | None = None) -> str:
        used = {split: part for split, part in sources.items() if part}
        return dataset_key(fingerprints(used), dict.fromkeys(used, views), made_by or recipe())

    a, b = Octahedron("a"), Octahedron("b")
    base = recipe()
    keys = [
        key({"train": [a, b]}),
        key({"train": [b, a]}),
        key({"train": [a]}),
        key({"train": [a], "val": [b]}),
        key({"train": [a], "test": [b]}),
        key({"train": [a, dataclasses.replace(b, name="c")]}),
        key({"train": [a, dataclasses.replace(b, stretch=0.51)]}),
        key({"train": [a, b]}, views=3),
        key({"train": [a, b]}, made_by=recipe(size=17)),
        key({"train": [a, b]}, made_by=recipe(seed=1)),
        key({"train": [a, b]}, made_by=recipe(radius=0.6)),
        key({"train": [a, b]}, made_by=dataclasses.replace(base, views=Views(margin=0.1))),
        key({"train": [a, b]}, made_by=dataclasses.replace(base, lines=OccludingContours())),
    ]
    assert len(set(keys)) == len(keys)
    assert key({"train": [a, b]}) == key({"train": [Octahedron("a"), Octahedron("b")], "val": []})


def test_versions_enter_the_key(monkeypatch: pytest.MonkeyPatch) -> None:
    used = fingerprints({"train": [Octahedron("a")]})
    keys = {dataset_key(used, {"train": 1}, recipe())}
    monkeypatch.setattr("normalgan.data.store.manifest.FORMAT_VERSION", -1)
    keys.add(dataset_key(used, {"train": 1}, recipe()))
    monkeypatch.setattr("normalgan.rendering.samples.RENDERING_VERSION", -1)
    keys.add(dataset_key(used, {"train": 1}, recipe()))
    assert len(keys) == 3


@pytest.mark.slow
def test_workers_are_other_processes_with_one_thread_and_without_torch() -> None:
    outside = os.environ.get("OMP_NUM_THREADS")
    with Workers(1) as pool:
        ((_, outcome),) = pool.run(surroundings, [0])
    assert not isinstance(outcome, Killed)
    threads, torch, pid = outcome
    assert (threads, torch) == ("1", False)
    assert pid != os.getpid()
    assert os.environ.get("OMP_NUM_THREADS") == outside


def test_a_sound_run_warns_of_nothing(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        render(tmp_path)
        render(tmp_path)
