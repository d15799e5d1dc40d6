import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from torch.utils.data import DataLoader

from normalgan.batch import Batch
from normalgan.callbacks.checkpoints import LastCheckpoint
from normalgan.data.augmentation import Augmentation
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.loading.items import Item, collate_decoded
from normalgan.data.loading.loaders import EqualShare
from normalgan.data.settings import MeshReading, Split
from normalgan.rendering import Mesh
from small import QUIET, data, gan, trainer

pytestmark = [
    pytest.mark.filterwarnings(*QUIET),
    pytest.mark.filterwarnings("ignore:.*no `val_dataloader`.*"),
]

SPLITS = ("train", "val", "test")


def ready(module: MeshDataModule) -> MeshDataModule:
    module.prepare_data()
    return module


def names(loader: DataLoader[Any]) -> list[str]:
    return [name for batch in loader for name in batch["name"]]


def sample_names(module: MeshDataModule) -> list[list[str]]:
    splits = (module.train_dataset, module.val_dataset, module.test_dataset)
    return [[split[i]["name"] for i in range(len(split))] for split in splits]


def loaded(module: MeshDataModule, name: str) -> Mesh:
    (source,) = (s for sources in module.sources.values() for s in sources if s.name == name)
    mesh: Mesh = source.load()
    return mesh


def test_splits_are_by_mesh_and_never_by_view(meshes: Path, cache: Path) -> None:
    module = ready(data(meshes, cache))
    listed = sample_names(module)
    assert [len(split) for split in listed] == [6, 2, 2]
    shown = [{name.split("/")[0] for name in split} for split in listed]
    assert set.union(*shown) == {"ball", "box", "can", "hat", "pill"}
    assert not any(a & b for a, b in itertools.combinations(shown, 2))
    assert [{source.name for source in module.sources[split]} for split in SPLITS] == shown
    other = data(meshes, cache, split=Split((0.6, 0.2, 0.2), seed=1))
    assert [[s.name for s in other.sources[x]] for x in SPLITS] != [
        [s.name for s in module.sources[x]] for x in SPLITS
    ]


def test_split_file_is_honoured(meshes: Path, cache: Path, tmp_path: Path) -> None:
    split = {"train": ["hat"], "val": ["can"], "test": ["ball", "box", "pill"]}
    (tmp_path / "split.json").write_text(json.dumps(split))
    module = data(meshes, cache, split=Split(file=str(tmp_path / "split.json")))
    assert {part: [s.name for s in sources] for part, sources in module.sources.items()} == split


def test_orientation_file_is_honoured(meshes: Path, cache: Path, tmp_path: Path) -> None:
    quarter = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    (tmp_path / "up.json").write_text(json.dumps({"hat": {"rotation": quarter}}))
    plain, turned = (
        data(meshes, cache),
        data(meshes, cache, reading=MeshReading(orientation=str(tmp_path / "up.json"))),
    )
    np.testing.assert_allclose(
        loaded(turned, "hat").vertices, loaded(plain, "hat").vertices @ np.array(quarter).T, atol=1e-5
    )
    np.testing.assert_array_equal(loaded(turned, "can").vertices, loaded(plain, "can").vertices)


class Seen(Callback):
    """Keeps the batches that the module is given."""

    def __init__(self) -> None:
        self.training: list[Batch] = []
        self.validation: list[Batch] = []

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Batch, batch_idx: int
    ) -> None:
        self.training.append(batch)

    def on_validation_batch_start(
        self,
        trainer: Trainer,
        pl_module: LightningModule,
        batch: Batch,
        batch_idx: int,
        dataloader_idx: int = 0,
    ) -> None:
        self.validation.append(batch)


def seen_in(module: MeshDataModule, folder: Path, epochs: int = 1, checkpoint: Path | None = None) -> Seen:
    seen = Seen()
    # As the command line saves it: in a checkpoint of after the epoch Lightning's counters are others.
    run = trainer(
        folder,
        max_epochs=epochs,
        callbacks=[seen, LastCheckpoint()],
        num_sanity_val_steps=0,
        enable_checkpointing=True,
    )
    run.fit(gan(), module, ckpt_path=checkpoint, weights_only=False)
    return seen


def last(folder: Path) -> Path:
    return folder / "checkpoints" / "last.ckpt"


def test_batches_asked_for_after_training_are_tensors_to_use(
    meshes: Path, cache: Path, tmp_path: Path
) -> None:
    module = data(meshes, cache)
    during = seen_in(module, tmp_path).validation[0]
    after = next(iter(module.val_dataloader()))
    for name in ("sketch", "normal", "mask"):
        assert torch.equal(after[name], during[name])
        assert after[name].dtype == torch.float32


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:This DataLoader will create:UserWarning")
@pytest.mark.filterwarnings("ignore:Checkpoint directory .* exists:UserWarning")
# Lightning makes the iterator before it sets the epoch.
@pytest.mark.parametrize("workers", [0, 1])
def test_training_order_goes_on_when_resumed(meshes: Path, cache: Path, tmp_path: Path, workers: int) -> None:
    unbroken = seen_in(data(meshes, cache, workers=workers), tmp_path / "a", epochs=2)
    seen_in(data(meshes, cache, workers=workers), tmp_path / "b", epochs=1)
    torch.manual_seed(99)
    resumed = seen_in(data(meshes, cache, workers=workers), tmp_path / "b", 2, last(tmp_path / "b"))
    listed = [[name for batch in seen.training for name in batch["name"]] for seen in (unbroken, resumed)]
    assert len(listed[0]) == 12
    assert listed[1] == listed[0][6:] != listed[0][:6]


@pytest.mark.filterwarnings("ignore:Checkpoint directory .* exists:UserWarning")
def test_a_run_resumed_with_other_data_says_what_is_other(meshes: Path, cache: Path, tmp_path: Path) -> None:
    seen_in(data(meshes, cache), tmp_path, epochs=1)
    other = data(
        meshes, cache, batch_size=3, seed=1, split=Split((0.6, 0.2, 0.2), seed=1), augmentation=Augmentation()
    )
    with pytest.warns(UserWarning, match="the checkpoint was trained with other data") as caught:
        seen_in(other, tmp_path, 2, last(tmp_path))
    (told,) = [str(warning.message) for warning in caught if "other data" in str(warning.message)]
    assert told.endswith(
        "training continues with the current settings: data.meshes, data.batch_size (2, now 3), "
        "data.augmentation, data.seed (0, now 1)."
    )


def by_name(items: list[Item]) -> dict[str, dict[str, torch.Tensor]]:
    """Return decoded samples by name."""
    batch = collate_decoded(items)
    parts = {"sketch": batch["sketch"], "normal": batch["normal"]}
    return {name: {key: part[i] for key, part in parts.items()} for i, name in enumerate(batch["name"])}


@pytest.mark.slow
def test_augmentation_is_for_training_alone_and_seeded_by_the_step(
    meshes: Path, cache: Path, tmp_path: Path
) -> None:
    plain = ready(data(meshes, cache))
    stored = by_name([plain.train_dataset[i] for i in range(6)])
    kept = by_name([plain.val_dataset[i] for i in range(2)])
    seen = seen_in(data(meshes, cache, augmentation=Augmentation()), tmp_path / "a", epochs=2)
    for batch in seen.validation:
        for i, name in enumerate(batch["name"]):
            assert torch.equal(batch["normal"][i], kept[name]["normal"])
            assert torch.equal(batch["sketch"][i], kept[name]["sketch"])
    first: dict[str, torch.Tensor] = {}
    for batch in seen.training:
        for i, name in enumerate(batch["name"]):
            assert not torch.equal(batch["normal"][i], stored[name]["normal"])
            if name in first:
                assert not torch.equal(batch["normal"][i], first[name])  # other steps, other changes
            first.setdefault(name, batch["normal"][i])
    torch.manual_seed(7)
    again = seen_in(data(meshes, cache, augmentation=Augmentation()), tmp_path / "b", epochs=2)
    for a, b in zip(seen.training, again.training, strict=True):
        assert torch.equal(a["normal"], b["normal"])
        assert torch.equal(a["sketch"], b["sketch"])


def test_last_batch_of_few_is_left_out_but_a_small_set_is_used(meshes: Path, cache: Path) -> None:
    assert [len(b["name"]) for b in ready(data(meshes, cache, batch_size=4)).train_dataloader()] == [4]
    assert [len(b["name"]) for b in data(meshes, cache, batch_size=50).train_dataloader()] == [6]
    assert [len(b["name"]) for b in data(meshes, cache, batch_size=50).test_dataloader()] == [2]


def test_mean_map_by_numpy(meshes: Path, cache: Path) -> None:
    module = ready(data(meshes, cache))
    batch = collate_decoded([module.train_dataset[i] for i in range(6)])
    maps = batch["normal"].numpy().astype(np.float64)
    mean = maps.mean(0)
    length = np.linalg.norm(mean, axis=0)
    expected = np.divide(mean, length, out=np.zeros_like(mean), where=length > 0)
    np.testing.assert_allclose(module.mean_normal_map().numpy(), expected, atol=1e-5)
    assert 0 < (length > 0).mean() < 1


@pytest.mark.parametrize("replicas", [1, 2, 3, 5])
def test_shares_are_equally_long_and_count_every_sample_once(
    meshes: Path, cache: Path, replicas: int
) -> None:
    module = ready(data(meshes, cache, test_views=7))
    shares = [EqualShare(module.test_dataset, replicas, rank) for rank in range(replicas)]
    assert len({len(share) for share in shares}) == 1
    np.testing.assert_array_equal(list(shares[0].in_order()), range(len(shares[0])))
    counted: list[Item] = []
    for share in shares:
        counted += [item for item in (share[i] for i in range(len(share))) if item["mask"].any()]
    assert sorted(item["name"] for item in counted) == sorted(sample_names(module)[2])
