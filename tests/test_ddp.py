import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import torch
from PIL import Image

from ddp_run import model, samples
from normalgan.callbacks import TestReport
from reported import figures_of
from small import QUIET, trainer

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings(*QUIET)]


@pytest.fixture(scope="module")
def results(meshes: Path, cache: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What two processes on this machine's CPU leave behind, with the strategy of configs/ddp.yaml."""
    folder = tmp_path_factory.mktemp("ddp")
    script = Path(__file__).with_name("ddp_run.py")
    done = subprocess.run(
        [sys.executable, str(script), "2", str(meshes), str(cache), str(folder)],
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    (folder / "stdout").write_text(done.stdout)
    (folder / "stderr").write_text(done.stderr)
    return folder


@pytest.fixture(scope="module")
def ranks(results: Path) -> list[dict[str, Any]]:
    return [torch.load(results / f"{rank}.pt", weights_only=True) for rank in range(2)]


def test_both_processes_end_with_the_same_weights(ranks: list[dict[str, Any]]) -> None:
    first, second = (rank["after"] for rank in ranks)
    assert first.keys() == second.keys()
    for name, value in first.items():
        assert torch.equal(value, second[name]), name
        assert value.isfinite().all()
    for network in ("generator", "discriminator"):
        changed = [not torch.equal(ranks[0]["before"][n], first[n]) for n in first if n.startswith(network)]
        assert any(changed)


def test_both_processes_measure_the_same_network(ranks: list[dict[str, Any]]) -> None:
    """The average of the weights, in whose statistics of batch norm each process had its own batches."""
    first, second = (rank["measured"] for rank in ranks)
    assert len(first) == len(second) >= 2
    for one, other in zip(first, second, strict=True):
        assert any(name.endswith("running_mean") for name in one)
        for name, value in one.items():
            assert torch.equal(value, other[name]), name


def test_each_process_draws_hints_of_its_own(ranks: list[dict[str, Any]]) -> None:
    first, second = (rank["seeds"] for rank in ranks)
    assert len(first) == len(second) >= 2
    assert not set(first) & set(second)


@pytest.mark.parametrize("stage", ["val", "test"])
def test_two_processes_measure_what_one_does(
    meshes: Path, cache: Path, tmp_path: Path, ranks: list[dict[str, Any]], stage: str
) -> None:
    network, module = model(), samples(meshes, cache)
    network.load_state_dict(ranks[0]["after"])
    run = trainer(tmp_path, callbacks=[TestReport()])
    measure = run.validate if stage == "val" else run.test
    (alone,) = measure(network, module, verbose=False)
    assert len(alone) == (26 if stage == "val" else 65)
    assert ranks[0][stage] == ranks[1][stage]
    assert ranks[0][stage] == pytest.approx(alone, abs=1e-4)


def test_the_report_is_written_once_and_for_all(results: Path, ranks: list[dict[str, Any]]) -> None:
    printed = (results / "stdout").read_text()
    assert printed.count("Test split, 5 samples") == 1
    written = figures_of(results)
    assert written["hints"]["angular_mean"] == pytest.approx(ranks[1]["test"]["test/hints/angular_mean"])
    with Image.open(results / "test" / "gallery.png") as picture:
        assert picture.height == 72 + 2 * (192 + 24)


def test_nobody_is_told_to_do_what_is_done(results: Path) -> None:
    # Lightning warns of figures that are not averaged over processes; these are reduced by the metrics.
    assert "sync_dist" not in (results / "stderr").read_text()
    assert "DistributedSampler" not in (results / "stderr").read_text()
