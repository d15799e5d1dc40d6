"""Documented import paths of the release before: they lead to the same classes, and say so."""

import subprocess
import sys

import pytest

MOVED = (
    ("normalgan.rendering.animals", "normalgan.animals", "Animal"),
    ("normalgan.inference.session", "normalgan.painting.session", "Model"),
    ("normalgan.inference.height", "normalgan.painting.height", "integrate"),
)


@pytest.mark.parametrize(("old", "new", "name"), MOVED)
def test_an_old_path_leads_to_the_same_and_warns(old: str, new: str, name: str) -> None:
    code = (
        "import warnings\nwith warnings.catch_warnings(record=True) as seen:\n"
        "    warnings.simplefilter('always')\n"
        f"    from {old} import {name} as old\nfrom {new} import {name} as new\n"
        "print(old is new, [w.category.__name__ for w in seen if 'normalgan' in str(w.message)])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True ['DeprecationWarning']\n"
