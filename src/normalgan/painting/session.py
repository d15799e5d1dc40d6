"""Model: a generator as ONNX, run by ONNX Runtime."""

from pathlib import Path

import numpy as np
import onnxruntime

from normalgan.errors import InputError, brief
from normalgan.normals import Floats

SHIPPED = Path(__file__).parents[1] / "weights" / "ours.onnx"
"""The model that comes with the package."""


def find_model(path: str | None = None) -> Path:
    """Return the file of the model: the one named, or the one that comes with the package.

    Raises:
        InputError: if there is none.
    """
    if path is None and not SHIPPED.is_file():
        raise InputError(
            "no model comes with this package; name one that `normalgan export` wrote with --model."
        )
    found = SHIPPED if path is None else Path(path)
    if not found.is_file():
        raise InputError(f"there is no model {found}; name a file that `normalgan export` wrote.")
    return found


class Model:
    """A generator as ONNX: sketches and hints in, normals and perhaps confidence out.

    Args:
        path: file that `normalgan export` wrote.
        threads: of one run; 0 takes all cores.

    Raises:
        InputError: if it is no such file.
    """

    def __init__(self, path: Path, threads: int = 0) -> None:
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        options.log_severity_level = 3
        # Threads that wait by spinning take the cores from what comes after a run, and from a browser.
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        try:
            self._session = onnxruntime.InferenceSession(
                path.read_bytes(), options, providers=["CPUExecutionProvider"]
            )
        except OSError as error:
            raise InputError(f"the model {path} cannot be read: {error.strerror}.") from None
        except Exception as error:  # ONNX Runtime's own classes of errors have no common base
            raise InputError(
                f"{path} is no model that ONNX Runtime can run: {brief(error)[:200]}."
            ) from error
        inputs = {each.name: each.shape for each in self._session.get_inputs()}
        self._outputs = [each.name for each in self._session.get_outputs()]
        sides = inputs.get("sketch", [None])[-2:]
        if set(inputs) != {"sketch", "hints"} or "normal" not in self._outputs or not _square(sides):
            raise InputError(
                f"{path} takes {', '.join(inputs)} and gives {', '.join(self._outputs)}, which is not what "
                "`normalgan export` writes: sketch and hints of one fixed size, and normal."
            )
        self.size: int = sides[0]
        """Side of the model's pictures in pixels."""
        self.notes: dict[str, str] = self._session.get_modelmeta().custom_metadata_map
        """What the file says about itself."""

    def paint(self, sketch: Floats, hints: Floats | None = None) -> tuple[Floats, Floats | None]:
        """Return the normals painted for one sketch, (S, S, 3), and the confidence (S, S) if there is one.

        One at a time: in a batch the last bits of a picture would depend on its neighbours.

        Args:
            sketch: (S, S) ink in [0, 1].
            hints: (4, S, S) unit normals at the hints, and where they are; None for no hints.
        """
        if hints is None:
            hints = np.zeros((4, self.size, self.size), np.float32)
        given = {"sketch": sketch[None, None], "hints": hints[None]}
        outputs = self._session.run([n for n in ("normal", "confidence") if n in self._outputs], given)
        normal = np.asarray(outputs[0][0], np.float32).transpose(1, 2, 0)
        return np.ascontiguousarray(normal), np.asarray(outputs[1][0, 0]) if len(outputs) > 1 else None


def _square(sides: list[object]) -> bool:
    return len(sides) == 2 and isinstance(sides[0], int) and sides[0] == sides[1]
