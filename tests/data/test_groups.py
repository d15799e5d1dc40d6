from pathlib import Path

import pytest

from normalgan.data.datamodule import MeshDataModule
from normalgan.data.settings import EmbeddedAnimals, Split
from normalgan.data.sources import MeshGroup
from normalgan.errors import InputError
from normalgan.rendering import MeshFile
from normalgan.rendering.variation import Varied
from small import data, names


@pytest.fixture(name="things")
def copy_meshes(meshes: Path, tmp_path: Path) -> Path:
    for path in meshes.iterdir():
        (tmp_path / f"thing_{path.name}").write_bytes(path.read_bytes())
    return tmp_path


def test_each_group_is_read_and_split_in_its_own_way(meshes: Path, things: Path, cache: Path) -> None:
    groups = [MeshGroup(str(meshes), variants=1), MeshGroup(str(things), crease_angle=40.0)]
    module = MeshDataModule(groups=groups, cache=str(cache), split=Split((0.6, 0.2, 0.2)))
    for split, count in (("train", 3), ("val", 1), ("test", 1)):
        sources = module.sources[split]
        edged = [s for s in sources if isinstance(s, MeshFile) and s.crease_angle == 40]
        assert len(edged) == count
        assert all(source.name.startswith("thing_") for source in edged)
        plain = [s for s in sources if isinstance(s, MeshFile) and s.crease_angle is None]
        assert len(plain) == count
        assert len([s for s in sources if isinstance(s, Varied)]) == (3 if split == "train" else 0)


def test_groups_come_behind_meshes_without_one(meshes: Path, things: Path, cache: Path) -> None:
    alone = data(meshes, cache).sources
    module = data(meshes, cache, groups=[MeshGroup(str(things))], animals=EmbeddedAnimals(extra=2))
    for split in ("train", "val", "test"):
        assert names(module.sources[split])[: len(alone[split])] == names(alone[split])
    assert len(module.sources["train"]) == 3 + 3 + 2
    assert not set(names(module.sources["train"])) & set(names(module.sources["test"]))


def test_an_invalid_group_is_refused(things: Path) -> None:
    with pytest.raises(InputError, match="a pattern that matches a mesh"):
        _ = MeshDataModule(groups=[MeshGroup(str(things / "none*.ply"))]).sources
