"""Settings of training: the configurations that ship, single settings, and those that are written down."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from command import Bench, run

from normalgan.cli.training.command import resolved_settings
from normalgan.cli.training.trainer import SaveConfig
from normalgan.rendering.lines import LINE_DRAWINGS
from small import QUIET

CONFIGS = Path(__file__).parents[3] / "configs"
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
def test_a_configuration_that_ships_trains(bench: Bench, tmp_path: Path, names: tuple[str, ...]) -> None:
    outcome = run(
        "fit",
        *(part for name in names for part in ("--config", CONFIGS / f"{name}.yaml")),
        *("--data.meshes", bench.meshes, "--data.cache", bench.cache),
        *("--trainer.default_root_dir", tmp_path),
        *(part for name, value in SMALL.items() for part in (f"--{name}", value)),
    )
    assert outcome.code == 0, outcome.err
    assert (tmp_path / "checkpoints" / "last.ckpt").is_file()


@pytest.mark.slow
def test_the_varied_overlay_renders_in_every_style_there_is(bench: Bench, tmp_path: Path) -> None:
    few = ("--data.train_views", 2, "--data.val_views", 1, "--data.test_views", 1)
    done = bench.run(
        "render", tmp_path, "--config", CONFIGS / "lines_varied.yaml", "--data.cache", tmp_path, *few
    )
    assert done.code == 0, done.err
    (described,) = tmp_path.glob("*/dataset.json")
    lines = json.loads(described.read_text(encoding="utf-8"))["recipe"]["lines"]
    assert lines["class"] == "Mixture"
    assert len(lines["weights"]) == len(lines["styles"])
    assert {style["class"] for style in lines["styles"]} == set(LINE_DRAWINGS.names()) - {"Mixture"}
    assert {style["line_width"] for style in lines["styles"]} >= {0.8, 4.0}


@pytest.mark.filterwarnings(*QUIET)
@pytest.mark.parametrize("network", ["generator", "discriminator"])
def test_one_setting_of_an_optimiser_needs_no_named_class(network: str) -> None:
    settings = resolved_settings([f"--model.{network}_optimizer.init_args.lr", "1e-3"])
    optimizer = settings["model"][f"{network}_optimizer"]
    assert optimizer["class_path"] == "torch.optim.RMSprop"
    assert (optimizer["init_args"]["lr"], optimizer["init_args"]["alpha"]) == (1e-3, 0.9)


def test_config_yaml_says_the_batch_size_that_was_used(monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[int] = []
    config: dict[str, Any] = {"data": {"batch_size": 8}}
    callback = SaveConfig(parser=None, config=config, overwrite=True)  # type: ignore[arg-type]
    monkeypatch.setattr(
        "lightning.pytorch.cli.SaveConfigCallback.setup",
        lambda self, *_: written.append(self.config["data"]["batch_size"]),
    )
    for size in (8, 32):
        trainer: Any = SimpleNamespace(datamodule=SimpleNamespace(batch_size=size))
        callback.on_train_start(trainer, None)  # type: ignore[arg-type]
    assert written == [32]


@pytest.mark.filterwarnings("error:Unable to serialize")
@pytest.mark.parametrize(
    ("callback", "name", "value"),
    [("Timer", "interval", "step"), ("StochasticWeightAveraging", "device", "cpu")],
)
def test_settings_that_are_not_plain_values_are_saved_as_text(callback: str, name: str, value: str) -> None:
    rate = ["--trainer.callbacks.swa_lrs", "0.1"] if callback == "StochasticWeightAveraging" else []
    settings = resolved_settings(["--trainer.callbacks", callback, *rate])
    given = settings["trainer"]["callbacks"]
    (timer,) = given if isinstance(given, list) else [given]
    assert timer["init_args"][name] == value


@pytest.mark.slow
def test_a_run_can_be_trained_without_checkpoints(bench: Bench, tmp_path: Path) -> None:
    given = ("--trainer.enable_checkpointing", "false")
    done = bench.run("fit", tmp_path / "run", "--trainer.max_epochs", 1, *given)
    assert done.code == 0, done.err
    assert not [*tmp_path.rglob("*.ckpt")]
    assert (tmp_path / "run" / "config.yaml").is_file()
    own = ("--trainer.callbacks", "ModelCheckpoint")
    bench.run("fit", tmp_path / "other", *given, *own).refused("names ModelCheckpoint", "remove one")
