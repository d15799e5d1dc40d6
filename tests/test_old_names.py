"""Documented import paths of the release before: they lead to the same classes, and say so."""

import subprocess
import sys

MOVED = (
    ("normalgan.rendering.animals", "Animal", "normalgan.animals", "Animal"),
    ("normalgan.inference.session", "Model", "normalgan.painting.onnx_backend", "OnnxBackend"),
    ("normalgan.inference.painting", "paint", "normalgan.painting.pipeline", "paint"),
    ("normalgan.inference.height", "integrate", "normalgan.painting.height", "integrate"),
)


def test_old_paths_lead_to_the_same_and_warn() -> None:
    code = "import sys, warnings\n" + "".join(
        "for module in [name for name in sys.modules if name.startswith('normalgan.inference')]:\n"
        "    del sys.modules[module]\n"  # else only the first of its paths would warn
        "with warnings.catch_warnings(record=True) as seen:\n"
        "    warnings.simplefilter('always')\n"
        f"    from {old} import {was} as old\nfrom {new} import {name} as new\n"
        f"print('{old}', old is new, [w.category.__name__ for w in seen if 'normalgan' in str(w.message)])\n"
        for old, was, new, name in MOVED
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [f"{old} True ['DeprecationWarning']" for old, *_ in MOVED]
