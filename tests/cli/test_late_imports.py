import gc
import subprocess
import sys
from pathlib import Path

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


@pytest.mark.parametrize("with_triton", [True, False])
def test_objects_are_unfrozen_at_exit_if_triton_is_loaded(tmp_path: Path, with_triton: bool) -> None:
    """What nanobind holds was printed as leaked, a hundred lines after each training."""
    (tmp_path / ("triton.py" if with_triton else "another.py")).touch()
    code = f"""
import atexit, gc, sys
from normalgan.cli.late_imports import gc_paused
atexit.register(lambda: print(gc.get_freeze_count() == 0))
sys.path.insert(0, {str(tmp_path)!r})
with gc_paused():
    import {"triton" if with_triton else "another"}
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(with_triton)
