import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image, ImageDraw

from normalgan.data.datamodule import MeshDataModule
from normalgan.data.recipe import Loadable
from normalgan.data.settings import EmbeddedAnimals, Prediction, Split
from normalgan.data.sources import DataSource, SplitSettings
from normalgan.errors import InputError
from normalgan.normals import encode
from normalgan.rendering.lines.contours import OccludingContours
from small import QUIET, data, gan, trainer

pytestmark = [
    pytest.mark.filterwarnings(*QUIET),
    pytest.mark.filterwarnings("ignore:.*no `val_dataloader`.*"),
]

SPLITS = ("train", "val", "test")


def drawing(folder: Path, name: str = "ring.png") -> Path:
    image = Image.new("L", (60, 80), 255)
    ImageDraw.Draw(image).ellipse((10, 20, 50, 60), outline=0, width=2)
    image.save(folder / name)
    return folder / name


def test_drawings_and_their_hints_are_served_in_order(meshes: Path, cache: Path, tmp_path: Path) -> None:
    (tmp_path / "hints").mkdir()
    for name in ("b.png", "a.png", "c.png"):
        drawing(tmp_path, name)
    dots = np.zeros((80, 60, 4), np.uint8)
    dots[40, 30] = (*encode(np.array([0.6, 0.0, 0.8])), 255)
    Image.fromarray(dots).save(tmp_path / "hints" / "b_hints.png")
    module = data(
        meshes, cache, prediction=Prediction(str(tmp_path / "*.png"), str(tmp_path / "hints")), batch_size=2
    )
    module.setup("predict")
    batches = list(module.predict_dataloader())
    assert [batch["name"] for batch in batches] == [["a", "b"], ["c"]]
    hints = batches[0]["hints"]
    assert hints.shape == (2, 4, 32, 32)
    assert hints[0].abs().sum() == batches[1]["hints"].abs().sum() == 0
    assert hints[1, 3].sum() == 1
    given = hints[1, :3, hints[1, 3] > 0]
    np.testing.assert_allclose(given[:, 0], [0.6, 0, 0.8], atol=0.01)
    assert module.drawings.prepared("a").shape == (80, 60)
    assert batches[0]["sketch"].shape == (2, 1, 32, 32)
    assert 0.9 < batches[0]["sketch"].max() <= 1


def test_predicting_renders_nothing(meshes: Path, tmp_path: Path) -> None:
    module = data(meshes, tmp_path / "cache", prediction=Prediction(str(drawing(tmp_path))))
    predicted = trainer(tmp_path).predict(gan(), module)
    assert predicted is not None
    assert isinstance(predicted[0], torch.Tensor)
    assert predicted[0].shape == (1, 3, 32, 32)
    assert not (tmp_path / "cache").exists()


def test_invalid_settings_are_named(meshes: Path, cache: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=re.escape(str(tmp_path / "none"))):
        _ = data(tmp_path / "none", cache).sources
    with pytest.raises(InputError, match="three shares"):
        _ = data(meshes, cache, split=Split((0.5, 0.5, 0.5))).sources
    with pytest.raises(InputError, match="views per mesh are requested for train"):
        data(meshes, tmp_path, train_views=0).prepare_data()
    with pytest.raises(InputError, match="render them first"):
        data(meshes, tmp_path).train_dataloader()
    with pytest.raises(InputError, match="predict needs drawings"):
        data(meshes, cache).setup("predict")
    with pytest.raises(InputError, match="no sketch found"):
        data(meshes, cache, prediction=Prediction(str(tmp_path / "none.png"))).setup("predict")


def test_animals_are_the_default() -> None:
    module = MeshDataModule(animals=EmbeddedAnimals(6))
    assert [len(module.sources[split]) for split in SPLITS] == [4, 1, 1]
    other = MeshDataModule(animals=EmbeddedAnimals(6), seed=1)
    assert {s.fingerprint() for s in module.sources["train"]}.isdisjoint(
        s.fingerprint() for s in other.sources["train"]
    )


@pytest.mark.parametrize("split", ["val", "test"])
def test_a_split_that_is_empty_and_asked_for_is_named(split: str) -> None:
    shares = Split((0.5, 0.5 * (split == "test"), 0.5 * (split == "val")))
    module = MeshDataModule(animals=EmbeddedAnimals(3), split=shares)
    with pytest.raises(InputError, match=f"^the split {split} is empty, but it is needed; give"):
        getattr(module, f"{split}_dataset")


@dataclass(frozen=True)
class Nothing(DataSource):
    """Forgets to return anything."""

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Loadable]]:
        return None  # type: ignore[return-value]


def test_a_source_that_gives_no_splits_is_named() -> None:
    with pytest.raises(InputError, match=r"^Nothing gave None; a data source returns its items by the name"):
        _ = MeshDataModule(source=Nothing()).sources


@dataclass(frozen=True)
class Names(DataSource):
    """Gives names in place of meshes."""

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Loadable]]:
        return {"train": ["cow.obj"]}  # type: ignore[list-item]


def test_a_source_of_things_that_cannot_be_loaded_is_named() -> None:
    with pytest.raises(InputError, match=r"^Names gave a str; a mesh or pair has a name, fingerprint\(\)"):
        _ = MeshDataModule(source=Names()).sources


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"source": "pairs/"}, r"^data\.source must be an object of a class of DataSource, not 'pairs/'\.$"),
        (
            {"lines": "Silhouette"},
            r"^data\.lines must be an object of a class of LineDrawing, not 'Silhouette'",
        ),
        ({"lines": OccludingContours}, r"not the class OccludingContours; write OccludingContours\(…\)\.$"),
        ({"renderer": None}, r"^data\.renderer must be an object of a class of Renderer, not None\.$"),
        (
            {"augmentation": True},
            r"^data\.augmentation must be an object of a class of BatchAug.* not a bool",
        ),
    ],
)
def test_values_that_only_python_can_pass_are_checked(given: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        MeshDataModule(**given)  # type: ignore[arg-type]


def test_a_lone_species_is_not_read_letter_by_letter() -> None:
    with pytest.raises(InputError, match=r"^data\.animals\.species is a list of names, such as \['birds'\]"):
        EmbeddedAnimals(species="birds")  # type: ignore[arg-type]
