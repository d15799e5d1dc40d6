"""Each configuration that ships is trained with, as written but for the size of the data."""

from pathlib import Path

import pytest
from command import Bench, run

CONFIGS = Path(__file__).parents[2] / "configs"
SMALL = {
    **{"data.size": 64, "data.train_views": 2, "data.val_views": 1, "data.test_views": 1},
    **{"data.batch_size": 2, "data.storage.render_workers": 0},
    **{"trainer.accelerator": "cpu", "trainer.max_epochs": 1, "trainer.limit_train_batches": 2},
    **{"trainer.enable_progress_bar": "false", "model.lr_scheduler": "null"},
}


@pytest.mark.parametrize(
    "names",
    [
        ("ours",),
        *(
            pytest.param(names, marks=pytest.mark.slow)
            for names in (("ours", "tuned"), ("paper",), ("pix2pix",), ("sketch2normal",), ("deepnormals",))
        ),
    ],
    ids="+".join,
)
def test_it_trains(bench: Bench, tmp_path: Path, names: tuple[str, ...]) -> None:
    outcome = run(
        "fit",
        *(part for name in names for part in ("--config", CONFIGS / f"{name}.yaml")),
        *("--data.meshes", bench.meshes, "--data.cache", bench.cache),
        *("--trainer.default_root_dir", tmp_path),
        *(part for name, value in SMALL.items() for part in (f"--{name}", value)),
    )
    assert outcome.code == 0, outcome.err
    assert (tmp_path / "checkpoints" / "last.ckpt").is_file()
