import gc
import sys

import pytest

from normalgan.cli.late_imports import gc_paused


def test_the_collector_is_as_before_whatever_happens() -> None:
    assert gc.isenabled()
    with pytest.raises(ImportError), gc_paused():
        import no_module_of_this_name  # type: ignore[import-not-found]  # noqa: F401
    assert gc.isenabled()
    gc.disable()
    try:
        with gc_paused():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_only_imported_objects_are_frozen(monkeypatch: pytest.MonkeyPatch) -> None:
    gc.unfreeze()
    with gc_paused():
        pass
    assert gc.get_freeze_count() == 0
    with gc_paused():
        monkeypatch.setitem(sys.modules, "a_new_module", sys)
    assert gc.get_freeze_count() > 0
    gc.unfreeze()
