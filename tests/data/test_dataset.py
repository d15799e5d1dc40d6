import gc
import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import torch
from torch.utils.data import DataLoader, default_collate
from toys import Octahedron, recipe

from normalgan.data.dataset import SampleDataset, bytes_per_sample
from normalgan.data.loading.items import decode, to_item
from normalgan.data.loading.loaders import Loaders
from normalgan.data.render import render_samples
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import InputError

# Torch's loader asks for this; the machine that tests may have one core and warn of two workers.
pytestmark = pytest.mark.filterwarnings("ignore:This DataLoader will create:UserWarning")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> ShardedSamples:
    sources = {"train": [Octahedron("a"), Octahedron("b", 0.2)]}
    return render_samples(str(tmp_path_factory.mktemp("cache")), sources, 20, recipe(), progress=False)[
        "train"
    ]


@pytest.mark.parametrize("memory", [0, 2**30])
def test_items_are_the_stored_samples(store: ShardedSamples, memory: int) -> None:
    dataset = SampleDataset(store, memory)
    assert len(dataset) == 40
    item, sample = dataset[33], store.read(33)
    assert item["name"] == "b/13"
    assert (item["sketch"].shape, item["normal"].shape, item["mask"].shape) == (
        (1, 16, 16),
        (3, 16, 16),
        (1, 16, 16),
    )
    np.testing.assert_array_equal(item["mask"][0].numpy(), sample.mask)
    np.testing.assert_array_equal(item["sketch"][0].numpy(), sample.sketch)
    np.testing.assert_array_equal(item["normal"].permute(1, 2, 0).numpy(), sample.normal)
    assert 0 < sample.mask.mean() < 1
    assert sample.sketch.max() > 128


def test_decoded_normals_are_of_unit_length_on_the_object_and_zero_off_it(store: ShardedSamples) -> None:
    batch = decode(default_collate([SampleDataset(store)[5]]))
    torch.testing.assert_close(batch["normal"].norm(dim=1, keepdim=True), batch["mask"], atol=1e-6, rtol=0)


def test_stray_normals_off_the_object_are_dropped() -> None:
    normal = torch.ones(2, 2, 3, dtype=torch.float16)
    mask = torch.tensor([[True, False], [False, False]])
    sketch = torch.zeros(2, 2, dtype=torch.uint8)
    batch = decode(default_collate([to_item({"sketch": sketch, "normal": normal, "mask": mask}, "x")]))
    torch.testing.assert_close(batch["normal"][0, :, 0, 0], torch.full((3,), 3**-0.5))
    assert batch["normal"].abs().sum() == pytest.approx(3**0.5)


def test_batches_come_as_stored_or_decoded(store: ShardedSamples) -> None:
    dataset = SampleDataset(store)
    batches = list(Loaders(4, 0, decoded=False).in_order(dataset))
    decoded = list(Loaders(4, 0).in_order(dataset))
    for sent, wanted in zip(batches, decoded, strict=True):
        assert [sent[key].dtype for key in ("sketch", "normal", "mask")] == [
            torch.uint8,
            torch.float16,
            torch.bool,
        ]
        for batch in (decode(sent), decode(wanted)):  # one that is decoded stays as it is
            assert batch["name"] == wanted["name"]
            for key in ("sketch", "normal", "mask"):
                assert torch.equal(batch[key], wanted[key])
    share = Loaders(4, 0, replicas=3, rank=2, decoded=False).in_order(dataset)
    assert {batch["sketch"].dtype for batch in share} == {torch.uint8}


def test_memory_and_store_give_the_same_and_memory_is_used_only_within_bounds(
    store: ShardedSamples, monkeypatch: pytest.MonkeyPatch
) -> None:
    needed = 40 * bytes_per_sample(16)
    held, read = SampleDataset(store, needed), SampleDataset(store, needed - 1)
    pairs = [(held[i], read[i]) for i in range(40)]
    for a, b in pairs:
        for key in ("sketch", "normal", "mask"):
            assert torch.equal(a[key], b[key])
        assert a["name"] == b["name"]
    monkeypatch.setattr(ShardedSamples, "read", None)
    assert held[0]["name"] == "a/0"
    with pytest.raises(TypeError):
        read[0]


def test_indices_count_as_in_a_list(store: ShardedSamples) -> None:
    dataset = SampleDataset(store)
    assert dataset[-1]["name"] == "b/19"
    with pytest.raises(IndexError):
        dataset[40]


def test_collated_items_are_a_batch(store: ShardedSamples) -> None:
    dataset = SampleDataset(store)
    batch = default_collate([dataset[i] for i in (3, 1, 30)])
    assert batch["name"] == ["a/3", "a/1", "b/10"]
    assert (batch["sketch"].shape, batch["normal"].shape, batch["mask"].shape) == (
        (3, 1, 16, 16),
        (3, 3, 16, 16),
        (3, 1, 16, 16),
    )
    assert torch.equal(batch["normal"][2], dataset[30]["normal"])
    assert set(batch) == {"sketch", "normal", "mask", "name"}


@pytest.mark.parametrize("memory", [0, 2**30])
@pytest.mark.parametrize("start", ["fork", pytest.param("spawn", marks=pytest.mark.slow)])
def test_loader_workers_read_what_this_process_reads(store: ShardedSamples, memory: int, start: str) -> None:
    dataset = SampleDataset(store, memory)
    here = [dataset[i] for i in range(40)]  # the store is open in this process before the workers start
    loader = DataLoader(dataset, batch_size=8, num_workers=2, multiprocessing_context=start)
    batches = list(loader)
    assert [name for batch in batches for name in batch["name"]] == [item["name"] for item in here]
    assert torch.equal(
        torch.cat([batch["normal"] for batch in batches]), torch.stack([i["normal"] for i in here])
    )


@pytest.mark.parametrize("workers", [0, 1])
def test_a_cache_that_is_cleaned_while_it_is_read_ends_in_a_sentence(
    tmp_path: Path, workers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A worker that has failed does not end by itself; PyTorch waits five seconds for it.
    monkeypatch.setattr(torch.utils.data._utils, "MP_STATUS_CHECK_INTERVAL", 0.1)
    sources = {"train": [Octahedron("a")]}
    store = render_samples(str(tmp_path), sources, 40, recipe(), progress=False)["train"]
    loader = DataLoader(SampleDataset(store, memory=0), batch_size=4, num_workers=workers)
    batches = iter(loader)
    assert next(batches)["mask"].any()
    shutil.rmtree(store.url)
    with pytest.raises(InputError) as caught:
        list(batches)
    assert re.fullmatch(
        r"shard [01] of train in \S* is unfinished or damaged; render .*\.", str(caught.value)
    )
    del batches, caught
    gc.collect()  # ends the worker, while the interval is short


def test_a_damaged_store_says_so(tmp_path: Path) -> None:
    sources = {"train": [Octahedron("a")]}
    store = render_samples(str(tmp_path), sources, 3, recipe(), progress=False)["train"]
    (path,) = tmp_path.glob("*/samples.zarr/train/normal/c/0/0/0/0")
    os.truncate(path, 50)
    with pytest.raises(InputError, match="shard 0 of train"):
        SampleDataset(store)
    dataset = SampleDataset(ShardedSamples(store.url, "train", store.layout), memory=0)
    with pytest.raises(InputError, match="shard 0 of train"):
        dataset[0]
