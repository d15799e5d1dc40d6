import json
import math
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image
from torch import Tensor

from normalgan.callbacks import TestReport
from normalgan.callbacks.table import FIGURES, HEADINGS
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.loading.items import collate_decoded
from normalgan.gan import NormalGAN
from normalgan.hints import UniformHints
from normalgan.metrics.collection import PRESENCE
from normalgan.models import UNetGenerator
from reported import figures_of
from small import QUIET, data, gan, trainer
from spheres import loader

pytestmark = pytest.mark.filterwarnings(*QUIET)

Results = dict[str, dict[str, float]]


class Truth(UNetGenerator):
    """Paints the hints and nothing else."""

    def forward(self, condition: Tensor) -> Tensor:
        return condition[:, :3] * condition[:, 3:]


def report(
    folder: Path, module: MeshDataModule, samples: int = 6, model: NormalGAN | None = None, **settings: Any
) -> Results:
    run = trainer(folder, callbacks=[TestReport(samples)], **settings)
    run.test(model or gan(), module, verbose=False)
    results: Results = figures_of(folder)
    return results


def angles(module: MeshDataModule, guess: np.ndarray[Any, np.dtype[np.float64]]) -> list[float]:
    """All angles between one map (3, H, W) and the test samples, on the objects, by arccos in float64."""
    found: list[float] = []
    samples = collate_decoded([module.test_dataset[i] for i in range(len(module.test_dataset))])
    for normal, mask in zip(samples["normal"], samples["mask"], strict=True):
        target, on = normal.double().numpy(), mask[0].numpy() > 0
        length = np.linalg.norm(target, axis=0) * np.maximum(np.linalg.norm(guess, axis=0), 1e-12)
        cosine = (target * guess).sum(0)[on] / length[on]
        found += np.degrees(np.arccos(np.clip(cosine, -1, 1))).tolist()
    return found


def rows_in(folder: Path) -> int:
    with Image.open(BytesIO((folder / "test" / "gallery.png").read_bytes())) as picture:
        assert picture.width == 20 + 5 * 192 + 4 * 8
        rows, rest = divmod(picture.height - 72, 192 + 24)
    assert rest == 0
    return rows


def test_report_has_every_figure_and_both_baselines(
    meshes: Path, cache: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    module = data(meshes, cache)
    results = report(tmp_path, module)
    assert results.keys() == HEADINGS.keys()
    assert all(row.keys() == FIGURES.keys() for row in results.values())
    assert all(math.isfinite(value) for row in results.values() for value in row.values())
    facing = np.zeros((3, 32, 32))
    facing[2] = 1
    baselines = {"constant": facing, "mean_map": module.mean_normal_map().double().numpy()}
    for name, guess in baselines.items():
        expected = angles(module, guess)
        assert results[name]["angular_mean"] == pytest.approx(np.mean(expected), abs=0.01)
        assert results[name]["angular_median"] == pytest.approx(np.median(expected), abs=0.02)
        assert results[name]["angular_rmse"] == pytest.approx(np.sqrt(np.mean(np.square(expected))), abs=0.01)
        assert results[name]["below_30"] == pytest.approx(np.mean(np.array(expected) < 30), abs=0.005)
    printed = capsys.readouterr().out
    assert "Test split, 2 samples" in printed
    assert f"{results['constant']['angular_mean']:.2f}°" in printed
    assert f"{results['mean_map']['angular_mean']:.2f}°" in printed
    assert str(tmp_path / "test" / "gallery.png") in printed
    assert str(tmp_path / "test" / "metrics.json") in printed
    assert rows_in(tmp_path) == 2


def test_batches_that_do_not_divide_change_nothing(meshes: Path, cache: Path, tmp_path: Path) -> None:
    # Seven samples of one mesh; hints depend on the batches, what is measured without them does not.
    whole = report(tmp_path / "7", data(meshes, cache, test_views=7, batch_size=7))
    parts = report(tmp_path / "3", data(meshes, cache, test_views=7, batch_size=3), samples=5)
    for row in ("constant", "mean_map", "no_hints"):
        assert parts[row] == pytest.approx(whole[row], abs=1e-4)
    assert rows_in(tmp_path / "7") == 6
    assert rows_in(tmp_path / "3") == 5


def test_fewer_batches_are_reported_as_such(
    meshes: Path, cache: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report(tmp_path, data(meshes, cache, test_views=7, batch_size=3), samples=4, limit_test_batches=2)
    assert "Test split, 6 samples" in capsys.readouterr().out
    assert rows_in(tmp_path) == 4


@pytest.mark.slow
def test_testing_again_starts_anew(meshes: Path, cache: Path, tmp_path: Path) -> None:
    module = data(meshes, cache)
    run = trainer(tmp_path, callbacks=[TestReport()])
    texts = []
    for _ in range(2):
        run.test(gan(), module, verbose=False)
        texts.append((tmp_path / "test" / "metrics.json").read_text())
    assert texts[0] == texts[1]
    assert rows_in(tmp_path) == 2


def test_no_unhinted_pixel_is_null_and_a_dash(
    meshes: Path, cache: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    results = report(tmp_path, data(meshes, cache), model=gan(hint_sampler=UniformHints(1024, 1024)))
    assert {value for name, value in results["off_hints"].items() if name not in PRESENCE} == {None}
    assert "–" in capsys.readouterr().out
    assert math.isfinite(results["hints"]["angular_mean"])


def test_what_is_drawn_is_what_was_measured(meshes: Path, cache: Path, tmp_path: Path) -> None:
    model = gan(generator=Truth(size=32, width=4), hint_sampler=UniformHints(1024, 1024))
    results = report(tmp_path, data(meshes, cache), model=model)
    assert results["hints"]["below_5"] == 1
    with Image.open(tmp_path / "test" / "gallery.png") as picture:
        shown = torch.from_numpy(np.asarray(picture.convert("RGB")).copy())
    generated, truth = (shown[62 : 62 + 192, 10 + i * 200 : 10 + i * 200 + 192] for i in (2, 3))
    assert torch.equal(generated, truth)
    assert truth.float().std() > 10


def test_what_it_cannot_report_on_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="needs the MeshDataModule"):
        trainer(tmp_path, callbacks=[TestReport()]).test(gan(), loader())


class Background(UNetGenerator):
    """Predicts directions that are right to look at, too short to be an object."""

    def forward(self, condition: Tensor) -> Tensor:
        return torch.tensor([0.0, 0.0, 0.2]).view(1, 3, 1, 1).expand(len(condition), 3, 32, 32)


def test_a_network_that_predicts_no_object_is_told_by_iou_and_coverage(
    meshes: Path, cache: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    results = report(tmp_path, data(meshes, cache), model=gan(generator=Background(size=32, width=4)))
    assert results["hints"]["mask_iou"] == results["no_hints"]["coverage"] == 0
    assert results["hints"]["angular_mean"] == pytest.approx(results["constant"]["angular_mean"])
    assert results["constant"]["coverage"] == 1
    assert 0.05 < results["constant"]["mask_iou"] < 0.95  # it predicts an object everywhere
    assert "mask IoU" in capsys.readouterr().out


@pytest.mark.slow
def test_each_checkpoint_keeps_its_figures_and_they_say_what_was_measured(
    meshes: Path, cache: Path, tmp_path: Path
) -> None:
    module = data(meshes, cache)
    for name, seed in (("one", 3), ("two", 4)):
        model, folder = gan(seed=seed), tmp_path / name
        run = trainer(folder)
        run.strategy.connect(model)
        run.save_checkpoint(folder / f"{name}.ckpt")
        trainer(tmp_path, callbacks=[TestReport()]).test(
            gan(seed=seed), module, ckpt_path=str(folder / f"{name}.ckpt"), verbose=False
        )
    # Another checkpoint of the same name, such as last.ckpt after more training.
    (tmp_path / "two" / "two.ckpt").rename(tmp_path / "one.ckpt")
    trainer(tmp_path, callbacks=[TestReport()]).test(
        gan(), module, ckpt_path=str(tmp_path / "one.ckpt"), verbose=False
    )
    written = {
        file.parent.name: json.loads(file.read_text())["run"] for file in tmp_path.glob("test/*/*.json")
    }
    other = next(name for name in written if name not in {"one", "two"})
    assert other.startswith("one-")
    assert written["one"]["checkpoint"] == written[other]["checkpoint"] == "one.ckpt"
    assert written["two"]["sha256"] == written[other]["sha256"] != written["one"]["sha256"]
    assert written["one"]["seed"] == {"model": 3, "data": module.seed}
    assert written["one"]["samples"] == 2
    assert "commit" in written["one"]
