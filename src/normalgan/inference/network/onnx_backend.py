"""OnnxBackend: a generator as ONNX, run by ONNX Runtime; no torch."""

import threading
from collections.abc import Iterable
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime

from normalgan.arrays import Floats
from normalgan.errors import InputError, RunError, brief, wants_memory, with_subject
from normalgan.files.limits import read_bounded
from normalgan.inference.network.onnx_graph import check_graph
from normalgan.inference.network.upsampling import upsampler
from normalgan.line_widths import line_widths_of

__all__ = [
    "LARGEST",
    "MEMORY",
    "PATIENCE",
    "SMALLEST",
    "OnnxBackend",
]

PATIENCE = 300.0
"""Seconds by the clock for one picture."""
MEMORY = 2**31
"""Bytes that all models of a process may take together in all threads; ours takes some 7e8 in eight."""
SMALLEST, LARGEST = 8, 2048
"""Least and greatest side in pixels of a model's pictures."""


class OnnxBackend:
    """A generator as ONNX: sketches and hints in, normals and an optional confidence out. A `Backend`.

    Args:
        path: file that `normalgan export` wrote.
        threads: threads of one run; 0 takes all cores.

    Raises:
        InputError: if it is not such a file.
    """

    def __init__(self, path: Path, threads: int = 0) -> None:
        onnxruntime.disable_telemetry_events()  # on by default on Windows
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        options.log_severity_level = 4  # we report errors in one sentence
        # Threads that wait by spinning take the cores from what comes after a run, and from a browser.
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        options.add_session_config_entry("session.use_env_allocators", "1")  # the one with a limit
        try:
            content = read_bounded(path)
            folds = check_graph(str(path), content)
            _limit_memory()
            self._session = onnxruntime.InferenceSession(
                content,
                options,
                providers=["CPUExecutionProvider"],
                disabled_optimizers=None if folds else ["ConstantFolding"],
                enable_fallback=0,  # else what goes wrong is printed, and tried again with the same provider
            )
            # Texts are decoded when they are asked for: any of them may be none.
            inputs = {each.name: each.shape for each in self._session.get_inputs()}
            self._outputs = [each.name for each in self._session.get_outputs()]
            self.notes: dict[str, str] = self._session.get_modelmeta().custom_metadata_map
            """What the file says about itself."""
        except InputError:
            raise
        except OSError as error:
            raise InputError(f"the model {path} cannot be read: {error.strerror}.") from None
        except Exception as error:  # ONNX Runtime's own classes of errors have no common base
            if wants_memory(error):
                raise RunError(
                    f"there is too little memory to load the model {path}; close other programs."
                ) from error
            raise InputError(
                f"{path} is not a model that ONNX Runtime can run: {brief(error)[:200].rstrip('.')}."
            ) from error
        self._path = path
        self.size = _side_of(path, inputs, self._outputs)
        """Side of the model's pictures in pixels."""
        try:
            self.line_widths = line_widths_of(self.notes)
        except InputError as error:
            raise with_subject(path, error) from error
        """The lines that it is shown as they were drawn, in pixels of its pictures."""
        self.upsample = upsampler(refined=self.notes.get("refined") == "true", threads=threads)
        """The step from that size to a drawing's."""

    def predict(self, sketch: Floats, hints: Floats | None = None) -> tuple[Floats, Floats | None]:
        """Return the normals predicted for one sketch, (S, S, 3), and the confidence (S, S) if there is one.

        One at a time: in a batch the last bits of a picture would depend on its neighbours.

        Args:
            sketch: (S, S) ink in [0, 1].
            hints: (4, S, S) unit normals at the hints, and where they are; None for no hints.

        Raises:
            InputError: if the output is not that of a generator, or the model takes too long.
        """
        if hints is None:
            hints = np.zeros((4, self.size, self.size), np.float32)
        names = [name for name in ("normal", "confidence") if name in self._outputs]
        outputs = self._run(names, {"sketch": sketch[None, None], "hints": hints[None]})
        for name, output in zip(names, outputs, strict=True):
            shape = (1, 3 if name == "normal" else 1, self.size, self.size)
            if np.shape(output) != shape:
                raise InputError(
                    f"the model {self._path} gives {name} of the shape {np.shape(output)}, not {shape}."
                )
            if not np.isfinite(output).all():
                raise InputError(
                    f"the model {self._path} gives {name} that is not finite; "
                    "export it again from a checkpoint whose loss was finite."
                )
        normal = np.asarray(outputs[0][0], np.float32).transpose(1, 2, 0)
        return np.ascontiguousarray(normal), np.asarray(outputs[1][0, 0]) if len(outputs) > 1 else None

    def _run(self, names: list[str], given: dict[str, Floats]) -> list[Floats]:
        """Return the outputs of these names, unless that takes too long."""
        run = onnxruntime.RunOptions()
        run.log_severity_level = 4
        late = threading.Event()

        def end() -> None:
            late.set()
            run.terminate = True  # it is looked at between operators

        clock = threading.Timer(PATIENCE, end)
        clock.daemon = True
        clock.start()
        try:
            return [np.asarray(output) for output in self._session.run(names, given, run)]
        except Exception as error:  # as above
            if late.is_set():
                why = f"takes more than {PATIENCE:.0f} seconds to predict"
            elif wants_memory(error):
                raise RunError(
                    f"there is too little memory to run the model {self._path}; close other programs."
                ) from error
            elif "BFCArena" in str(error):
                why = f"takes more than {MEMORY >> 30} GiB of memory to predict"
            else:
                why = f"cannot be run: {brief(error)[:200]}"
            raise InputError(f"the model {self._path} {why}.") from error
        finally:
            clock.cancel()


@cache
def _limit_memory() -> None:
    """Limit the memory of all ONNX Runtime sessions of this process to `MEMORY`."""
    where = onnxruntime.OrtMemoryInfo(
        "Cpu", onnxruntime.OrtAllocatorType.ORT_ARENA_ALLOCATOR, 0, onnxruntime.OrtMemType.DEFAULT
    )
    onnxruntime.create_and_register_allocator(where, onnxruntime.OrtArenaCfg({"max_mem": MEMORY}))


def _side_of(path: Path, inputs: dict[str, list[Any]], outputs: list[str]) -> int:
    """Return the side in pixels of a model's pictures; raise `InputError` if it is not a generator."""
    side = (inputs.get("sketch") or [None])[-1]
    fits = [_fits(inputs.get(name), channels, side) for name, channels in (("sketch", 1), ("hints", 4))]
    if len(inputs) != 2 or not all(fits) or "normal" not in outputs:
        raise InputError(
            f"{path} takes {_listed(inputs)} and gives {_listed(outputs)}, which is not what "
            "`normalgan export` writes: sketch and hints of one fixed size, and normal."
        )
    if not SMALLEST <= side <= LARGEST:
        raise InputError(
            f"the model {path} predicts pictures of {side} × {side} pixels; "
            f"{SMALLEST} to {LARGEST} a side are possible."
        )
    return int(side)


def _listed(names: Iterable[str]) -> str:
    """Return names as they can be shown: a file may hold any number of any length."""
    text = ", ".join(islice(names, 9))
    return "".join(each if each.isprintable() else "?" for each in text[:200])


def _fits(shape: list[object] | None, channels: int, side: object) -> bool:
    """Return whether an input takes pictures, one or several, of these channels and this side."""
    if shape is None or not isinstance(side, int) or len(shape) != 4:
        return False
    return (shape[0] == 1 or not isinstance(shape[0], int)) and shape[1:] == [channels, side, side]
