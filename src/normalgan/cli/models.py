"""normalgan models: list the models that can be loaded by name, and those that were fetched."""

import json
from collections.abc import Mapping
from pathlib import Path

from normalgan.cli.parsing.light_parser import LightParser
from normalgan.errors import InputError, printable


def run(arguments: list[str]) -> int:
    """List the models and return the exit code.

    Raises:
        InputError: if an argument is invalid.
    """
    settings = build_parser().parse_args(arguments)
    # Imported here because ONNX Runtime takes a third of a second to import.
    from normalgan.files.addresses import kept_files
    from normalgan.weights.shipped import SHIPPED_NAME, find_model

    models = [_model(SHIPPED_NAME, find_model()), *(_model(kept.address, kept.path) for kept in kept_files())]
    if settings.json:
        print(json.dumps(models, indent=2))
        return 0
    for model in models:
        about = [
            f"{float(str(model['bytes'])) / 1e6:.1f} MB",
            *(str(model[key]) for key in _SHOWN if key in model),
        ]
        print(printable(model["name"]), printable(model["path"]), printable(", ".join(about)), sep="\n  ")
    return 0


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan models",
        usage="%(prog)s [--json]",
        description="List the shipped model and the models that were fetched from an address.",
    )
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")
    return parser


_SHOWN = ("model", "pixels", "licence", "version")


def _model(name: str, path: Path) -> dict[str, object]:
    return {"name": name, "path": str(path), "bytes": path.stat().st_size, **_notes(path)}


def _notes(path: Path) -> Mapping[str, str]:
    """Return the metadata of an ONNX file; empty for other files, which would need torch."""
    from normalgan.inference.network.onnx_backend import OnnxBackend

    if path.suffix.lower() != ".onnx":
        return {}
    try:
        notes = OnnxBackend(path).notes
    except InputError as error:
        return {"model": str(error)}
    said = {
        "model": notes.get("model"),
        "pixels": f"{notes['size']} pixels" if "size" in notes else None,
        "licence": f"licence {notes['licence']}" if "licence" in notes else None,
        "version": f"normalgan {notes['normalgan_version']}" if "normalgan_version" in notes else None,
    }
    return {key: value for key, value in said.items() if value}
