import gc
import sys

import pytest

from normalgan.cli.late_imports import nothing_collected


def test_the_collector_is_as_before_whatever_happens() -> None:
    assert gc.isenabled()
    with pytest.raises(ImportError), nothing_collected():
        import no_module_of_this_name  # type: ignore[import-not-found]  # noqa: F401
    assert gc.isenabled()
    gc.disable()
    try:
        with nothing_collected():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_what_was_imported_is_passed_over_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    gc.unfreeze()
    with nothing_collected():
        pass
    assert gc.get_freeze_count() == 0
    with nothing_collected():
        monkeypatch.setitem(sys.modules, "a_new_module", sys)
    assert gc.get_freeze_count() > 0
    gc.unfreeze()
