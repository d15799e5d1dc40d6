"""Documented import paths of the release before: they lead to the same classes, and say so."""

import subprocess
import sys
from importlib import import_module

import pytest

from interpreter import loaded
from normalgan.old_names import MOVED

USED = (
    ("normalgan.rendering.animals", "Animal", "normalgan.animals", "Animal"),
    ("normalgan.inference.session", "Model", "normalgan.painting.network.onnx_backend", "OnnxBackend"),
    ("normalgan.inference.painting", "paint", "normalgan.painting.pipeline", "paint"),
    ("normalgan.inference.height", "integrate", "normalgan.painting.heights.height", "integrate"),
    ("normalgan.painting.backend", "Backend", "normalgan.painting.network.backend", "Backend"),
    ("normalgan.painting.height", "integrate", "normalgan.painting.heights.height", "integrate"),
    ("normalgan.drawings", "read_hints", "normalgan.painting.reading.drawings", "read_hints"),
)


def test_old_paths_lead_to_the_same_and_warn() -> None:
    code = "import sys, warnings\n" + "".join(
        "for module in [name for name in sys.modules if name.startswith('normalgan.inference')]:\n"
        "    del sys.modules[module]\n"  # else only the first of its paths would warn
        "with warnings.catch_warnings(record=True) as seen:\n"
        "    warnings.simplefilter('always')\n"
        f"    from {old} import {was} as old\nfrom {new} import {name} as new\n"
        f"print('{old}', old is new, [w.category.__name__ for w in seen if 'normalgan' in str(w.message)])\n"
        for old, was, new, name in USED
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [f"{old} True ['DeprecationWarning']" for old, *_ in USED]


@pytest.mark.parametrize("old", MOVED)
def test_every_old_name_leads_to_the_same_and_warns(old: str) -> None:
    new = import_module(MOVED[old])
    sys.modules.pop(old, None)  # else only the first import would warn
    with pytest.warns(DeprecationWarning, match=rf"^{old} is now {MOVED[old]}; the old name goes"):
        former = import_module(old)
    assert new.__all__
    assert all(getattr(former, name) is getattr(new, name) for name in new.__all__)


def test_old_names_load_no_more_than_the_new_ones() -> None:
    seen = loaded("from normalgan.painting import height, onnx_backend, upsampling")
    assert "scipy" in seen
    assert "torch" not in seen
