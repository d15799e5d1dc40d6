import os
from pathlib import Path

import pytest
import torch
from test_datamodule import by_name, last, names, ready, sample_names, seen_in

from normalgan.data.datamodule import MeshDataModule
from normalgan.data.loading.stream import FreshViews
from small import QUIET, data, gan, trainer

pytestmark = [
    pytest.mark.filterwarnings(*QUIET),
    pytest.mark.filterwarnings("ignore:.*no `val_dataloader`.*"),
    pytest.mark.filterwarnings("ignore:This DataLoader will create:UserWarning"),
    pytest.mark.filterwarnings("ignore:Checkpoint directory .* exists:UserWarning"),
]


def flying(meshes: Path, cache: Path, **settings: object) -> MeshDataModule:
    return data(meshes, cache, on_the_fly=True, **settings)


def test_only_what_is_measured_is_kept(meshes: Path, tmp_path: Path) -> None:
    module = ready(flying(meshes, tmp_path))
    (kept,) = tmp_path.glob("*/samples.zarr")
    assert {folder.name for folder in kept.iterdir() if folder.is_dir()} == {"val", "test"}
    before = sorted(os.walk(tmp_path))
    assert len(names(module.train_dataloader())) == 6
    assert sorted(os.walk(tmp_path)) == before


def test_the_first_epoch_is_that_of_the_shards_and_the_next_one_is_fresh(meshes: Path, cache: Path) -> None:
    stored, rendered = ready(data(meshes, cache)), ready(flying(meshes, cache))
    assert sample_names(rendered) == sample_names(stored)
    items = by_name([stored.train_dataset[i] for i in range(6)])
    loader = rendered.train_dataloader()
    assert isinstance(loader.sampler, FreshViews)
    for batch in loader:
        for i, name in enumerate(batch["name"]):
            assert torch.equal(batch["normal"][i], items[name]["normal"])
            assert torch.equal(batch["sketch"][i], items[name]["sketch"])
    loader.sampler.set_epoch(3)
    assert {name.split("/")[1] for name in names(loader)} == {"6", "7"}


@pytest.mark.parametrize("workers", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_resumed_run_gets_the_samples_of_an_unbroken_one(
    meshes: Path, cache: Path, tmp_path: Path, workers: int
) -> None:
    settings = {"workers": workers, "train_views": 2}
    unbroken = seen_in(flying(meshes, cache, **settings), tmp_path / "a", epochs=2)
    seen_in(flying(meshes, cache, **settings), tmp_path / "b", epochs=1)
    torch.manual_seed(99)
    resumed = seen_in(flying(meshes, cache, **settings), tmp_path / "b", 2, last(tmp_path / "b"))
    assert len(unbroken.training) == 6
    assert len({name for batch in unbroken.training for name in batch["name"]}) == 12  # none comes twice
    for a, b in zip(unbroken.training[3:], resumed.training, strict=True):
        assert a["name"] == b["name"]
        assert torch.equal(a["normal"], b["normal"])
        assert torch.equal(a["sketch"], b["sketch"])


def test_the_mean_map_is_that_of_the_shards(meshes: Path, cache: Path) -> None:
    stored, rendered = ready(data(meshes, cache)), ready(flying(meshes, cache))
    torch.testing.assert_close(rendered.mean_normal_map(), stored.mean_normal_map(), atol=1e-6, rtol=0)


def test_it_trains_validates_and_tests(meshes: Path, cache: Path, tmp_path: Path) -> None:
    run, network = trainer(tmp_path), gan()
    before = {name: value.clone() for name, value in network.state_dict().items()}
    module = flying(meshes, cache)
    run.fit(network, module)
    assert any(not torch.equal(before[name], value) for name, value in network.state_dict().items())
    (figures,) = run.test(network, module, verbose=False)
    assert 0 < figures["test/hints/angular_mean"] < 180
