"""Pairs are prepared when training first asks for them, and the batches are those of a finished cache."""

import shutil
import warnings
from pathlib import Path
from typing import Any

import pytest
import torch
from lightning.pytorch.trainer.states import TrainerFn
from PIL import Image
from test_datamodule import Seen

from normalgan.data.datamodule import MeshDataModule
from normalgan.data.settings import Split, Storage
from normalgan.data.sources import Pairs
from normalgan.errors import InputError
from pairs_on_disk import SIZE, write_pairs
from small import QUIET, gan, trainer

pytestmark = [
    pytest.mark.filterwarnings(*QUIET),
    pytest.mark.filterwarnings("ignore:This DataLoader will create:UserWarning"),
    pytest.mark.filterwarnings("ignore:the pair a13 is left out:UserWarning"),
]

PER_SHARD = 8


@pytest.fixture(scope="module")
def pairs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two shards of pairs; of these a13 has no line in its sketch, which its header does not tell."""
    folder = write_pairs(tmp_path_factory.mktemp("pairs"), 2 * PER_SHARD)
    Image.new("L", (SIZE, SIZE), 255).save(folder / "a13.png")
    return folder


def on(pairs: Path, cache: Path, fractions: tuple[float, float, float], workers: int = 0) -> MeshDataModule:
    settings = {"size": 32, "batch_size": 2, "storage": Storage(render_workers=0), "workers": workers}
    return MeshDataModule(source=Pairs(str(pairs)), cache=str(cache), split=Split(fractions), **settings)  # type: ignore[arg-type]


def fitted(module: MeshDataModule, folder: Path, **settings: Any) -> Seen:
    seen = Seen()
    trainer(folder, callbacks=[seen], num_sanity_val_steps=0, **settings).fit(gan(), module)
    return seen


def begin(module: MeshDataModule, folder: Path) -> None:
    """Prepare data as training does before its first batch."""
    module.trainer = trainer(folder)
    module.trainer.state.fn = TrainerFn.FITTING
    module.prepare_data()


def finished(cache: Path, split: str) -> int:
    return len(list(cache.glob(f"*/done/{split}/*.json")))


@pytest.mark.slow
def test_training_begins_before_all_pairs_are_prepared(tmp_path: Path) -> None:
    module = on(write_pairs(tmp_path / "pairs", 64), tmp_path / "cache", (0.75, 0.125, 0.125))
    seen = fitted(module, tmp_path, limit_train_batches=1, limit_val_batches=0)
    assert len(seen.training) == 1
    prepared = finished(tmp_path / "cache", "train")
    assert 1 <= prepared <= 1 + 2 * 2 < 48 / PER_SHARD  # Lightning fetches a batch ahead
    assert finished(tmp_path / "cache", "test") == 1  # which shows that there is one to measure


@pytest.mark.slow
def test_batches_of_workers_are_those_of_a_finished_cache(pairs: Path, tmp_path: Path) -> None:
    all_of_them = (1.0, 0.0, 0.0)
    few = {"limit_train_batches": 6, "limit_val_batches": 0}
    lazy = fitted(on(pairs, tmp_path / "a", all_of_them, workers=2), tmp_path, **few)
    ready = on(pairs, tmp_path / "b", all_of_them)
    ready.prepare_data()
    whole = fitted(ready, tmp_path, **few)
    for a, b in zip(lazy.training, whole.training, strict=True):
        assert a["name"] == b["name"]
        for key in ("sketch", "normal", "mask"):
            assert torch.equal(a[key], b[key])


@pytest.mark.parametrize("ready", [False, True])
def test_the_next_pair_takes_the_place_of_one_that_cannot_be_used(
    pairs: Path, tmp_path: Path, ready: bool
) -> None:
    module = on(pairs, tmp_path, (1.0, 0.0, 0.0))
    listed = [source.name for source in module.sources["train"]]
    place = listed.index("a13")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        if ready:
            module.prepare_data()
        else:
            begin(module, tmp_path)
        item = module.train_dataset[place]
    (told,) = [str(each.message) for each in caught if "a13" in str(each.message)]
    assert told.startswith("the pair a13 is left out: no lines were found in it")
    assert len(module.train_dataset) == 2 * PER_SHARD
    assert item["name"] == f"{listed[place + 1]}/0"


def test_a_pair_that_cannot_be_validated_on_has_an_empty_mask(pairs: Path, tmp_path: Path) -> None:
    module = on(pairs, tmp_path, (0.0, 1.0, 0.0))
    begin(module, tmp_path)
    items = [module.val_dataset[i] for i in range(2 * PER_SHARD)]
    assert [item["name"] for item in items if not item["mask"].any()] == ["a13/0"]


@pytest.mark.slow
def test_a_sample_that_is_lost_while_it_is_trained_on_is_prepared_again(pairs: Path, tmp_path: Path) -> None:
    module = on(pairs, tmp_path, (1.0, 0.0, 0.0))
    module.prepare_data()
    module.storage = Storage(memory=0, render_workers=0)
    before = module.train_dataset[0]
    (cache,) = tmp_path.glob("*/samples.zarr/train/normal/c")
    shutil.rmtree(cache)
    after = [module.train_dataset[i] for i in range(2 * PER_SHARD)]
    assert torch.equal(before["normal"], after[0]["normal"])


def test_a_pair_that_is_replaced_while_it_is_trained_on_ends_in_a_sentence(
    pairs: Path, tmp_path: Path
) -> None:
    copy = tmp_path / "pairs"
    shutil.copytree(pairs, copy, ignore=shutil.ignore_patterns("a13*"))
    module = on(copy, tmp_path / "cache", (1.0, 0.0, 0.0))
    begin(module, tmp_path)
    dataset = module.train_dataset
    name = module.sources["train"][-1].name
    shutil.copyfile(copy / "a0.png", copy / f"{name}.png")
    with pytest.raises(InputError, match=f"^{name} on .* has changed since rendering began"):
        dataset[2 * PER_SHARD - 2]  # in the shard that is not prepared yet
