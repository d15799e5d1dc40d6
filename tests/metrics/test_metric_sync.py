"""Metrics over processes: each counts its share, and all tell the figure of the whole."""

from itertools import cycle
from multiprocessing import get_context
from pathlib import Path

import pytest
import torch
from metric_samples import computed, random_batch
from torch import Tensor, distributed
from torchmetrics import Metric

from normalgan.metrics import MeanAngularError, normal_map_metrics

SHARES = ((0, 1, 2), (3,))
"""Seeds of the batches of each process; not as many for each."""


def whole(seeds: tuple[int, ...]) -> dict[str, float]:
    metrics = normal_map_metrics()
    for seed in seeds:
        metrics.update(*random_batch(seed))
    return computed(metrics)


def gathering_from(other: Metric) -> MeanAngularError:
    """A metric that takes `other` for the second of two processes."""
    names = cycle(other.metric_state)  # each round asks for all states in turn

    def gather(state: Tensor, group: object) -> list[Tensor]:
        return [state, torch.as_tensor(other.metric_state[next(names)])]

    return MeanAngularError(dist_sync_fn=gather, distributed_available_fn=lambda: True)


def test_compute_takes_all_processes_and_then_counts_on_alone() -> None:
    other = MeanAngularError()
    other.update(*random_batch(3))
    metric = gathering_from(other)
    metric.update(*random_batch(0))
    assert metric.compute().item() == whole((0, 3))["angular_mean"]
    alone = MeanAngularError()
    alone.update(*random_batch(0))
    assert metric.metric_state.keys() == alone.metric_state.keys()
    for name, state in alone.metric_state.items():  # what came from elsewhere is not counted twice
        assert torch.equal(torch.as_tensor(metric.metric_state[name]), torch.as_tensor(state)), name
    metric.update(*random_batch(1))
    assert metric.compute().item() == whole((0, 1, 3))["angular_mean"]


def in_a_process(rank: int, folder: str) -> None:
    """Count a share, and leave what is told of the last batch and of all of them."""
    distributed.init_process_group(
        "gloo", init_method=f"file://{folder}/meet", rank=rank, world_size=len(SHARES)
    )
    metrics = normal_map_metrics()
    for seed in SHARES[rank]:
        metrics.update(*random_batch(seed))
    step = MeanAngularError(dist_sync_on_step=True)
    of_step = step(*random_batch(10 + rank)).item()
    torch.save(
        {"all": computed(metrics), "step": of_step, "steps": step.compute().item()}, f"{folder}/{rank}"
    )
    distributed.destroy_process_group()


@pytest.mark.slow  # two processes import torch
def test_two_gloo_processes_tell_what_one_does(tmp_path: Path) -> None:
    start = get_context("spawn").Process
    processes = [start(target=in_a_process, args=(rank, str(tmp_path))) for rank in range(len(SHARES))]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0] * len(SHARES)
    expected = whole(tuple(seed for share in SHARES for seed in share))
    step = whole((10, 11))["angular_mean"]
    for rank in range(len(SHARES)):
        told = torch.load(tmp_path / str(rank), weights_only=True)
        assert told == {"all": expected, "step": step, "steps": step}
