"""The parent's side of decoding: child processes, which are reused, and ended when they fail."""

import atexit
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib.util import find_spec
from multiprocessing import Pipe
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from normalgan.decoding.decoders.opening import DTYPES, MOST_PARTS, MOST_PIXELS
from normalgan.decoding.decoders.worker import needed
from normalgan.decoding.results import (
    Decoded,
    DecodedFrames,
    DecodedLayer,
    DecodedLayers,
    FileNotes,
    LayerNote,
)
from normalgan.decoding.time_limit import time_limit
from normalgan.errors import InputError, RunError

T = TypeVar("T")
CPU_SECONDS = 10
"""Limit of processor time per picture, in seconds."""
MEMORY = 2**31
"""Memory limit for decoding a picture in bytes, in addition to that of the libraries."""
WALL_SECONDS = 60.0
"""Limit of wall-clock time per picture in seconds, longer to allow for a busy machine."""
_MOST_WORDS = 4096
"""Maximum number of characters of a text from a child, which sends at most `_MOST_NOTES` about a picture."""
_MOST_HEADER = 2**20
"""Maximum size of a message without pixels, in bytes."""
_CHILD_ERRORS = (EOFError, OSError, ValueError, KeyError, TypeError)
"""Exceptions raised if a child has ended or sends invalid messages."""


def decode(
    name: str,
    content: bytes,
    sides: tuple[int, int],
    svg_side: int,
    longest: int | None = None,
    grey: bool = False,
    exact: bool = False,
) -> Decoded:
    """Return the pixels of a picture, upright; an SVG is rendered, transparent where it is empty.

    Args:
        name: name of the picture in errors.
        content: content of the file.
        sides: minimum and maximum side in pixels.
        svg_side: longer side of the rendering of an SVG, in pixels.
        longest: longer side in pixels to which larger pictures are downsampled.
        grey: whether to return only the brightness on white paper, (H, W).
        exact: whether to return the stored levels, including 16 bits per channel and floats, without
            downsampling.

    Raises:
        InputError: if the picture cannot be decoded; the message gives the reason.
        RunError: if no decoding process can be started.
    """
    more = {"svg_side": svg_side, "longest": longest or 0, "grey": grey, "exact": exact}
    return _pool.run(needed(content, exact), _Question("picture", name, content, sides, _picture, more))


def decode_frames(name: str, content: bytes, sides: tuple[int, int]) -> DecodedFrames:
    """Return all frames of an animation as full pictures; arguments and errors are those of `decode`."""
    return _pool.run(needed(content), _Question("frames", name, content, sides, _frames))


def decode_layers(name: str, content: bytes, sides: tuple[int, int]) -> DecodedLayers:
    """Return the visible layers of a layered file; arguments and errors are those of `decode`."""
    return _pool.run(needed(content), _Question("layers", name, content, sides, _layers))


def decode_tileset(name: str, content: bytes, sides: tuple[int, int]) -> tuple[Decoded, tuple[int, int]]:
    """Return the tiles of an Aseprite file's first visible tilemap, stacked vertically, and a tile's size.

    Arguments and errors are those of `decode`.
    """
    return _pool.run(needed(content), _Question("tileset", name, content, sides, _tileset))


def start() -> None:
    """Start the process for the first picture without waiting for it."""
    _pool.start()


_Answer = tuple[dict[str, Any], list[tuple[dict[str, Any], Decoded]]]
"""The child's header of a file, and the headers of its pictures with their pixels."""


@dataclass(frozen=True)
class _Question(Generic[T]):
    """A request to a child.

    Args:
        what: type of the request: ``picture``, ``frames``, ``layers`` or ``tileset``.
        name: name of the file in errors.
        content: content of the file.
        sides: minimum and maximum side in pixels.
        read: function that converts the child's answer to the result, or raises one of `_CHILD_ERRORS` if it
            is invalid.
        more: additional decoding options.
    """

    what: str
    name: str
    content: bytes
    sides: tuple[int, int]
    read: Callable[[_Answer, int], T]
    more: dict[str, Any] = field(default_factory=dict)


def _picture(answer: _Answer, most: int) -> Decoded:
    said, ((_, found),) = answer
    return replace(found, notes=_notes(said))


def _frames(answer: _Answer, most: int) -> DecodedFrames:
    said, found = answer
    durations = [_whole(header["duration"], 0, 2**32) for header, _ in found]
    return DecodedFrames(
        [frame for _, frame in found], durations, _whole(said["loop"], 0, 2**16), _notes(said)
    )


def _layers(answer: _Answer, most: int) -> DecodedLayers:
    said, found = answer
    height, width = (_whole(side, 1, most) for side in said["full"])
    durations = [_whole(each, 0, 2**32) for each in said["durations"]]
    layers = []
    for header, decoded in found:
        if decoded.pixels.dtype != np.uint8 or decoded.pixels.shape[2:] != (4,):
            raise EOFError
        pixels = np.asarray(decoded.pixels, np.uint8)
        *groups, own = map(_printable, header["names"])
        place = (
            _whole(header["left"], 0, width - pixels.shape[1]),
            _whole(header["top"], 0, height - pixels.shape[0]),
            _whole(header["number"], 0, 2**16),
            _whole(header["frame"], 0, len(durations) - 1),
        )
        opacity, base = _whole(header["opacity"], 0, 255), _whole(header["base"], -1, 2**16)
        layers.append(DecodedLayer(own, tuple(groups), opacity, *place, pixels, base))
    return DecodedLayers((height, width), durations, layers, _notes(said))


def _tileset(answer: _Answer, most: int) -> tuple[Decoded, tuple[int, int]]:
    said, ((_, found),) = answer
    width, height = (_whole(side, 1, most) for side in said["tile"])
    return found, (width, height)


class _Child:
    """A process that decodes pictures one at a time.

    Args:
        needs: additional library besides Pillow, as returned by `decoders.worker.needed`.
    """

    def __init__(self, needs: str) -> None:
        self.needs = needs
        self._connection, theirs = Pipe()
        handle = theirs.fileno()
        passed: dict[str, Any] = {"pass_fds": [handle]}
        if sys.platform == "win32":
            os.set_handle_inheritable(handle, True)
            passed = {"close_fds": False, "creationflags": subprocess.CREATE_NO_WINDOW}
        given = (_HERE, str(handle), needs, str(CPU_SECONDS), str(MEMORY), *_folders())
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-S", "-c", _PROGRAM, *given],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env={key: os.environ[key] for key in _ENVIRONMENT if key in os.environ}
                | _KEPT_MEMORY
                | _ONE_THREAD,
                **passed,
            )
        except OSError as error:
            self._connection.close()
            raise RunError(f"no process can be started to decode pictures: {error.strerror}.") from None
        finally:
            theirs.close()
        self._ready = False

    def ask(self, question: _Question[T]) -> T:
        """Return the answer; if any error except a refusal is raised, the process has ended."""
        with time_limit(WALL_SECONDS, self._process.kill) as late:
            try:
                if not self._ready:
                    self._greet()
                request = {"what": question.what, "sides": question.sides, **question.more}
                self._connection.send_bytes(json.dumps(request).encode())
                self._connection.send_bytes(question.content)
                most = question.sides[1]
                return question.read(self._answer(question.name, most), most)
            except RunError:
                self.close()
                raise
            except InputError:
                raise
            except _CHILD_ERRORS:
                self.close()
                reason = self._reason(late.is_set())
                raise InputError(f"{question.name} cannot be decoded: {reason}.") from None

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        self._connection.close()

    @property
    def ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def _greet(self) -> None:
        """Wait until the process is ready to decode."""
        try:
            header = json.loads(self._connection.recv_bytes(_MOST_HEADER))
            words = _printable(header["refused"]) if "refused" in header else ""
        except _CHILD_ERRORS:
            self._process.kill()
            words = f"it ended with {self._process.wait()}"
        if words:
            raise RunError(f"the process that decodes pictures does not start: {words}.")
        self._ready = True

    def _answer(self, name: str, most: int) -> _Answer:
        """Return the child's headers and pixels, within the limits of a drawing."""
        said = self._header(name)
        found, pixels = [], 0
        for _ in range(_whole(said["count"], 1, MOST_PARTS)):
            header = self._header(name)  # or a refusal
            decoded = self._pixels(header, most)
            pixels += decoded.pixels.shape[0] * decoded.pixels.shape[1]
            if pixels > MOST_PIXELS:
                raise EOFError
            found.append((header, decoded))
        return said, found

    def _header(self, name: str) -> dict[str, Any]:
        """Return a header from the child.

        Raises:
            InputError: if the child refuses the file.
        """
        header: dict[str, Any] = json.loads(self._connection.recv_bytes(_MOST_HEADER))
        if "refused" in header:
            raise InputError(f"{name} {_printable(header['refused'])}.")
        return header

    def _pixels(self, header: dict[str, Any], most: int) -> Decoded:
        height, width, *channels = header["shape"]
        height, width = _whole(height, 1, most), _whole(width, 1, most)
        full_height, full_width = (_whole(side, 1, most) for side in header["full"])
        if header["dtype"] not in DTYPES or channels not in ([], [3], [4]):
            raise EOFError
        pixels: NDArray[Any] = np.empty((height, width, *channels), header["dtype"])
        view = pixels.data.cast("B")
        while view:
            strip = self._connection.recv_bytes(len(view))
            view[: len(strip)] = strip
            view = view[len(strip) :]
        return Decoded(pixels, (full_height, full_width))

    def _reason(self, late: bool) -> str:
        code = self._process.returncode
        if late:
            return f"it takes more than {WALL_SECONDS:.0f} seconds"
        if code == -getattr(signal, "SIGXCPU", 0):
            return f"it takes more than {CPU_SECONDS} seconds of processor time"
        crash = (
            signal.Signals(-code).name if code < 0 and -code in set(signal.Signals) else f"exit code {code}"
        )
        return f"its decoder crashed ({crash})"


class _Pool:
    """Idle children that are reused for the next pictures, as many as ran at once, up to a limit."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._turns = threading.BoundedSemaphore(most)
        self._lock = threading.Lock()
        self._idle: list[_Child] = []

    def start(self) -> None:
        """Start a child if there is none."""
        with self._lock:
            if not self._idle:
                self._idle.append(_Child(""))

    def run(self, needs: str, question: _Question[T]) -> T:
        """Ask an idle child that has the needed libraries, and return its answer."""
        with self._turns:
            child = self._take(needs)
            try:
                return child.ask(question)
            finally:
                if child.ended:
                    child.close()
                else:
                    with self._lock:
                        self._idle.append(child)

    def close(self) -> None:
        """End the idle children."""
        with self._lock:
            while self._idle:
                self._idle.pop().close()

    def _take(self, needs: str) -> _Child:
        with self._lock:
            for ended in [each for each in self._idle if each.ended]:  # killed while idle
                self._idle.remove(ended)
                ended.close()
            if child := next((each for each in self._idle if each.needs == needs), None):
                self._idle.remove(child)
                return child
            if len(self._idle) >= self._most:  # all idle children have other libraries
                self._idle.pop(0).close()
        return _Child(needs)


def _folders() -> list[str]:
    """Return the folders of the decoding libraries; the child has no access to other packages."""
    found = [find_spec(name) for name in ("PIL", "resvg_py", "psd_tools", "cv2", "numpy", "pillow_heif")]
    origins = [spec.origin for spec in found if spec is not None and spec.origin is not None]
    return list(dict.fromkeys(str(Path(origin).parents[1]) for origin in origins))


def _whole(value: Any, least: int, most: int) -> int:
    """Return an integer from a child, or raise `EOFError` if it is not an integer in the range."""
    if type(value) is not int or not least <= value <= most:
        raise EOFError
    return value


def _notes(said: dict[str, Any]) -> FileNotes:
    """Return the notes on differences from the original program's rendering; empty for an animation."""
    layers = [LayerNote(_printable(name), _printable(reason)) for name, reason in said.get("notes", ())]
    return FileNotes(_printable(said.get("note", "")), said.get("partial") is True, tuple(layers))


def _printable(words: str) -> str:
    """Return the child's text as one printable line."""
    return "".join(each for each in words if each.isprintable())[:_MOST_WORDS]


def _forget() -> None:
    """Forget all children after a fork, because they belong to the parent process."""
    global _pool  # noqa: PLW0603
    _kept.append(_pool)  # otherwise the parent's connections would be closed and its children waited for
    _pool = _Pool(_MOST_CHILDREN)


def _close() -> None:
    _pool.close()


_HERE = str(Path(__file__).parent)
_PROGRAM = """
import sys
sys.path.append(sys.argv[1])
from decoders.worker import main
main(int(sys.argv[2]), sys.argv[3], int(sys.argv[4]), int(sys.argv[5]), sys.argv[6:])
"""
"""The child's program, which imports `decoders` without its parent package."""
_ENVIRONMENT = ("SYSTEMROOT", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "DYLD_FALLBACK_LIBRARY_PATH")
"""Environment variables for a child: only those that locate libraries, because others may hold secrets."""
_ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Disables the threads of NumPy's linear algebra, which a child does not need and which use memory."""
_KEPT_MEMORY = {"MALLOC_MMAP_THRESHOLD_": str(2**25), "MALLOC_TRIM_THRESHOLD_": str(2**26)}
"""Makes glibc keep up to 64 MiB for the next picture, because new pages take longer than decoding."""
_MOST_CHILDREN = max(2, min(os.cpu_count() or 1, 8))
"""Maximum number of children, at least two, so that strokes in the studio do not wait for an import."""
_kept: list[_Pool] = []
_pool = _Pool(_MOST_CHILDREN)
atexit.register(_close)
if sys.platform != "win32":
    os.register_at_fork(after_in_child=_forget)
