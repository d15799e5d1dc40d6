"""The training commands with safetensors in place of a checkpoint, and predict with those of the package."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from command import Bench, Outcome, left_in, run
from numpy.typing import NDArray
from PIL import Image

from normal_pngs import read_png
from normalgan.__main__ import main
from reported import figures_of


@pytest.fixture(scope="module", name="weights")
def make_weights(trained: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The weights of the trained run."""
    path = tmp_path_factory.mktemp("weights") / "Run.SafeTensors"
    checkpoint = trained / "checkpoints" / "last.ckpt"
    assert main(["export", str(checkpoint), "-o", str(path)]) == 0
    return path


@pytest.fixture
def predict(tmp_path: Path) -> Callable[..., Outcome]:
    """The command on a drawing of a ring, with no settings but those given."""
    y, x = np.mgrid[:80, :80] - 39.5
    ring = np.where(np.abs(np.hypot(x, y) - 30) < 1.5, 0, 255).astype(np.uint8)
    Image.fromarray(ring).save(tmp_path / "ring.png")

    def predict(*arguments: object) -> Outcome:
        where = ("--data.prediction.sketches", tmp_path / "ring.png", "--trainer.accelerator", "cpu")
        return run("predict", *where, "--output.folder", tmp_path / "maps", *arguments)

    return predict


def predicted(folder: Path) -> NDArray[np.float32]:
    return read_png(folder / "maps" / "ring_normal.png")[0]


def test_predict_needs_nothing_but_a_drawing(predict: Callable[..., Outcome], tmp_path: Path) -> None:
    outcome = predict()
    assert outcome.code == 0, outcome.err
    assert outcome.err.splitlines()[0] == (
        "normalgan: predict uses the weights that come with the package: ResidualUNetGenerator, 256 pixels."
    )
    # What torch makes of the safetensors and ONNX Runtime of the ONNX file: sums in another order, no more.
    assert main(["generate", str(tmp_path / "ring.png"), "-o", str(tmp_path / "generated")]) == 0
    preds, target = predicted(tmp_path), read_png(tmp_path / "generated" / "ring_normal.png")[0]
    sine = np.linalg.norm(np.cross(preds, target), axis=-1)
    degrees = np.rad2deg(np.arctan2(sine, (preds * target).sum(-1)))
    # Two levels of 8 bits; a few short vectors, where the weights are in doubt, turn more with the last bits.
    assert np.percentile(degrees, 99) < 1
    assert degrees.mean() < 0.05
    assert 0.3 < (np.abs(target - [0, 0, 1]).max(-1) > 0.02).mean() < 0.6  # the disc


def test_a_checkpoint_predicts_at_the_size_of_its_training(
    predict: Callable[..., Outcome], trained: Path, weights: Path, tmp_path: Path
) -> None:
    maps = []
    for path in (trained / "checkpoints" / "last.ckpt", weights):
        outcome = predict("--ckpt_path", path)
        assert outcome.code == 0, outcome.err
        maps.append(predicted(tmp_path))
    np.testing.assert_array_equal(maps[0], maps[1])


@pytest.mark.slow  # tests and predicts twice
def test_weights_paint_and_measure_as_their_checkpoint(
    predict: Callable[..., Outcome], bench: Bench, trained: Path, weights: Path, tmp_path: Path
) -> None:
    checkpoint = trained / "checkpoints" / "last.ckpt"
    maps, figures = [], []
    for path in (checkpoint, weights):
        assert predict("--ckpt_path", path, "--data.size", 32).code == 0
        maps.append(predicted(tmp_path))
        done = bench.run("test", tmp_path / "run", "--ckpt_path", path)
        assert done.code == 0, done.err
        figures.append(figures_of(tmp_path / "run"))
    assert np.ptp(maps[0], axis=(0, 1)).max() > 0.1
    np.testing.assert_array_equal(maps[0], maps[1])
    assert figures[0] == figures[1]


@pytest.mark.filterwarnings("default")
def test_a_setting_that_was_given_is_overruled_though_it_is_the_default(
    predict: Callable[..., Outcome], weights: Path, tmp_path: Path
) -> None:
    config = tmp_path / "width.yaml"
    config.write_text("model: {generator: {class_path: UNetGenerator, init_args: {width: 64}}}")
    for given, lost in (
        (("--model.generator", "UNetGenerator"), "model.generator"),  # of the weights that ship: another
        (("--ckpt_path", weights, "--model.generator.width", 64), "model.generator.width"),
        (("--ckpt_path", weights, "--config", config), "model.generator.width"),
    ):
        outcome = predict(*given)
        assert outcome.code == 0, outcome.err
        said = outcome.err.splitlines()
        assert said[0].endswith(f"was trained with other settings, which are kept: {lost}.")
    assert said[1] == f"normalgan: predict uses the weights in {weights}: UNetGenerator, 32 pixels."


def test_weights_that_cannot_be_used(
    predict: Callable[..., Outcome], bench: Bench, weights: Path, tmp_path: Path
) -> None:
    before = left_in(tmp_path)
    predict("--data.size", 64).refused("ours.onnx was trained at 256 pixels, not 64")
    predict("--ckpt_path", "gone.safetensors").refused("there is no model gone.safetensors")
    bench.run("fit", tmp_path / "run", "--ckpt_path", weights).refused("holds only weights")
    bench.run("test", tmp_path / "run").refused("test needs a trained model; pass --ckpt_path")
    bench.run("test", tmp_path / "run", "--ckpt_path", "shipped").refused("trained at 256 pixels, not 32")
    bad = tmp_path.parent / f"{tmp_path.name}.safetensors"
    bad.write_bytes(weights.read_bytes()[:-9000])
    predict("--ckpt_path", bad).refused(f"{bad} is damaged or no safetensors")
    bench.run("test", tmp_path / "run", "--ckpt_path", bad).refused(f"{bad} is damaged or no safetensors")
    assert left_in(tmp_path) == before
