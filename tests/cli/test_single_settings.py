"""One setting of an optimiser, where the configuration names none."""

import pytest

from normalgan.cli.training import resolved_settings
from small import QUIET

pytestmark = pytest.mark.filterwarnings(*QUIET)


@pytest.mark.parametrize("network", ["generator", "discriminator"])
def test_one_setting_of_an_optimiser_needs_no_named_class(network: str) -> None:
    settings = resolved_settings([f"--model.{network}_optimizer.init_args.lr", "1e-3"])
    optimizer = settings["model"][f"{network}_optimizer"]
    assert optimizer["class_path"] == "torch.optim.RMSprop"
    assert (optimizer["init_args"]["lr"], optimizer["init_args"]["alpha"]) == (1e-3, 0.9)
