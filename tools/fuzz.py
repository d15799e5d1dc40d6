"""Fuzzes a reader with atheris: python tools/fuzz.py TARGET [--seconds N] [--corpus FOLDER].

With files after the target, it only reads each once, without atheris. A target fails if a reader raises
anything but a one-sentence refusal, or returns something that it does not promise.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from pathlib import Path
from pyexpat import ParserCreate
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "trust"))

from readers import READERS

FUZZ = "--fuzz"
TIMEOUT = 60
"""Time limit for one input in seconds, the same as for a child process of the product."""
MOST_BYTES = 2**20
"""Maximum bytes of an input; longer seeds are cut. A cut checkpoint is invalid, so most must fit."""
MEMORY = 2 * 2**30
"""Bytes of address space beyond what the libraries map, as in tests/trust/limited.py."""
SECONDS = 600
"""Seconds of processor time for code that limits itself; the fuzzer has its own clock for each input."""
LEAST, MOST = 8, 256
"""Minimum and maximum side in pixels of what is decoded."""
_folder = tempfile.TemporaryDirectory(prefix="fuzz-")

Read = Callable[[bytes], None]


def instrumented(*packages: str) -> AbstractContextManager[object]:
    """While fuzzing, make modules imported in this context report the branches they take to atheris."""
    if FUZZ not in sys.argv:
        return nullcontext()
    import atheris

    made: AbstractContextManager[object] = atheris.instrument_imports(include=["normalgan", *packages])
    return made


@contextmanager
def refusals() -> Iterator[None]:
    """Accept a refusal if it is one sentence.

    Raises:
        AssertionError: if it is not one sentence.
        Exception: any exception other than a refusal.
    """
    from normalgan.errors import InputError

    try:
        yield
    except InputError as error:
        words = str(error)
        if "\n" in words or len(words) > 1000:
            raise AssertionError(f"not one sentence: {words!r}") from error


def as_file(data: bytes, name: str) -> Path:
    """Return a file with these bytes; it replaces an earlier file of the same name."""
    path = Path(_folder.name) / name
    path.write_bytes(data)
    return path


def read_as(data: bytes, name: str, *readers: str) -> None:
    """Read a file with readers of `tests/trust/readers.py`, which may refuse it."""
    path = as_file(data, name)
    for reader in readers:
        with refusals():
            READERS[reader](path)


def drawing() -> Read:
    """Target: drawings, decoded in this process instead of a child so that Pillow's branches are visible."""
    with instrumented("PIL"):
        from PIL import Image

        from normalgan.decoding.decoders.opening import RefusedError, with_form
        from normalgan.decoding.decoders.pictures import decode
        from normalgan.decoding.decoders.svg import is_svg
    Image.init()  # its plug-ins

    def read(data: bytes) -> None:
        if is_svg(data):  # SVG has its own target
            return
        with suppress(RefusedError, MemoryError):
            image, full = decode(data, LEAST, 1024, 64, MOST, grey=bool(len(data) % 2), notes=[])
            assert all(LEAST <= side <= 1024 for side in full)
            assert max(with_form(image)["shape"][:2]) <= MOST

    return read


def svg() -> Read:
    """Target: SVG files, rewritten without outside references, then drawn in a child like users' files."""
    with instrumented():
        from normalgan.decoding.decoders.opening import RefusedError
        from normalgan.decoding.decoders.svg import sanitize_svg
        from normalgan.errors import InputError
        from normalgan.inference.reading.drawings import read_drawing

    def read(data: bytes) -> None:
        try:
            text = sanitize_svg(data, 1024)
        except (RefusedError, MemoryError):
            return
        check_svg(text)
        assert sanitize_svg(text.encode(), 1024) == text
        try:
            read_drawing(as_file(data, "drawing.svg"))
        except InputError as error:
            if "crashed" in str(error):
                raise AssertionError from error

    return read


def check_svg(text: str) -> None:
    """Raise `AssertionError` if an SVG refers to a file, or is nested too deeply."""
    from normalgan.decoding.decoders.svg import MOST_DEPTH

    depth = 0

    def start(_: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        assert depth <= MOST_DEPTH
        for key, value in attributes.items():
            if key.rpartition(":")[2] == "href":
                assert value.strip().lower().startswith(("#", "data:image/")), value[:80]

    def end(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser = ParserCreate()
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.Parse(text.encode(), True)


def layers() -> Read:
    """Target: layered files (PSD, KRA, ORA, Aseprite), with their composite, frames and layers."""
    with instrumented("psd_tools"):
        import psd_tools  # noqa: F401

        from normalgan.decoding.decoders import layered_files  # noqa: F401
        from normalgan.decoding.decoders.opening import MODES, RefusedError
        from normalgan.decoding.decoders.pictures import decode, frames
        from normalgan.decoding.decoders.pictures import layers as layers_of

    def read(data: bytes) -> None:
        aseprite = data[4:6] == b"\xe0\xa5"
        if data[:4] not in {b"8BPS", b"PK\x03\x04"} and not aseprite:
            return
        with suppress(RefusedError, MemoryError):
            image, full = decode(data, LEAST, MOST, 64, 0, False, [])
            assert image.mode in MODES
            assert image.size == full
        if aseprite:
            with suppress(RefusedError, MemoryError):
                check_frames([*frames(data, LEAST, MOST, SECONDS)])
        with suppress(RefusedError, MemoryError):
            check([*layers_of(data, LEAST, MOST, SECONDS)])

    def check(sent: list[Any]) -> None:
        (first, _), *found = sent
        height, width = first["full"]
        assert first["count"] == len(found) > 0
        for header, image in found:
            assert image.mode == "RGBA"
            assert header["shape"] == [image.height, image.width, 4]
            assert 0 <= header["left"] <= width - image.width
            assert 0 <= header["top"] <= height - image.height
            assert header["frame"] < len(first["durations"])

    return read


def check_frames(sent: list[Any]) -> None:
    """Raise `AssertionError` if frames are incomplete."""
    from normalgan.decoding.decoders.opening import MODES

    (first, _), *found = sent
    assert first["count"] == len(found) > 0
    for header, image in found:
        assert image.mode in MODES
        assert LEAST <= min(image.size) <= max(image.size) <= MOST
        assert header["full"] == [image.height, image.width]


def animation() -> Read:
    """Target: animations (GIF, WebP, PNG), whether they move, and their frames."""
    with instrumented("PIL"):
        from PIL import Image

        from normalgan.decoding.decoders.opening import RefusedError
        from normalgan.decoding.decoders.pictures import frames
        from normalgan.inference.composites.animation import moving_kind
    Image.init()  # its plug-ins

    def read(data: bytes) -> None:
        if not data.startswith((b"\x89PNG", b"GIF8", b"RIFF")):
            return
        with refusals():
            moving_kind(Path("animation"), data)
        with suppress(RefusedError, MemoryError):
            check_frames([*frames(data, LEAST, MOST, SECONDS)])

    return read


def mesh() -> Read:
    """Target: meshes, in the format that their first bytes indicate, and rigs."""
    starts = {b"OFF": "off", b"ply": "ply", b"solid": "stl", b"glTF": "glb", b"{": "gltf", b"\0": "stl"}
    with instrumented("trimesh"):
        import trimesh  # noqa: F401

        import normalgan.rendering.mesh_files
        import normalgan.rendering.rigs  # noqa: F401

    def read(data: bytes) -> None:
        kind = next((kind for start, kind in starts.items() if data.startswith(start)), "obj")
        read_as(data, f"mesh.{kind}", "mesh", *(["rig"] if kind in {"glb", "gltf"} else []))

    return read


def checkpoint() -> Read:
    """Target: checkpoints, read as for a prediction and as `fit` reads them to continue."""
    with instrumented():
        import normalgan.weights.checkpoint  # noqa: F401
    return lambda data: read_as(data, "model.ckpt", "checkpoint")


def weights() -> Read:
    """Target: safetensors files, and the generator that they describe."""
    with instrumented():
        from normalgan.weights.file import parse_weights

    def read(data: bytes) -> None:
        with refusals():
            parse_weights(data).generator()

    return read


def configuration() -> Read:
    """Target: YAML files, read as a configuration and as a plan."""
    with instrumented():
        import normalgan.benchmark.plan
        import normalgan.cli.parsing.config_files  # noqa: F401
    return lambda data: read_as(data, "file.yaml", "configuration", "plan")


def project() -> Read:
    """Target: JSON from the studio's page: a project to store, a drawing with hints and areas."""
    import numpy as np

    with instrumented():
        from normalgan.studio.drawings.drawing_request import DrawingRequest
        from normalgan.studio.drawings.schemas import DrawingFields, parse
        from normalgan.studio.projects.format import check_document
    picture = np.full((32, 32, 1), 255, np.uint8)

    def read(data: bytes) -> None:
        with refusals():
            assert check_document(data)["width"] > 0
        with refusals():
            taken = DrawingRequest.of(parse(DrawingFields, data), picture)
            taken.digest()
            taken.read_hints((32, 32))

    return read


def model() -> Read:
    """Target: ONNX models, which are checked, loaded and run on an empty drawing."""
    with instrumented():
        import normalgan.inference.network.onnx_backend  # noqa: F401
    return lambda data: read_as(data, "model.onnx", "model")


TARGETS = {
    target.__name__: target
    for target in (
        *(drawing, svg, layers, animation, mesh, checkpoint, weights, configuration, project, model),
    )
}


def read_all(target: str, files: list[str], flags: list[str]) -> None:
    """Read each file once, or fuzz with libFuzzer's flags, under a memory limit.

    Raises:
        Exception: any exception of the target, after the file's name was printed to the error stream.
    """
    read = TARGETS[target]()
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (mapped + MEMORY, mapped + MEMORY))
    if flags:
        import atheris

        atheris.Setup([sys.argv[0], *flags], read, enable_python_coverage=True)
        atheris.Fuzz()
    for name in files:
        print(name, file=sys.stderr, flush=True)
        read(Path(name).read_bytes())
    print(f"{len(files)} files")


def main() -> int:
    """Fuzz, and return 1 if a fault was found; the input that causes it lies in the working directory."""
    if sys.argv[1:2] == [FUZZ]:  # the fuzzing process, in which every import is instrumented
        read_all(sys.argv[2], [], sys.argv[3:])
        return 0
    parser = argparse.ArgumentParser(prog="tools/fuzz.py", description=__doc__.splitlines()[0])
    parser.add_argument("target", choices=TARGETS)
    parser.add_argument("files", nargs="*", help="read these once in place of fuzzing")
    parser.add_argument("--seconds", type=int, default=600, help="for all of it")
    parser.add_argument("--seed", type=int, default=1, help="of the changes")
    parser.add_argument("--corpus", type=Path, help="a folder that keeps interesting inputs for later runs")
    options = parser.parse_args()
    if options.files:
        read_all(options.target, options.files, [])
        return 0
    from fuzz_seeds import lay_out_seeds

    with tempfile.TemporaryDirectory(prefix="fuzz-") as temporary:
        kept = options.corpus or Path(temporary) / "kept"
        kept.mkdir(parents=True, exist_ok=True)
        seeds = Path(temporary) / "seeds"
        longest = max(path.stat().st_size for path in lay_out_seeds(seeds, options.target))
        flags = [f"-max_total_time={options.seconds}", f"-timeout={TIMEOUT}", f"-seed={options.seed}"]
        flags += [f"-max_len={min(longest, MOST_BYTES)}", "-rss_limit_mb=4096", "-print_final_stats=1"]
        command = [sys.executable, __file__, FUZZ, options.target, str(kept), str(seeds), *flags]
        return subprocess.call(command)


if __name__ == "__main__":
    sys.exit(main())
