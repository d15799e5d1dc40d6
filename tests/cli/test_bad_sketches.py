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


def save_text(path: Path) -> None:
    path.write_text("no image")


# Each stops at another step; more in inference/reading/test_drawings.py, by the function that reads them.
BAD: dict[str, tuple[Callable[[Path], object], str]] = {
    "text": (save_text, "is not an image that can be read"),
    "white": (Image.new("L", (40, 40), 255).save, "no line is seen in it"),
}


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_sketch_is_named_and_the_others_are_painted(
    predict: Callable[..., Outcome], tmp_path: Path, kind: str
) -> None:
    save, reason = BAD[kind]
    save(tmp_path / "sketches" / "bad.png")
    predict().refused(str(tmp_path / "sketches" / "bad.png"), reason)  # it is the only one
    assert not (tmp_path / "maps").exists()
    Image.fromarray(drawing()).save(tmp_path / "sketches" / "good.png")
    outcome = predict()
    assert outcome.code == 1
    first, *_, last = outcome.err.splitlines()
    assert first.startswith(f"normalgan: {tmp_path / 'sketches' / 'bad.png'}")
    assert reason in first
    assert last == "normalgan: 1 of 2 sketches could not be used."
    assert left_in(tmp_path / "maps") == ["good_normal.png"]


def test_sketches_that_are_not_there(predict: Callable[..., Outcome], tmp_path: Path) -> None:
    predict().refused("no sketch found at", "sketches")
    predict("--data.prediction.sketches", tmp_path / "gone.png").refused("no sketch found at", "gone.png")
    predict("--data.prediction.sketches", "null").refused(
        "predict needs drawings: --data.prediction.sketches"
    )
    assert not (tmp_path / "maps").exists()


def test_hints_that_cannot_be_used(predict: Callable[..., Outcome], tmp_path: Path) -> None:
    Image.fromarray(drawing()).save(tmp_path / "sketches" / "ring.png")
    hints = tmp_path / "hints"
    predict("--data.prediction.hints", hints).refused("there is no file or folder", "for the hints")
    hints.mkdir()
    predict("--data.prediction.hints", hints).refused("holds no hints for any sketch")
    # What else they may not be is asked of what reads them, in inference/reading/test_drawings.py.
    Image.new("RGBA", (40, 40), (128, 128, 128, 255)).save(hints / "ring_hints.png")
    predict("--data.prediction.hints", hints).refused("ring_hints.png", "is not a normal")
    assert not (tmp_path / "maps").exists()


def test_maps_that_cannot_be_written(predict: Callable[..., Outcome], tmp_path: Path) -> None:
    Image.fromarray(drawing()).save(tmp_path / "sketches" / "ring.png")
    (tmp_path / "file").touch()
    predict("--output.folder", tmp_path / "file" / "maps").refused("the normal maps cannot be written to")
