"""One setting of an optimiser, where the configuration names none; the batch size that was used."""

from types import SimpleNamespace
from typing import Any

import pytest

from normalgan.cli.trainer import SaveConfig
from normalgan.cli.training import resolved_settings
from small import QUIET

pytestmark = pytest.mark.filterwarnings(*QUIET)


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
