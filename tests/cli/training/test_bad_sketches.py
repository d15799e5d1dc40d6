from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from command import Outcome, left_in, run
from numpy.typing import NDArray
from PIL import Image


@pytest.fixture
def predict(trained: Path, tmp_path: Path) -> Callable[..., Outcome]:
    """The command, on the sketches in a folder, or on others; it needs no other settings."""
    (tmp_path / "sketches").mkdir()
    checkpoint = trained / "checkpoints" / "last.ckpt"

    def predict(*arguments: object) -> Outcome:
        return run(
            *("predict", "--ckpt_path", checkpoint, "--data.size", 32, "--output.folder", tmp_path / "maps"),
            *("--trainer.accelerator", "cpu", "--trainer.enable_progress_bar", "false"),
            *("--data.prediction.sketches", tmp_path / "sketches", *arguments),
        )

    return predict


def drawing(size: int = 40) -> NDArray[np.uint8]:
    """A ring on white paper."""
    y, x = np.mgrid[:size, :size] - size / 2 + 0.5
    return np.where(np.abs(np.hypot(x, y) - size / 3) < 1.5, 0, 255).astype(np.uint8)


def test_a_bad_sketch_is_named_and_the_others_are_painted(
    predict: Callable[..., Outcome], tmp_path: Path
) -> None:
    # What else may be wrong with one is asked of what reads it, in inference/reading/test_drawings.py.
    bad, reason = tmp_path / "sketches" / "bad.png", "is not an image that can be read"
    bad.write_text("no image")
    predict().refused(str(bad), reason)  # it is the only one
    assert not (tmp_path / "maps").exists()
    Image.fromarray(drawing()).save(tmp_path / "sketches" / "good.png")
    outcome = predict()
    assert outcome.code == 1
    first, *_, last = outcome.err.splitlines()
    assert first.startswith(f"normalgan: {bad}")
    assert reason in first
    assert last == "normalgan: 1 of 2 sketches could not be used."
    assert left_in(tmp_path / "maps") == ["good_normal.png"]


def test_without_sketches_it_says_how_to_name_them(predict: Callable[..., Outcome]) -> None:
    predict("--data.prediction.sketches", "null").refused(
        "predict needs drawings: --data.prediction.sketches"
    )


def test_maps_that_cannot_be_written(predict: Callable[..., Outcome], tmp_path: Path) -> None:
    Image.fromarray(drawing()).save(tmp_path / "sketches" / "ring.png")
    (tmp_path / "file").touch()
    predict("--output.folder", tmp_path / "file" / "maps").refused("the normal maps cannot be written to")
