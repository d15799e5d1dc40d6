"""normalgan convert: convert a normal or height map to another format, convention or kind."""

from pathlib import Path
from typing import Literal

from jsonargparse import Namespace

from normalgan.cli.parsing.light_parser import LightParser, refuse_empty
from normalgan.cli.parsing.number_types import Strength
from normalgan.errors import InputError, printable, writing
from normalgan.files.writing import write_bytes
from normalgan.inference.conversion import map_of_heights, read_map, with_detail
from normalgan.inference.outputs.height import Height
from normalgan.normals import Bits, Green

_Kind = Literal["normal", "height"]


def run(arguments: list[str]) -> int:
    """Convert a map and return the exit code.

    Raises:
        InputError: if a map cannot be read or written, or the arguments contradict each other.
    """
    parser = build_parser()
    settings = parser.parse_args(arguments)
    _check_together(settings, parser)
    refuse_empty(settings, "output", "detail")
    output = Path(settings.output)
    if settings["from"] == "height" and settings.scale is None:
        raise InputError(
            "a height map needs --scale: the pixels from black to white; 1 for a TIFF of heights in pixels."
        )
    if output.resolve() in [Path(each).resolve() for each in (settings.map, settings.detail) if each]:
        raise InputError(f"{output} is an input and would be overwritten; give another output (-o).")
    if settings["from"] == "height":
        found = map_of_heights(settings.map, settings.scale)
    else:
        found = read_map(settings.map, settings.from_y)
    found = found.stronger(settings.strength)
    if settings.detail is not None:
        found = with_detail(found, read_map(settings.detail, settings.detail_y))
    with writing("the map", output):
        if settings.to == "height":
            form: Literal["png", "tiff"] = "png" if output.suffix.lower() == ".png" else "tiff"
            if output.suffix.lower() not in {".png", ".tif", ".tiff"}:
                raise InputError(f"the height map {output} must end in .png, .tif or .tiff.")
            if form == "tiff" and settings.scale is not None and settings["from"] == "normal":
                raise InputError(f"--scale applies to a PNG; {output} holds heights in pixels.")
            height = Height(form, settings.scale if form == "png" else None)
            write_bytes(output, height.encode(found)[height.endings[0]])
        else:
            found.save(output, settings.bits, settings.y, alpha=bool((found.alpha < 1).any()))
    print(printable(output))
    return 0


def _check_together(settings: Namespace, parser: LightParser) -> None:
    """Raise `InputError` if an option has no effect in combination with the others."""
    heights, maps = settings["from"] == "height", settings.to == "normal"
    for option, applies, where in (
        ("from_y", not heights, "an input normal map; omit --from height"),
        ("y", maps, "an output normal map; omit --to height"),
        ("bits", maps, "an output normal map; omit --to height"),
        ("scale", heights or not maps, "a height map; add --from height or --to height"),
        ("detail_y", settings.detail is not None, "the details; add --detail"),
    ):
        if not applies and settings[option] != parser.get_default(option):
            raise InputError(f"--{option.replace('_', '-')} applies to {where}.")


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan convert",
        usage="%(prog)s MAP -o FILE.png|.exr|.tiff [--SETTING VALUE]...",
        description="Convert a normal or height map to another format, convention or kind.",
    )
    parser.add_argument("map", help="a normal map (PNG, TIFF, EXR), or a grey height map")
    parser.add_argument("-o", "--output", required=True, help="output file: .png, .tiff or .exr")
    parser.add_argument(
        "--from", type=_Kind, default="normal", help="what the map holds (default %(default)s)"
    )
    parser.add_argument("--to", type=_Kind, default="normal", help="what to write (default %(default)s)")
    parser.add_argument(
        "--from-y",
        "--from_y",
        type=Green,
        default="up",
        help="direction of green in the map: up for OpenGL (default %(default)s)",
    )
    parser.add_argument(
        "--y",
        type=Green,
        default="up",
        help="direction of green in the output: down for DirectX (default %(default)s)",
    )
    parser.add_argument(
        "--bits", type=Bits, default=8, help="bits per channel of a PNG normal map (default %(default)s)"
    )
    parser.add_argument(
        "--strength", type=Strength, default=1.0, help="factor applied to the slopes (default %(default)s)"
    )
    parser.add_argument(
        "--scale",
        type=float | None,
        help="pixels from black to white of a height map, or pixels per unit of a TIFF of floats; if a PNG "
        "is written, by default the whole range of the heights",
    )
    parser.add_argument("--detail", type=str | None, help="normal map of details to add; it is tiled")
    parser.add_argument(
        "--detail-y",
        "--detail_y",
        type=Green,
        default="up",
        help="direction of green in the details (default %(default)s)",
    )
    return parser
