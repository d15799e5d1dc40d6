import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from jsonargparse import auto_cli
from opengl_here import needs_opengl

from normalgan.rendering.renderers import RENDERERS, EmbreeRenderer, PyrenderRenderer, Renderer


def test_renderers_are_plug_ins_that_travel() -> None:
    assert {"EmbreeRenderer", "PyrenderRenderer"} <= set(RENDERERS.names())
    for renderer in (EmbreeRenderer(), PyrenderRenderer()):
        assert pickle.loads(pickle.dumps(renderer)) == renderer
    EmbreeRenderer().check()


def test_a_renderer_can_be_named_on_the_command_line() -> None:
    def command(renderer: Renderer) -> Renderer:
        return renderer

    assert auto_cli(command, args=["--renderer=PyrenderRenderer"], as_positional=False) == PyrenderRenderer()


CHECK = "from normalgan.rendering import PyrenderRenderer\n{}PyrenderRenderer().check()"


@pytest.mark.parametrize(
    ("platform", "before", "message"),
    [
        ("glx", "", "through EGL, but PYOPENGL_PLATFORM is 'glx': unset it, or choose EmbreeRenderer."),
        # No libEGL on the machine: ctypes finds none.
        (
            "egl",
            "import ctypes, ctypes.util\n"
            "ctypes.util.find_library = lambda name: None\n"
            "def missing(*args, **kwargs): raise OSError('cannot open shared object file')\n"
            "ctypes.CDLL = missing\nctypes.cdll.LoadLibrary = missing\n",
            "install libegl1 and libgl1 (Debian, Ubuntu), or choose EmbreeRenderer.",
        ),
    ],
)
def test_a_machine_without_egl_is_told_what_to_install(platform: str, before: str, message: str) -> None:
    environment = {**os.environ, "PYOPENGL_PLATFORM": platform}
    script = CHECK.format(before)
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=False
    )
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("normalgan.errors.InputError: PyrenderRenderer needs OpenGL through EGL")
    assert last.endswith(message)


@pytest.mark.slow
@needs_opengl
def test_a_process_that_rendered_ends_quietly_and_may_fork() -> None:
    script = (
        "import multiprocessing as mp, sys\n"
        "sys.path[:0] = sys.argv[1:]\n"
        "from mesh_shapes import camera_at, ellipsoid\n"
        "from normalgan.rendering import PyrenderRenderer\n"
        "def draw(_): return float(PyrenderRenderer().render(mesh, camera_at(mesh), 32).depth.min())\n"
        "mesh = ellipsoid(1, 1, 1, 2)\n"
        "here = draw(0)\n"
        "with mp.get_context('fork').Pool(1) as pool:\n"
        "    assert pool.map_async(draw, [0]).get(timeout=30) == [here]\n"
    )
    environment = {name: value for name, value in os.environ.items() if name != "LP_NUM_THREADS"}
    here = Path(__file__).parent
    done = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "-c", script, here, here.parent],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
        timeout=100,
    )
    assert (done.returncode, done.stderr) == (0, "")
