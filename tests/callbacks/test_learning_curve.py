import json
from pathlib import Path

import pytest

from normalgan.callbacks import LearningCurve
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET)


def images(folder: Path) -> list[int]:
    return [record["images"] for record in json.loads((folder / "curve.json").read_text())]


@pytest.mark.slow
def test_batches_with_which_the_generator_steps_count(meshes: Path, cache: Path, tmp_path: Path) -> None:
    for n_critic, expected in ((1, [6, 12, 18]), (2, [4, 6, 10]), (4, [2, 4, 6])):
        # Three batches of two an epoch; with n_critic 2 the generator steps at batches 0, 2 | 4 | 6, 8.
        folder = tmp_path / str(n_critic)
        curve = LearningCurve()
        run = trainer(folder, max_epochs=3, callbacks=[curve], num_sanity_val_steps=2)
        run.fit(gan(n_critic=n_critic), data(meshes, cache))
        assert images(folder) == expected
        assert curve.records[-1]["val/hints/angular_mean"] == pytest.approx(
            float(run.callback_metrics["val/hints/angular_mean"])
        )
        assert [record["epoch"] for record in curve.records] == [0, 1, 2]


def test_without_a_discriminator_every_batch_counts(meshes: Path, cache: Path, tmp_path: Path) -> None:
    model = gan(n_critic=5, discriminator=None)
    trainer(tmp_path, callbacks=[LearningCurve()]).fit(model, data(meshes, cache))
    assert images(tmp_path) == [6]


def test_a_resumed_run_goes_on(meshes: Path, cache: Path, tmp_path: Path) -> None:
    path = tmp_path / "last.ckpt"
    first = trainer(tmp_path, callbacks=[LearningCurve()])
    first.fit(gan(), data(meshes, cache))
    first.save_checkpoint(path)
    second = trainer(tmp_path, max_epochs=3, callbacks=[LearningCurve()])
    second.fit(gan(), data(meshes, cache), ckpt_path=path, weights_only=False)
    assert images(tmp_path) == [6, 12, 18]


def test_testing_leaves_the_curve_alone(meshes: Path, cache: Path, tmp_path: Path) -> None:
    run = trainer(tmp_path, callbacks=[LearningCurve()])
    run.validate(gan(), data(meshes, cache), verbose=False)
    assert not (tmp_path / "curve.json").exists()
