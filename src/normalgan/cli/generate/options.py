"""Options of normalgan generate."""

from collections.abc import Sequence
from typing import Literal

from jsonargparse.typing import ClosedUnitInterval

from normalgan.cli.parsing.light_parser import LightParser, choices
from normalgan.cli.parsing.number_types import Side, Strength
from normalgan.cli.parsing.output_options import add_output_options
from normalgan.inference.network.tile import Tile
from normalgan.inference.outputs import OUTPUTS
from normalgan.inference.outputs.engines import CONVENTIONS, Engine
from normalgan.inference.outputs.normal import engine_defaults


def engine_of(arguments: Sequence[str]) -> Engine | None:
    """Return the engine that a command line names; None if it names no known engine.

    >>> engine_of(["fox.png", "--engine", "unreal"])
    'unreal'
    """
    for i, each in enumerate(arguments):
        name, _, value = each.partition("=")
        if name == "--engine":
            value = value or "".join(arguments[i + 1 : i + 2])
            return next((known for known in CONVENTIONS if known == value), None)
    return None


def build_parser(engine: Engine | None = None) -> LightParser:
    """Return the parser of the command line.

    Args:
        engine: engine whose conventions are the defaults of the output options.
    """
    parser = LightParser(
        prog="normalgan generate",
        usage="%(prog)s SKETCH... [-o FOLDER] [--SETTING VALUE]...",
        description="Predict normal maps for drawings.",
    )
    parser.add_argument(
        "sketches", nargs="+", help="files, folders or globs of drawings; - reads one from standard input"
    )
    parser.add_argument(
        "-o",
        "--output",
        default="normals",
        help="output folder (default %(default)s); for a single drawing also a file, or - for standard "
        "output",
    )
    parser.add_argument("--dry-run", action="store_true", help="only print what would be read and written")
    _add_drawing(parser)
    _add_folders(parser)
    _add_sheets(parser)
    OUTPUTS.load_entry_points()
    add_output_options(parser.add_argument_group("What is written"), form=None)
    if engine is not None:
        parser.set_defaults(engine_defaults(engine))
    return parser


def _add_drawing(parser: LightParser) -> None:
    group = parser.add_argument_group("The drawing")
    group.add_argument(
        "--model",
        type=str | None,
        help="file or address of a model written by normalgan export; by default the shipped model",
    )
    group.add_argument(
        "--hints", type=str | None, help="file of hints, or folder of <sketch>_hints.png or .json files"
    )
    group.add_argument(
        "--mask",
        type=str | None,
        help="mask of the object: a file, a folder of <sketch>_mask.png files, outline (all that lines "
        "enclose), reader (a small network decides on each region), or model (the model's own segmentation); "
        "by default the drawing's opacity if it shows the object, otherwise reader",
    )
    group.add_argument(
        "--hole",
        type=str,
        action="append",
        metavar="X,Y",
        help="point of the drawing whose enclosed region becomes a hole, or object if it is a hole; can be "
        "given several times",
    )
    group.add_argument("--single", action="store_true", help="predict all figures of a page as one object")
    group.add_argument(
        "--explain",
        type=str | None,
        help="folder for pictures that show how each mask was found: ink, votes on regions, presence",
    )
    group.add_argument(
        "--size",
        type=Side | None,
        help="longer side of the map in pixels; by default the drawing's, 1024 for an SVG",
    )
    group.add_argument(
        "--strength", type=Strength, default=1.0, help="factor applied to the slopes (default %(default)s)"
    )
    group.add_argument(
        "--form",
        type=str | None,
        metavar="KIND",
        help="form of each object, or of each area between the lines with --tile: round, flat (a face with a "
        "bevelled edge) or hollow; optionally with bevel (width of the edge) and strength, such as "
        "flat,bevel=0.1,strength=1; the default bevel is 0.2 (1 for round and hollow) and the strength 0.7",
    )
    group.add_argument(
        "--detail",
        type=ClosedUnitInterval,
        default=0.0,
        help="strength of the relief added from the drawing's own shading, 0 to 1 (default %(default)s)",
    )
    group.add_argument(
        "--pixel-art",
        action="store_true",
        help="give each art pixel one of 25 normals; thin dark outlines are flat",
    )
    group.add_argument(
        "--tile",
        type=Tile | None,
        metavar=choices(Tile),
        help="directions in which the drawing repeats: x, y or both; its maps repeat in the same way",
    )


def _add_folders(parser: LightParser) -> None:
    group = parser.add_argument_group("Folders")
    group.add_argument(
        "--recursive", action="store_true", help="search subfolders too, and mirror them in the output folder"
    )
    group.add_argument(
        "--skip-existing",
        action="store_true",
        help="write only missing files, and skip drawings that have all of them",
    )
    group.add_argument(
        "--watch",
        action="store_true",
        help="keep running, and predict each drawing when it is saved; Ctrl-C stops it",
    )


def _add_sheets(parser: LightParser) -> None:
    group = parser.add_argument_group("Several drawings in one file")
    group.add_argument("--sheet", type=str | None, help="grid of a sprite sheet: columns x rows, such as 4x3")
    group.add_argument(
        "--split",
        type=Literal["auto"] | None,
        metavar="auto",
        help="auto finds the drawings of a sheet: opaque islands or connected lines",
    )
    group.add_argument(
        "--atlas",
        type=str | None,
        help="file with the positions of a sheet's sprites, from TexturePacker, Aseprite, libGDX, Spine, "
        "Starling, Phaser, Cocos2d, Unity or Godot, or a folder of such files",
    )
    group.add_argument(
        "--tileset",
        type=str | None,
        metavar="SIZE",
        help="tileset: width x height of a tile, such as 16x16 or 16x16,margin=1,spacing=2; a Tiled tileset "
        "(.tsx, .tsj) or a folder of them; or own for the tileset of an Aseprite file",
    )
    group.add_argument(
        "--layers",
        action="store_true",
        help="predict each visible layer of a PSD, KRA, ORA or Aseprite file separately, and write a layered "
        "file; with --bits 16, --engine or another --format, each layer is written to its own file",
    )
    group.add_argument(
        "--frame",
        type=Literal["own", "shared"] | None,
        metavar="{own,shared}",
        help="framing of the model's input: own enlarges each drawing as far as possible; shared uses the "
        "same square for all, so that still parts do not flicker; the default is shared for animations, "
        "otherwise own",
    )
