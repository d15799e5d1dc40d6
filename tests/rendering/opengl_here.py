"""Whether this machine has the OpenGL that PyrenderRenderer needs."""

import pytest

from needs import OPENGL
from normalgan.errors import InputError
from normalgan.rendering.renderers import PyrenderRenderer


def no_opengl() -> str:
    try:
        PyrenderRenderer().check()
    except InputError as error:
        return str(error)
    return ""


reason = no_opengl()
needs_opengl = pytest.mark.skipif(bool(reason), reason=OPENGL.reason(reason))
