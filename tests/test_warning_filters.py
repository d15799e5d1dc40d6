import logging
import warnings

import pytest

from normalgan.warning_filters import filter_warnings


@pytest.mark.parametrize("category", [DeprecationWarning, FutureWarning])
@pytest.mark.parametrize(
    ("module", "shown"),
    [("lightning.pytorch.cli", False), ("torch.utils._pytree", False), ("my_sampler", True)],
)
def test_deprecations_are_shown_but_for_those_between_libraries(
    capsys: pytest.CaptureFixture[str], category: type[Warning], module: str, shown: bool
) -> None:
    message = "instantiate_classes was deprecated in v4.49.0 and will be removed in v5.0.0"
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        filter_warnings()
        warnings.warn_explicit(message, category, f"{module}.py", 1, module=module)
    assert capsys.readouterr().err == (f"normalgan: warning: {message}\n" if shown else "")


@pytest.mark.parametrize("name", ["lightning.pytorch.utilities.rank_zero", "lightning.fabric.utilities.seed"])
def test_lightning_says_things_once_and_in_our_words(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr(logging.getLogger("lightning"), "handlers", [logging.StreamHandler()])
    with warnings.catch_warnings():
        filter_warnings()
        logging.getLogger(name).info("Seed set to 0")
        logging.getLogger(name).info("the profiler measured")
    assert capsys.readouterr().err == "normalgan: the profiler measured\n"
