"""normalgan export: write a trained model as a file that runs without this package, or as weights."""

import re
import warnings
from pathlib import Path
from typing import Literal

from jsonargparse import Namespace

from normalgan.cli.late_imports import gc_paused
from normalgan.cli.parsing.light_parser import LightParser
from normalgan.cli.parsing.number_types import ModelSide
from normalgan.errors import InputError, RunError, printable, writing
from normalgan.files.writing import write_bytes
from normalgan.warning_filters import filter_warnings

_ONNX = ".onnx"
SUFFIXES = {_ONNX: "ONNX", ".safetensors": "safetensors", ".pt": "TorchScript", ".pt2": "torch.export"}
"""The formats by file extension."""
_HALVED = (_ONNX, ".safetensors")
_Opset = Literal[15, 16, 17, 18, 19, 20, 21]
"""Supported ONNX opset versions; ONNX cannot convert our models to versions below 15."""
_TOLERANCE = 1e-3
"""Maximum accepted difference between the exported model and torch."""


def run(arguments: list[str]) -> int:
    """Export the model and return the exit code.

    Raises:
        InputError: if an argument is invalid.
    """
    options = build_parser().parse_args(arguments)
    target = _check(options)
    with warnings.catch_warnings():
        filter_warnings()
        print(_export(options, target))
    return 0


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan export",
        usage="%(prog)s MODEL -o MODEL.onnx|.safetensors|.pt|.pt2 [--half]",
        description="Write a trained generator as a file that runs without this package, or as its weights.",
    )
    parser.add_argument(
        "model",
        help="a checkpoint of `normalgan fit` such as last.ckpt, a .safetensors or .onnx file, "
        "or shipped for the package's own model",
    )
    named = ", ".join(f"{suffix} ({name})" for suffix, name in SUFFIXES.items())
    parser.add_argument(
        "-o",
        "--output",
        default="model.onnx",
        help=f"output file; its extension determines the format: {named} (default %(default)s)",
    )
    parser.add_argument(
        "--opset", type=_Opset | None, help="ONNX opset version, lower for older runtimes (default 18)"
    )
    parser.add_argument("--half", action="store_true", help="store the weights as float16")
    parser.add_argument(
        "--size", type=ModelSide | None, help="side of the pictures in pixels; by default the training size"
    )
    parser.add_argument(
        "--licence",
        type=str | None,
        help="licence of the weights, written into the file; by default the licence stored with the model",
    )
    return parser


def _export(options: Namespace, target: Path) -> str:
    """Write the model, and return the report for the user.

    Raises:
        InputError: if the model cannot be used or the file cannot be written.
        RunError: if the predictions of the exported model differ from those of torch; nothing is written
            then.
    """
    with gc_paused():
        from normalgan.exporting.comparison import largest_difference, turn_in_degrees
        from normalgan.exporting.deployed import load
        from normalgan.exporting.formats import FORMATS, write_onnx

    (model, notes), form = load(options.model, options.size, options.licence), FORMATS[target.suffix.lower()]
    content = form.write(model, notes.metadata())
    if options.opset is not None:
        from normalgan.exporting.onnx_file import lowered  # other formats do not need onnx

        content = lowered(content, options.opset)
    difference = largest_difference(model, form.read(content))
    if not difference <= _TOLERANCE:
        raise RunError(
            f"the exported model differs from torch by {difference:.2g}, more than {_TOLERANCE}; nothing was "
            "written."
        )
    if form.write is write_onnx:
        _check_weights(content, target)
    said = f"differs from torch by at most {difference:.1g}"
    if options.half and form.halve:
        content = form.halve(content)
        mean, most = turn_in_degrees(model, form.read(content))
        said += f"; half precision turns its normals by {mean:.3f}° in the mean and {most:.2f}° at most"
    with writing("the model"):
        write_bytes(target, content)
    return f"{printable(target)}\n{model.name}, {model.size} pixels, {len(content) / 1e6:.1f} MB; {said}."


def _check_weights(content: bytes, target: Path) -> None:
    """Warn if an ONNX file runs but does not hold each weight, such as of networks that share weights."""
    from normalgan.weights.file import parse_weights

    try:
        parse_weights(content, str(target), is_onnx=True)
    except InputError:
        warnings.warn(
            f"generate, studio and ONNX Runtime run {printable(target)}, but predict, test and StartFrom "
            "cannot read it, because its graph does not keep all weights; export .safetensors for them.",
            stacklevel=2,
        )


def _check(options: Namespace) -> Path:
    """Return the file to write, or raise `InputError` if the options are incompatible."""
    suffix = Path(options.output).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(
            f"--output {options.output} must end in {', '.join(SUFFIXES)}, which names the format."
        )
    if options.half and suffix not in _HALVED:
        raise InputError(
            f"--half is for {' and '.join(_HALVED)}; leave it out, or write {suffix} without it."
        )
    if options.opset is not None and suffix != _ONNX:
        raise InputError(f"--opset is for {_ONNX}; leave it out, or write {suffix} without it.")
    if options.licence is not None and not re.fullmatch(r"[^\x00-\x1f]{1,500}", options.licence):
        raise InputError("--licence is one line of at most 500 characters.")
    if Path(options.output).resolve() == Path(options.model).resolve():
        raise InputError(f"{options.output} is an input and would be overwritten; give another -o.")
    return Path(options.output)
