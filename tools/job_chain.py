"""Counts the functions of normalgan that one drawing passes through: `job_chain.py generate|stroke FILE`.

`generate` follows a job of `normalgan generate` from `JobPredictor` on; `stroke` follows a drawing of the
studio from its predictor on. It prints two figures, each with the number of modules: all functions that run,
and those that receive the whole drawing, as `self` or as an argument of a class in `CARRIERS`. `--list` also
prints each function, with a star if it receives the drawing.
"""

import sys
import threading
from pathlib import Path
from tempfile import TemporaryDirectory
from types import CodeType, FrameType
from typing import Any

import normalgan

CARRIERS = {"Job", "DrawingFiles", "Drawing", "DrawingRequest", "Picture", "Prepared", "Member"}
"""Classes that hold a drawing, or facts about it, on the way to its map."""
STARTS = {
    "generate": ("normalgan/inference/predict_job.py", "JobPredictor.__call__"),
    "stroke": ("normalgan/studio/predictions/predictor.py", "DrawingPredictor.predict"),
}
SOURCE = str(Path(normalgan.__file__).parents[1])


class Chain:
    """Records the functions that run from the call of one of `STARTS` to its return, in any thread."""

    def __init__(self, start: tuple[str, str]) -> None:
        self._start = start
        self._running = False
        self.entered: dict[CodeType, bool] = {}

    def __call__(self, frame: FrameType, event: str, _: Any) -> None:
        """Handle an event of `sys.setprofile`."""
        code = frame.f_code
        if not code.co_filename.startswith(SOURCE) or event not in {"call", "return"}:
            return
        starts = code.co_filename.endswith(self._start[0]) and code.co_qualname == self._start[1]
        if starts:
            self._running = event == "call"
        if self._running and event == "call" and not code.co_name.startswith("<"):
            given = [frame.f_locals.get(name) for name in code.co_varnames[: code.co_argcount]]
            handed = any(type(each).__name__ in CARRIERS for each in given)
            self.entered[code] = self.entered.get(code, False) or handed


def follow(what: str, drawing: Path) -> Chain:
    """Run one job and record its functions."""
    chain = Chain(STARTS[what])
    threading.setprofile(chain)
    sys.setprofile(chain)
    try:
        if what == "generate":
            from normalgan.__main__ import main

            with TemporaryDirectory() as folder:
                main(["generate", str(drawing), "-o", folder])
        else:
            from normalgan.studio.drawings.drawing_request import DrawingRequest
            from normalgan.studio.predictions.predictor import DrawingPredictor
            from normalgan.weights.shipped import SHIPPED

            DrawingPredictor(SHIPPED).predict(DrawingRequest(drawing.read_bytes()), [], None, lambda: None)
    finally:
        sys.setprofile(None)
        threading.setprofile(None)
    return chain


if __name__ == "__main__":
    entered = follow(sys.argv[1], Path(sys.argv[2])).entered
    for words, codes in (
        ("functions run", list(entered)),
        ("functions are handed the drawing", [code for code, handed in entered.items() if handed]),
    ):
        print(f"{len(codes)} {words}, in {len({code.co_filename for code in codes})} modules")
    if "--list" in sys.argv:
        for code, handed in entered.items():
            print("*" if handed else " ", code.co_filename.removeprefix(SOURCE)[1:], code.co_qualname)
