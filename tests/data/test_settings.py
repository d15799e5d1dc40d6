import contextlib
import io
import json
from pathlib import Path

import pytest
import yaml

from normalgan.__main__ import main
from normalgan.animals import GROUPS, Animal
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.settings import EmbeddedAnimals, MeshReading, Split
from normalgan.data.sources import MeshGroup
from normalgan.errors import InputError
from normalgan.rendering import MeshFile
from normalgan.rendering.hand import Hand
from normalgan.rendering.media import Medium
from normalgan.rendering.rigs import RiggedFile
from normalgan.rendering.samples import Recipe
from normalgan.rendering.variation import Variation, Varied
from small import data, names

CONF = Path(__file__).parents[1] / "conf"


def write_rig(path: Path) -> None:
    """Write as much of a rigged file as it takes to be known for one."""
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "skins": [{"joints": [0]}], "nodes": [{}]}))


def test_species_and_groups_in_turn() -> None:
    module = MeshDataModule(
        animals=EmbeddedAnimals(8, species=("birds", "horse")), split=Split((1.0, 0.0, 0.0))
    )
    animals = [s for s in module.sources["train"] if isinstance(s, Animal)]
    assert {animal.species for animal in animals} == {*GROUPS["birds"][:7], animals[-1].species}
    many = MeshDataModule(animals=EmbeddedAnimals(40)).sources["train"]
    assert {a.species for a in many if isinstance(a, Animal)} <= set(GROUPS["quadrupeds"])
    with pytest.raises(InputError, match="Did you mean birds"):
        _ = MeshDataModule(animals=EmbeddedAnimals(species=("brids",))).sources


def test_variants_join_the_meshes_to_train_on_alone(meshes: Path, cache: Path) -> None:
    plain = data(meshes, cache).sources
    module = data(meshes, cache, reading=MeshReading(variants=2, variation=Variation(bend=30.0)))
    assert {split: names(module.sources[split]) for split in ("val", "test")} == {
        split: names(plain[split]) for split in ("val", "test")
    }
    expected = [name for n in names(plain["train"]) for name in (n, f"{n}~0", f"{n}~1")]
    assert names(module.sources["train"]) == expected
    varied = [source for source in module.sources["train"] if isinstance(source, Varied)]
    assert {source.variation for source in varied} == {Variation(bend=30.0)}
    assert len({source.fingerprint() for source in module.sources["train"]}) == 9


def test_poses_of_a_rig_stay_on_one_side_of_the_split(meshes: Path, cache: Path, tmp_path: Path) -> None:
    for name in ("ant", "bee", "cow", "doe", "elk"):
        write_rig(tmp_path / f"{name}.gltf")
    (tmp_path / "box.obj").write_bytes((meshes / "box.obj").read_bytes())
    module = data(tmp_path, cache, reading=MeshReading(poses=3, variants=1))
    rest = data(tmp_path, cache).sources
    for split, sources in module.sources.items():
        posed = [s for s in sources if isinstance(s, (RiggedFile, MeshFile))]
        wanted = [
            n
            for name in names(rest[split])
            for n in ([name] if name == "box" else [f"{name}@{i}" for i in range(3)])
        ]
        assert names([*posed]) == wanted
    assert len(module.sources["train"]) == 2 * sum(not isinstance(s, Varied) for s in module.sources["train"])


def test_postures_are_for_training_alone(cache: Path, tmp_path: Path) -> None:
    for name in ("ant", "bee", "cow", "doe", "elk"):
        write_rig(tmp_path / f"{name}.gltf")
    module = MeshDataModule(
        groups=[MeshGroup(str(tmp_path), poses=2, postures=0.5)],
        split=Split((0.6, 0.2, 0.2)),
        cache=str(cache),
    )
    for split, sources in module.sources.items():
        shares = [source.postures for source in sources if isinstance(source, RiggedFile)]
        assert shares == len(sources) * [0.5 if split == "train" else 0.0]


def test_extra_animals_join_the_meshes_to_train_on_alone(meshes: Path, cache: Path) -> None:
    plain = data(meshes, cache).sources
    animals = EmbeddedAnimals(extra=2, species=("birds",))
    sources = data(meshes, cache, animals=animals, reading=MeshReading(variants=1)).sources
    assert {split: names(sources[split]) for split in ("val", "test")} == {
        split: names(plain[split]) for split in ("val", "test")
    }
    extra = [source for source in sources["train"] if isinstance(source, Animal)]
    assert [animal.species for animal in extra] == list(GROUPS["birds"][:2])
    assert len(sources["train"]) == 2 * len(plain["train"]) + 2  # made at random already: no variants of them


def test_a_share_of_the_extra_animals_holds_postures(meshes: Path, cache: Path) -> None:
    animals = EmbeddedAnimals(extra=6, species=("horse",), extra_postures=1.0)
    wanted = data(meshes, cache, animals=animals).sources["train"][-6:]
    assert all(isinstance(animal, Animal) and animal.pose is not None for animal in wanted)


def test_extra_animals_need_meshes_to_join() -> None:
    with pytest.raises(InputError, match=r"data\.meshes is not set; set it, or use"):
        MeshDataModule(animals=EmbeddedAnimals(extra=3))


def test_hand_and_medium_enter_the_recipe(meshes: Path, cache: Path) -> None:
    recipe = data(meshes, cache, hand=Hand(wobble=0.01), medium=Medium()).recipe
    assert isinstance(recipe, Recipe)
    assert recipe.hand == Hand(wobble=0.01)
    assert recipe.medium == Medium()
    plain = data(meshes, cache).recipe
    assert isinstance(plain, Recipe)
    assert plain.hand is None


@pytest.mark.slow
def test_the_command_line_reads_them(meshes: Path, tmp_path: Path) -> None:
    overlay = {
        "data": {
            "hand": {"wobble": 0.01, "strength": [0.5, 1.0]},
            "medium": {"tint": 0.05},
            "reading": {"variants": 1, "variation": {"bend": 5.0}},
            "lines": {"class_path": "OccludingContours"},
        }
    }
    (tmp_path / "overlay.yaml").write_text(yaml.safe_dump(overlay))
    arguments = (
        *("render", "--config", CONF / "tiny.yaml", "--config", tmp_path / "overlay.yaml"),
        *("--data.meshes", meshes, "--data.cache", tmp_path / "cache", "--data.hand.tremor", 0.001),
        *("--data.train_views", 1, "--trainer.default_root_dir", tmp_path),
    )
    errors = io.StringIO()
    with contextlib.redirect_stderr(errors):
        assert main([str(argument) for argument in arguments]) == 0, errors.getvalue()
    (manifest,) = (tmp_path / "cache").glob("*/dataset.json")
    made = json.loads(manifest.read_text())
    hand, medium = made["recipe"]["hand"], made["recipe"]["medium"]
    assert (hand["wobble"], hand["tremor"], hand["strength"]) == (0.01, 0.001, [0.5, 1.0])
    assert medium["tint"] == 0.05
    train = made["splits"]["train"]["meshes"]
    assert len(train) == 6
    assert [name for name in train if "~" in name] == [f"{name}~0" for name in train if "~" not in name]
    assert not any("~" in name for split in ("val", "test") for name in made["splits"][split]["meshes"])
