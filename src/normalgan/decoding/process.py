"""The parent's side: child processes that decode, kept for the next picture and ended when they fail."""

import atexit
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from normalgan.decoding.worker import (
    DURATION,
    EXACT,
    FRAMES,
    LAYER,
    LAYERS,
    MODES,
    MOST_PARTS,
    MOST_PIXELS,
    NOTE,
    PARTS,
    PICTURE,
    PIXEL_BYTES,
    READY,
    REFUSED,
    REPLY,
    REQUEST,
)
from normalgan.errors import InputError, RunError

__all__ = [
    "MEMORY",
    "PATIENCE",
    "SECONDS",
    "Decoded",
    "DecodedLayer",
    "DecodedLayers",
    "Part",
    "Parts",
    "Pixels",
    "decode",
    "decode_frames",
    "decode_layers",
    "start",
]

T = TypeVar("T")
Pixels = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.int32] | NDArray[np.float32]
"""(H, W) grey of any of these types, or (H, W, 3) or (H, W, 4), red, green, blue and opacity, of 8 bits; as
stored, if that is asked for, also of 16 bits or floats."""

SECONDS = 10
"""Processor time for one picture."""
MEMORY = 2**31
"""Bytes that decoding one may take, on top of what the libraries map."""
PATIENCE = 60.0
"""Seconds by the clock for one picture; a busy machine gives it little processor time."""
_DTYPES = (
    *(np.uint8, np.uint8, np.uint8, np.uint16, np.int32, np.float32),
    *(np.uint16, np.uint16, np.float32, np.float32),
)
_CHANNELS = (1, 3, 4, 1, 1, 1, 3, 4, 3, 4)
_PIPE = 2**20
_WORDS = 4096


@dataclass(frozen=True)
class Decoded:
    """A picture's pixels, upright.

    Args:
        pixels: (h, w), (h, w, 3) or (h, w, 4).
        shape: (H, W) of the file; that of the pixels unless they were reduced.
        note: what of it is not shown as its program shows it, a part of a sentence; empty if all is.
    """

    pixels: Pixels
    shape: tuple[int, int]
    note: str = ""


@dataclass(frozen=True)
class Part:
    """One frame of an animation.

    Args:
        decoded: its pixels.
        duration: milliseconds that it is shown.
    """

    decoded: Decoded
    duration: int


@dataclass(frozen=True)
class Parts:
    """A file of several pictures.

    Args:
        parts: the frames.
        loop: how often they are shown; 0 is for ever.
        note: as `Decoded` has it.
    """

    parts: list[Part]
    loop: int
    note: str = ""


@dataclass(frozen=True)
class DecodedLayer:
    """A visible layer, or what it shows in one frame.

    Args:
        name: as the file has it.
        groups: names of those that it lies in, the outermost first.
        opacity: 0 to 255, with that of its groups; the pixels do not have it.
        left: column of the picture in which its first one lies.
        top: row of the picture in which its first one lies.
        number: of the layer, from the lowest up.
        frame: in which it shows this.
        pixels: (h, w, 4), all within the picture.
        clipped_to: number of the layer that it is clipped to, by which its pixels are cut; -1 if to none.
    """

    name: str
    groups: tuple[str, ...]
    opacity: int
    left: int
    top: int
    number: int
    frame: int
    pixels: NDArray[np.uint8]
    clipped_to: int = -1


@dataclass(frozen=True)
class DecodedLayers:
    """The visible layers of a layered file.

    Args:
        shape: (H, W) of the picture.
        durations: milliseconds that each frame is shown; one of 0 if it does not move.
        layers: frame by frame, in each the lowest first; those that nothing is drawn on are not among them.
        note: as `Decoded` has it.
    """

    shape: tuple[int, int]
    durations: list[int]
    layers: list[DecodedLayer]
    note: str = ""


def decode(
    name: str,
    content: bytes,
    sides: tuple[int, int],
    svg_side: int,
    longest: int | None = None,
    grey: bool = False,
    exact: bool = False,
) -> Decoded:
    """Return the pixels of a picture, upright; an SVG is drawn, transparent where it has nothing.

    Args:
        name: what to call it in an error.
        content: its file.
        sides: pixels that each side has at least and at most.
        svg_side: longer side in pixels that an SVG is drawn with.
        longest: longer side in pixels that a larger picture is reduced to.
        grey: whether only how bright it is on white paper is wanted, (H, W).
        exact: whether the levels are wanted as they are stored: colours of 16 bits a channel and floats too;
            such a picture is not reduced.

    Raises:
        InputError: if it cannot be decoded; it says why.
        RunError: if no process can be started to do it.
    """
    request = REQUEST.pack(len(content), *sides, svg_side, longest or 0, grey, EXACT if exact else PICTURE)
    return _pool.run(lambda child: child.decode(name, request, content, sides[1]))


def decode_frames(name: str, content: bytes, sides: tuple[int, int]) -> Parts:
    """Return all frames of an animation, each whole; arguments and errors are those of `decode`."""
    request = REQUEST.pack(len(content), *sides, sides[1], 0, False, FRAMES)
    return _pool.run(lambda child: child.decode_parts(name, request, content, sides[1]))


def decode_layers(name: str, content: bytes, sides: tuple[int, int]) -> DecodedLayers:
    """Return the visible layers of a layered file; arguments and errors are those of `decode`."""
    request = REQUEST.pack(len(content), *sides, sides[1], 0, False, LAYERS)
    return _pool.run(lambda child: child.decode_layers(name, request, content, sides[1]))


def start() -> None:
    """Start the process that the first picture needs, and do not wait for it."""
    _pool.start()


class _Child:
    """A process that decodes one picture after the other."""

    def __init__(self) -> None:
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-S", _WORKER, str(SECONDS), str(MEMORY), *_folders()],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                bufsize=0,
                env={key: os.environ[key] for key in _ENVIRONMENT if key in os.environ}
                | _KEPT_MEMORY
                | _ONE_THREAD,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
        except OSError as error:
            raise RunError(f"no process can be started to decode pictures: {error.strerror}.") from None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests, self._replies = self._process.stdin, self._process.stdout
        _widen(self._requests.fileno(), self._replies.fileno())
        self._ready = False

    def decode(self, name: str, request: bytes, content: bytes, most: int) -> Decoded:
        """Return the pixels of a picture; if anything but a refusal is raised, the process has ended."""
        return self._asked(name, request, content, lambda: self._receive(name, most))

    def decode_parts(self, name: str, request: bytes, content: bytes, most: int) -> Parts:
        """Return the parts of a file, as `decode` does."""
        return self._asked(name, request, content, lambda: self._receive_parts(name, most))

    def decode_layers(self, name: str, request: bytes, content: bytes, most: int) -> DecodedLayers:
        """Return the layers of a file, as `decode` does."""
        return self._asked(name, request, content, lambda: self._receive_layers(name, most))

    def _asked(self, name: str, request: bytes, content: bytes, receive: Callable[[], T]) -> T:
        late = threading.Event()

        def end() -> None:
            late.set()
            self._process.kill()

        clock = threading.Timer(PATIENCE, end)
        clock.daemon = True
        clock.start()
        try:
            if not self._ready:
                self._greet()
            self._send(request)
            self._send(content)
            return receive()
        except (EOFError, OSError):
            self.close()
            raise InputError(f"{name} cannot be decoded: {self._reason(late.is_set())}.") from None
        except RunError:
            self.close()
            raise
        finally:
            clock.cancel()

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        self._requests.close()
        self._replies.close()

    @property
    def ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def _greet(self) -> None:
        """Wait until the process can decode."""
        try:
            kind, *_, count = REPLY.unpack(self._read(REPLY.size))
            words = "" if kind == READY else _decode_text(self._read(min(count, _WORDS)))
        except (EOFError, OSError):
            self._process.kill()
            kind, words = REFUSED, f"it ended with {self._process.wait()}"
        if kind != READY:
            raise RunError(f"the process that decodes pictures does not start: {words}.")
        self._ready = True

    def _send(self, data: bytes) -> None:
        view = memoryview(data)
        while view:
            view = view[self._requests.write(view) :]

    def _receive(self, name: str, most: int) -> Decoded:
        """Return pixels as the child sends them; what it says of them is not believed."""
        note, (kind, width, height, full_width, full_height, count) = self._head()
        if kind == REFUSED and count <= _WORDS:
            raise InputError(f"{name} {_decode_text(self._read(count))}.")
        if kind >= len(MODES) or not all(
            0 < side <= most for side in (width, height, full_width, full_height)
        ):
            raise EOFError
        if count != width * height * PIXEL_BYTES[kind]:
            raise EOFError
        channels = _CHANNELS[kind]
        shape = (height, width) if channels == 1 else (height, width, channels)
        pixels: NDArray[Any] = np.empty(shape, _DTYPES[kind])
        self._fill(pixels.data.cast("B"))
        return Decoded(pixels, (full_height, full_width), note)

    def _receive_parts(self, name: str, most: int) -> Parts:
        """Return parts as the child sends them; what it says of them is not believed."""
        note, (kind, _, _, loop, _, count) = self._head()
        if kind == REFUSED and count <= _WORDS:
            raise InputError(f"{name} {_decode_text(self._read(count))}.")
        if kind != PARTS or not 0 < count <= MOST_PARTS:
            raise EOFError
        parts, pixels = [], 0
        for _ in range(count):
            decoded = self._receive(name, most)  # or its refusal
            (duration,) = DURATION.unpack(self._read(DURATION.size))
            pixels += decoded.shape[0] * decoded.shape[1]
            if pixels > MOST_PIXELS:
                raise EOFError
            parts.append(Part(decoded, duration))
        return Parts(parts, loop, note)

    def _receive_layers(self, name: str, most: int) -> DecodedLayers:
        """Return layers as the child sends them; what it says of them is not believed."""
        note, (kind, width, height, frames, _, count) = self._head()
        if kind == REFUSED and count <= _WORDS:
            raise InputError(f"{name} {_decode_text(self._read(count))}.")
        if kind != PARTS or not (0 < count <= MOST_PARTS and 0 < frames <= MOST_PARTS):
            raise EOFError
        if not all(0 < side <= most for side in (width, height)):
            raise EOFError
        durations = [each for (each,) in DURATION.iter_unpack(self._read(frames * DURATION.size))]
        layers, total = [], 0
        for _ in range(count):
            pixels = self._receive(name, most).pixels
            left, top, number, frame, opacity, base, length = LAYER.unpack(self._read(LAYER.size))
            *groups, own = [_decode_text(each) for each in self._read(length).split(b"\0")]
            total += pixels.shape[0] * pixels.shape[1]
            inside = 0 <= left <= width - pixels.shape[1] and 0 <= top <= height - pixels.shape[0]
            if pixels.ndim != 3 or pixels.shape[2] != 4 or pixels.dtype != np.uint8:
                raise EOFError
            if total > MOST_PIXELS or frame >= frames or not inside:
                raise EOFError
            found = np.asarray(pixels, np.uint8)
            place = left, top, number, frame
            layers.append(DecodedLayer(own, tuple(groups), opacity, *place, found, base))
        return DecodedLayers((height, width), durations, layers, note)

    def _head(self) -> tuple[str, tuple[int, ...]]:
        """Return what the child notes before a reply, and the fields of the reply."""
        fields = REPLY.unpack(self._read(REPLY.size))
        if fields[0] != NOTE:
            return "", fields
        if fields[-1] > _WORDS:
            raise EOFError
        return _decode_text(self._read(fields[-1])), REPLY.unpack(self._read(REPLY.size))

    def _read(self, count: int) -> bytes:
        data = bytearray(count)
        self._fill(memoryview(data))
        return bytes(data)

    def _fill(self, view: memoryview) -> None:
        while view:
            got = self._replies.readinto(view)  # type: ignore[attr-defined]  # bufsize=0: a raw file
            if not got:
                raise EOFError
            view = view[got:]

    def _reason(self, late: bool) -> str:
        code = self._process.returncode
        if late:
            return f"it takes more than {PATIENCE:.0f} seconds"
        if code == -getattr(signal, "SIGXCPU", 0):
            return f"it takes more than {SECONDS} seconds of processor time"
        crash = (
            signal.Signals(-code).name if code < 0 and -code in set(signal.Signals) else f"exit code {code}"
        )
        return f"its decoder crashed ({crash})"


class _Pool:
    """Children that wait for a picture; as many as have been needed at once, up to a number.

    Args:
        most: children at once.
    """

    def __init__(self, most: int) -> None:
        self._turns = threading.BoundedSemaphore(most)
        self._lock = threading.Lock()
        self._idle: list[_Child] = []

    def start(self) -> None:
        """Have one child at least."""
        with self._lock:
            if not self._idle:
                self._idle.append(_Child())

    def run(self, work: Callable[[_Child], T]) -> T:
        """Return what a child that is free gives."""
        with self._turns:
            child = self._take()
            try:
                return work(child)
            finally:
                if child.ended:
                    child.close()
                else:
                    with self._lock:
                        self._idle.append(child)

    def close(self) -> None:
        """End those that wait."""
        with self._lock:
            while self._idle:
                self._idle.pop().close()

    def _take(self) -> _Child:
        with self._lock:
            while self._idle:
                child = self._idle.pop()
                if not child.ended:
                    return child
                child.close()  # ended by somebody else while it waited
        return _Child()


def _folders() -> list[str]:
    """Return where the libraries that decode lie; the child sees no other packages."""
    found = [find_spec(name) for name in ("PIL", "resvg_py", "cv2", "numpy", "pillow_heif")]
    origins = [spec.origin for spec in found if spec is not None and spec.origin is not None]
    return list(dict.fromkeys(str(Path(origin).parents[1]) for origin in origins))


def _widen(*pipes: int) -> None:
    """Let pipes hold a whole picture of usual size, where that can be asked for."""
    if sys.platform == "linux":
        # A user may have so much of it only; and not every Python on Linux has the module.
        with suppress(OSError, ImportError):
            import fcntl

            for pipe in pipes:
                fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIPE)


def _decode_text(words: bytes) -> str:
    """Return the child's words as one line that is fit for a terminal."""
    return "".join(each for each in words.decode("utf-8", "replace") if each.isprintable())


def _forget() -> None:
    """Leave the children of the process that this one was forked from to it."""
    global _pool  # noqa: PLW0603
    _kept.append(_pool)  # else its files would be closed, and its children waited for
    _pool = _Pool(_MOST)


def _close() -> None:
    _pool.close()


_WORKER = str(Path(__file__).with_name("worker.py"))
_ENVIRONMENT = ("SYSTEMROOT", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "DYLD_FALLBACK_LIBRARY_PATH")
"""What a child needs of the environment, which may hold secrets: where the libraries are."""
_ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Threads of NumPy's linear algebra, which a child has no use for, would take memory for each core."""
_KEPT_MEMORY = {"MALLOC_MMAP_THRESHOLD_": str(2**25), "MALLOC_TRIM_THRESHOLD_": str(2**26)}
"""Has glibc keep up to 64 MiB for the next picture: fresh pages take longer to get than pixels to decode."""
_MOST = max(2, min(os.cpu_count() or 1, 8))
"""Children at once: two at least, so that no stroke in the studio waits for a picture that is imported."""
_kept: list[_Pool] = []
_pool = _Pool(_MOST)
atexit.register(_close)
if sys.platform != "win32":
    os.register_at_fork(after_in_child=_forget)
