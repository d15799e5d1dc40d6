from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from lightning.pytorch import LightningModule
from lightning.pytorch.loggers import CSVLogger, TensorBoardLogger
from numpy.typing import NDArray
from PIL import Image
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator  # type: ignore[import-untyped]

from normalgan.callbacks import PictureLogger
from normalgan.callbacks.gallery import batch_row, draw_gallery
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET)

TAG = "val/gallery"


def logged(folder: Path) -> EventAccumulator:
    events = EventAccumulator(str(folder), size_guidance={"images": 0})
    events.Reload()
    return events


def pixels(png: bytes) -> NDArray[np.int64]:
    with Image.open(BytesIO(png)) as image:
        return np.asarray(image.convert("RGB"), np.int64)


@pytest.mark.slow
def test_a_picture_every_n_epochs(meshes: Path, cache: Path, tmp_path: Path) -> None:
    model, module = gan(), data(meshes, cache)
    logger = TensorBoardLogger(tmp_path, name="", version="")
    pictures = PictureLogger(every_n_epochs=2, samples=4)
    trainer(tmp_path, max_epochs=4, logger=logger, callbacks=[pictures]).fit(model, module)
    events = logged(tmp_path).Images(TAG)
    assert [event.step for event in events] == [
        1,
        3,
    ]  # epochs count from 0; the check before training is none
    # After the last epoch the weights are those it was drawn with.
    batch = next(iter(module.val_dataloader()))
    hints = model.measured_hints(batch)
    preds = model.eval()(batch["sketch"], hints)
    expected = draw_gallery([batch_row(batch, i, hints, preds) for i in range(2)])
    with (
        Image.open(BytesIO(events[-1].encoded_image_string)) as shown,
        Image.open(BytesIO(expected)) as drawn,
    ):
        assert (shown.width, shown.height) == drawn.size
        difference = np.abs(np.asarray(shown.convert("RGB"), int) - np.asarray(drawn.convert("RGB"), int))
    assert (difference > 1).mean() < 1e-3


def test_without_tensorboard_nothing_is_drawn(
    meshes: Path, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("normalgan.callbacks.pictures.draw_gallery", None)
    run = trainer(tmp_path, logger=CSVLogger(tmp_path), callbacks=[PictureLogger(every_n_epochs=1)])
    run.fit(gan(), data(meshes, cache))
    assert run.current_epoch == 1


def test_other_models_are_refused(tmp_path: Path) -> None:
    class Other(LightningModule):
        pass

    run = trainer(tmp_path, logger=TensorBoardLogger(tmp_path))
    with pytest.raises(TypeError, match="not a Other"):
        PictureLogger(every_n_epochs=1).on_validation_batch_end(run, Other(), None, {}, 0)  # type: ignore[typeddict-item]
