"""OnnxBackend: run a generator in ONNX format with ONNX Runtime, without torch."""

from collections.abc import Iterable
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime

from normalgan.arrays import Floats
from normalgan.decoding.time_limit import time_limit
from normalgan.errors import InputError, RunError, brief, wants_memory, with_subject
from normalgan.files.limits import read_bounded
from normalgan.inference.network.onnx_graph import check_graph
from normalgan.inference.network.upsampling import upsampler
from normalgan.line_widths import line_widths_of

PATIENCE = 300.0
"""Maximum wall-clock time for one picture, in seconds."""
MEMORY = 2**31
"""Memory limit in bytes for all models of a process; the shipped model takes about 7e8 in eight threads."""
SMALLEST, LARGEST = 8, 2048
"""Minimum and maximum side of a model's input in pixels."""


class OnnxBackend:
    """A `Backend` that runs a generator in ONNX format.

    Args:
        path: file written by `normalgan export`.
        threads: number of threads per run; 0 uses all cores.

    Raises:
        InputError: if the file is not a generator written by `normalgan export`.
    """

    def __init__(self, path: Path, threads: int = 0) -> None:
        onnxruntime.disable_telemetry_events()  # telemetry is on by default on Windows
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        options.log_severity_level = 4  # errors are reported as exceptions only
        # Spinning threads would slow down the steps after a run, and the browser.
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        options.add_session_config_entry("session.use_env_allocators", "1")  # the one with a memory limit
        try:
            content = read_bounded(path)
            folds = check_graph(str(path), content)
            _limit_memory()
            self._session = onnxruntime.InferenceSession(
                content,
                options,
                providers=["CPUExecutionProvider"],
                disabled_optimizers=None if folds else ["ConstantFolding"],
                enable_fallback=0,  # the fallback would print the error and retry with the same provider
            )
            # ONNX Runtime decodes strings on access, and any of them may be invalid.
            inputs = {each.name: each.shape for each in self._session.get_inputs()}
            self._outputs = [each.name for each in self._session.get_outputs()]
            self.notes: dict[str, str] = self._session.get_modelmeta().custom_metadata_map
            """Metadata of the file."""
        except InputError:
            raise
        except OSError as error:
            raise InputError(f"the model {path} cannot be read: {error.strerror}.") from None
        except Exception as error:  # ONNX Runtime's exceptions have no common base class
            if wants_memory(error):
                raise RunError(
                    f"there is too little memory to load the model {path}; close other programs."
                ) from error
            raise InputError(
                f"{path} is not a model that ONNX Runtime can run: {brief(error)[:200].rstrip('.')}."
            ) from error
        self._path = path
        self.size = _side_of(path, inputs, self._outputs)
        """Side of the input and the output in pixels."""
        try:
            self.line_widths = line_widths_of(self.notes)
        except InputError as error:
            raise with_subject(path, error) from error
        """Range of line widths, in pixels of the input, that are kept as drawn."""
        self.upsample = upsampler(refined=self.notes.get("refined") == "true", threads=threads)
        """The upsampler from the network's size to the drawing's."""

    def predict(self, sketch: Floats, hints: Floats | None = None) -> tuple[Floats, Floats | None]:
        """Return the normals (S, S, 3) predicted for a sketch, and the confidence (S, S) or None.

        Sketches are not batched, because in a batch the last bits of a prediction depend on the other
        sketches.

        Args:
            sketch: (S, S), ink in [0, 1].
            hints: (4, S, S), unit normals at the hints and the mask of the hints; None for no hints.

        Raises:
            InputError: if the output is invalid, or the model takes too much time or memory.
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
        """Return the named outputs; raise `InputError` if the run fails or exceeds a limit."""
        run = onnxruntime.RunOptions()
        run.log_severity_level = 4

        def end() -> None:
            run.terminate = True  # ONNX Runtime checks it between operators

        with time_limit(PATIENCE, end) as late:
            try:
                return [np.asarray(output) for output in self._session.run(names, given, run)]
            except Exception as error:  # no common base class, as above
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


@cache
def _limit_memory() -> None:
    """Limit the memory of all ONNX Runtime sessions of this process to `MEMORY`."""
    where = onnxruntime.OrtMemoryInfo(
        "Cpu", onnxruntime.OrtAllocatorType.ORT_ARENA_ALLOCATOR, 0, onnxruntime.OrtMemType.DEFAULT
    )
    onnxruntime.create_and_register_allocator(where, onnxruntime.OrtArenaCfg({"max_mem": MEMORY}))


def _side_of(path: Path, inputs: dict[str, list[Any]], outputs: list[str]) -> int:
    """Return the side of a model's input in pixels; raise `InputError` if it is not a generator."""
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
    """Return names for a message, shortened, because a file may hold any number of names of any length."""
    text = ", ".join(islice(names, 9))
    return "".join(each if each.isprintable() else "?" for each in text[:200])


def _fits(shape: list[object] | None, channels: int, side: object) -> bool:
    """Return whether an input takes a single picture, or a batch, of ``channels`` channels and this side."""
    if shape is None or not isinstance(side, int) or len(shape) != 4:
        return False
    return (shape[0] == 1 or not isinstance(shape[0], int)) and shape[1:] == [channels, side, side]
