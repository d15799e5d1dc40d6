import warnings

import pytest

from normalgan.warning_filters import filter_warnings


@pytest.mark.parametrize(
    ("message", "said"),
    [
        ("old_setting is deprecated; use new_setting.", "normalgan: warning: old_setting is deprecated; "),
        ("set JSONARGPARSE_DEPRECATION_WARNINGS", ""),
        ("\n    instantiate_classes was deprecated in v4.49.0 and will be removed in v5.0.0", ""),
    ],
)
def test_deprecations_are_shown_but_for_those_between_libraries(
    capsys: pytest.CaptureFixture[str], message: str, said: str
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        filter_warnings()
        warnings.warn(message, DeprecationWarning, stacklevel=1)
    shown = capsys.readouterr().err
    assert shown.startswith(said)
    assert bool(shown) == bool(said)
