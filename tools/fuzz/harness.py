"""Harness: one function from bytes to None, called by atheris with what it makes up, or once with files.

python tools/fuzz/fuzz_mesh.py FILE...                 calls it once with each file, without atheris
python tools/fuzz/fuzz_mesh.py --fuzz CORPUS [-flag]   fuzzes, as libFuzzer is called
"""

import resource
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path

FUZZ = "--fuzz"
MEMORY = 2 * 2**30
"""Bytes of address space on top of what the libraries map, as in tests/trust/limited.py."""
SECONDS = 600
"""Of processor time that what limits itself may use in a fuzzer, which has its own clock for each input."""
_folder = tempfile.TemporaryDirectory(prefix="fuzz-")


def instrumented(*packages: str) -> AbstractContextManager[object]:
    """Have what is imported meanwhile tell atheris which branches are taken, if it is fuzzed.

    Args:
        packages: that are of interest beside normalgan.
    """
    if FUZZ not in sys.argv:
        return nullcontext()
    import atheris

    made: AbstractContextManager[object] = atheris.instrument_imports(include=["normalgan", *packages])
    return made


@contextmanager
def refusals() -> Iterator[None]:
    """Take a refusal for an answer, if it is one sentence.

    Raises:
        AssertionError: if it is not.
        Exception: any other than a refusal, as it is raised.
    """
    from normalgan.errors import InputError

    try:
        yield
    except InputError as error:
        words = str(error)
        if "\n" in words or len(words) > 1000:
            raise AssertionError(f"no sentence: {words!r}") from error


def as_file(data: bytes, name: str) -> Path:
    """Return a file with these bytes; there is one of each name at a time."""
    path = Path(_folder.name) / name
    path.write_bytes(data)
    return path


def run(read: Callable[[bytes], None]) -> None:
    """Fuzz a function or call it once with each file, as the command line says.

    Raises:
        Exception: that the function raises; then the file's name is on the error stream.
    """
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (mapped + MEMORY, mapped + MEMORY))
    if FUZZ in sys.argv:
        import atheris

        arguments = [argument for argument in sys.argv if argument != FUZZ]
        atheris.Setup(arguments, read, enable_python_coverage=True)
        atheris.Fuzz()
        return
    for name in sys.argv[1:]:
        print(name, file=sys.stderr, flush=True)
        read(Path(name).read_bytes())
    print(f"{len(sys.argv) - 1} files")
