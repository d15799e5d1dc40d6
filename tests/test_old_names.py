"""Documented import paths of the release before: they lead to the same classes, and say so."""

import subprocess
import sys

import pytest

MOVED = (
    ("normalgan.rendering.animals", "Animal", "normalgan.animals", "Animal"),
    ("normalgan.inference.session", "Model", "normalgan.painting.onnx_backend", "OnnxBackend"),
    ("normalgan.inference.painting", "paint", "normalgan.painting.pipeline", "paint"),
    ("normalgan.inference.height", "integrate", "normalgan.painting.height", "integrate"),
)


@pytest.mark.parametrize(("old", "was", "new", "name"), MOVED)
def test_an_old_path_leads_to_the_same_and_warns(old: str, was: str, new: str, name: str) -> None:
    code = (
        "import warnings\nwith warnings.catch_warnings(record=True) as seen:\n"
        "    warnings.simplefilter('always')\n"
        f"    from {old} import {was} as old\nfrom {new} import {name} as new\n"
        "print(old is new, [w.category.__name__ for w in seen if 'normalgan' in str(w.message)])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True ['DeprecationWarning']\n"
