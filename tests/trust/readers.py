"""The program that reads hostile files: reader, bytes and seconds as arguments, paths on standard input."""

import json
import resource
import signal
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

from normalgan.errors import InputError


def mesh(path: Path) -> None:
    """Read a mesh as rendering does: its fingerprint first."""
    from normalgan.rendering.mesh_files import MeshFile

    MeshFile(str(path)).fingerprint()
    found = MeshFile(str(path)).load()
    assert found.faces.max() < len(found.vertices)


def rig(path: Path) -> None:
    """Read a pose of a rig as rendering does: its fingerprint first."""
    from normalgan.rendering.mesh_files import MeshFile
    from normalgan.rendering.rigs import RiggedFile, find_poses

    find_poses([MeshFile(str(path))], 1)
    RiggedFile(MeshFile(str(path)), 0).fingerprint()
    RiggedFile(MeshFile(str(path)), 0).load()


def configuration(path: Path) -> None:
    """Look at a configuration as every training command does first."""
    from normalgan.cli.parsing.config_files import check_config

    check_config(path, ("trainer", "data", "model"))


def drawing(path: Path) -> None:
    """Read a drawing."""
    from normalgan.inference.reading.drawings import read_drawing

    read_drawing(path)


def model(path: Path) -> None:
    """Predict an empty drawing with a model as ONNX."""
    import numpy as np

    from normalgan.inference.network.onnx_backend import OnnxBackend

    loaded = OnnxBackend(path, threads=1)
    normals, _ = loaded.predict(np.zeros((loaded.size, loaded.size), np.float32))
    assert normals.shape == (loaded.size, loaded.size, 3)
    assert np.isfinite(normals).all()


def hints(path: Path) -> None:
    """Read hints for a drawing of 32 × 32 pixels."""
    from normalgan.inference.reading.hint_files import load_hints

    load_hints(path, (32, 32))


def orientation(path: Path) -> None:
    """Read an orientation file."""
    from normalgan.rendering.mesh_files import read_orientations

    read_orientations(str(path))


def split(path: Path) -> None:
    """Read a split file that may name the meshes a to d."""
    from normalgan.data.splits import split_by_file

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of meshes it leaves out
        split_by_file(path, ["a", "b", "c", "d"])


def plan(path: Path) -> None:
    """Read the plan of a benchmark."""
    from normalgan.benchmark.plan import read_plan

    read_plan(path)


def checkpoint(path: Path) -> None:
    """Read the model in a checkpoint: as commands do that predict with it, and as `fit` does to go on."""
    from normalgan.weights.checkpoint import read_checkpoint

    found = read_checkpoint(path)
    found.weights(32)
    found.training_settings()


READERS: dict[str, Callable[[Path], None]] = {
    read.__name__: read
    for read in (*(mesh, rig, configuration, drawing, model, hints, orientation, split, plan), checkpoint)
}


def too_long(*_: object) -> None:
    """Turn the signal of the timer into an exception that no parser catches."""
    raise KeyboardInterrupt


def resident(what: str) -> int:
    """Return the bytes of memory that this process has (VmRSS), or had at most since it was asked (VmHWM)."""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.partition(f"{what}:")[2].split()[0])


def answer(read: Callable[[Path], None], path: Path, seconds: float) -> dict[str, object]:
    """Return what a reader made of a file."""
    Path("/proc/self/clear_refs").write_text("5")  # VmHWM counts from here
    before, outcome, words, start = resident("VmRSS"), "read", "", time.process_time()
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        read(path)
    except InputError as error:
        outcome, words = "refused", str(error)
    except KeyboardInterrupt:
        outcome, words = "broke", f"not done after {seconds} seconds"
    except BaseException as error:
        outcome, words = "broke", repr(error)[:300]
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return {
        "name": path.name,
        "outcome": outcome,
        "words": words,
        "seconds": time.process_time() - start,
        "memory": resident("VmHWM") - before,
    }


def main(name: str, memory: int, seconds: float) -> None:
    """Read all files."""
    if name == "checkpoint":
        import normalgan.weights.checkpoint  # takes seconds, and the libraries alone map gigabytes
    if name in {"mesh", "rig"}:
        import trimesh  # noqa: F401

        import normalgan.rendering.mesh_files  # not part of the first file's time
        import normalgan.rendering.rigs.posing
        import normalgan.rendering.rigs.reading
    if name == "model":
        import normalgan.inference.network.onnx_backend  # threads map stacks
    if name == "plan":
        import normalgan.benchmark.plan  # noqa: F401 -- the same
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (mapped + memory, mapped + memory))
    signal.signal(signal.SIGPROF, too_long)
    for line in sys.stdin.read().splitlines():
        print(json.dumps(answer(READERS[name], Path(line), seconds)), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3]))
