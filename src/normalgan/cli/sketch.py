"""normalgan sketch: draw a mesh as SVG or PNG."""

import re
from pathlib import Path
from typing import Any

import numpy as np
from jsonargparse import Namespace
from jsonargparse.typing import NonNegativeInt
from numpy.typing import NDArray

from normalgan.animals import SPECIES, Animal
from normalgan.cli.parsing.errors import refusal
from normalgan.cli.parsing.light_parser import LightParser, refuse_empty
from normalgan.cli.parsing.number_types import Degrees, Margin, Side
from normalgan.errors import InputError, did_you_mean, printable, writing
from normalgan.files.writing import write_bytes
from normalgan.normals import encode_grey, encode_png, paint_flat
from normalgan.registry import Registry
from normalgan.rendering import EmbreeRenderer, MeshSource, Renderer, find_meshes
from normalgan.rendering.cameras import framed, look_at_origin
from normalgan.rendering.gltf import container
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import LINE_DRAWINGS, LineDrawing, SuggestiveContours
from normalgan.rendering.loading import SUFFIXES
from normalgan.rendering.media import Medium
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.renderers import RENDERERS
from normalgan.rendering.samples import draw_ink, draw_strokes, no_lines
from normalgan.rendering.strokes.svg import to_svg
from normalgan.rendering.view import View

_PLUGINS: dict[str, Registry[Any]] = {"renderer": RENDERERS, "lines": LINE_DRAWINGS, "styles": LINE_DRAWINGS}
"""Registries of the settings that name plug-ins."""


def run(arguments: list[str]) -> int:
    """Draw a mesh and return the exit code.

    Raises:
        InputError: if an argument is invalid, or a file cannot be written.
    """
    for registry in (RENDERERS, LINE_DRAWINGS):
        registry.load_entry_points()
    parser = build_parser()
    try:
        settings = parser.instantiate(parser.parse_args(arguments))
    except InputError:
        raise
    except (ValueError, TypeError) as error:
        raise InputError(f"a setting cannot be used: {refusal(error)}") from error
    kind = _check(settings)
    mesh, seen = _load(settings)
    rotation = look_at_origin(settings.azimuth, settings.elevation, settings.roll)
    camera = framed(seen, rotation, settings.field_of_view, settings.margin)
    settings.renderer.check()
    view = View(mesh, camera, settings.renderer, settings.size)
    steps = ("lines", "hand", "medium")
    rngs = dict(zip(steps, np.random.default_rng(settings.seed).spawn(len(steps)), strict=True))
    strokes, maps = draw_strokes(view, settings.lines, settings.hand, rngs.__getitem__)
    if not strokes:
        where = f"{settings.mesh} at azimuth {settings.azimuth:g} and elevation {settings.elevation:g}"
        raise no_lines(settings.lines, where, settings.size)
    with writing("the drawing"):
        if kind == ".svg":
            write_bytes(settings.output, to_svg(strokes, settings.size).encode())
        else:
            ink = draw_ink(strokes, settings.size, settings.medium, rngs.__getitem__)
            write_bytes(settings.output, encode_grey(1 - ink))
        if settings.normal is not None:
            # With alpha, because by colour alone a hole looks like a surface that faces the viewer.
            flat = paint_flat(maps.normal, maps.mask)
            write_bytes(settings.normal, encode_png(flat, alpha=maps.mask.astype(np.float32)))
    for path in (settings.output, settings.normal):
        if path is not None:
            print(printable(path))
    return 0


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan sketch",
        usage="%(prog)s MESH [-o FILE.svg|FILE.png] [--SETTING VALUE]...",
        description="Draw a mesh from a view in a style.",
    )
    parser.plugins = _PLUGINS
    parser.add_argument(
        "mesh",
        help="mesh file, or embedded animal: a species such as horse, or a variation of it such as horse-7",
    )
    parser.add_argument(
        "-o", "--output", default="sketch.svg", help="output file, .svg or .png (default %(default)s)"
    )
    parser.add_argument(
        "--normal", type=str | None, help="file for the normal map, .png; by default none is written"
    )
    parser.add_argument(
        "--size", type=Side, default=512, help="side of the drawing in pixels (default %(default)s)"
    )
    _add_view(parser)
    parser.add_argument(
        "--lines",
        type=LineDrawing,
        help="line style, a class listed by `normalgan plugins` (default SuggestiveContours)",
    )
    parser.add_argument(
        "--renderer",
        type=Renderer,
        help="renderer, a class listed by `normalgan plugins` (default EmbreeRenderer)",
    )
    parser.add_argument(
        "--hand", type=Hand | None, help="unsteadiness of hand-drawn lines; by default lines are exact"
    )
    parser.add_argument("--medium", type=Medium | None, help="pen and paper, PNG only; by default clean ink")
    parser.add_argument(
        "--seed", type=NonNegativeInt, default=0, help="seed of the style, the hand and the medium"
    )
    defaults = {"lines": SuggestiveContours, "renderer": EmbreeRenderer}
    parser.set_defaults({name: {"class_path": cls.__name__} for name, cls in defaults.items()})
    return parser


def _add_view(parser: LightParser) -> None:
    parser.add_argument(
        "--azimuth",
        type=float,
        default=45.0,
        help="degrees from the front, +Z, towards +X (default %(default)s)",
    )
    parser.add_argument(
        "--elevation", type=float, default=15.0, help="degrees above the horizon (default %(default)s)"
    )
    parser.add_argument("--roll", type=float, default=0.0, help="degrees counter-clockwise")
    parser.add_argument(
        "--field_of_view",
        type=Degrees | None,
        help="angle in degrees that the object fills; by default the view is orthographic",
    )
    parser.add_argument(
        "--margin",
        type=Margin,
        default=0.06,
        help="margin around the object, as a fraction of the side (default %(default)s)",
    )
    parser.add_argument("--orientation", type=str | None, help="JSON file with the orientation of the mesh")
    parser.add_argument(
        "--clip",
        type=str | None,
        help="animation of a rigged glTF file; the framing is the same at all times",
    )
    parser.add_argument(
        "--time", type=float | None, help="time within the clip in seconds; by default its start"
    )
    parser.add_argument("--crease_angle", type=float | None, help="minimum angle in degrees of a sharp edge")


def _load(settings: Namespace) -> tuple[Mesh, NDArray[np.floating]]:
    """Return the mesh, and the vertices (V, 3) to frame; for a clip, the vertices at all times."""
    source = _find_source(settings.mesh, settings.orientation, settings.crease_angle)
    if settings.clip is None:
        if settings.time is not None:
            raise InputError("a time needs a clip; name one with --clip.")
        mesh = source.load()
        return mesh, mesh.vertices
    if not isinstance(source, MeshFile) or Path(source.path).suffix.lower() not in container.SUFFIXES:
        raise InputError(f"{settings.mesh} has no clips; give a rigged glTF file.")
    from normalgan.rendering.rigs import ClipMeshes  # imports scipy, which takes half a second

    meshes = ClipMeshes(source, settings.clip)
    first, last = meshes.span
    time = first if settings.time is None else settings.time
    if not first <= time <= last:
        raise InputError(f"time is {time}; the clip {settings.clip} runs from {first:g} to {last:g} seconds.")
    return meshes.mesh(time), meshes.hull


def _find_source(name: str, orientation: str | None = None, crease_angle: float | None = None) -> MeshSource:
    """Return the mesh file with this name or, if there is none, the embedded animal.

    Raises:
        InputError: if the name is neither, or matches several files.
    """
    animal = re.fullmatch(r"([a-z_]+)(?:-(\d{1,9}))?", name)
    if animal and not Path(name).exists():
        if animal[1] not in SPECIES:
            raise InputError(
                f"{name} is neither a mesh file ({', '.join(sorted(SUFFIXES))}) nor an embedded "
                f"animal.{did_you_mean(animal[1], SPECIES)} The animals: {', '.join(SPECIES)}."
            )
        return Animal(animal[1], int(animal[2] or 0))
    found = find_meshes([name], orientation, crease_angle)
    if len(found) > 1:
        raise InputError(f"{name} holds {len(found)} meshes; name one, such as {found[0].path}.")
    return found[0]


def _check(settings: Namespace) -> str:
    """Return the suffix of the output file; raise `InputError` if the settings contradict each other."""
    refuse_empty(settings, "output", "normal", "orientation")
    kind = Path(settings.output).suffix.lower()
    if kind not in {".svg", ".png"}:
        raise InputError(f"the drawing {settings.output} must be a .svg or a .png.")
    if settings.normal is not None and Path(settings.normal).suffix.lower() != ".png":
        raise InputError(f"the normal map {settings.normal} must be a .png.")
    read = [Path(each).resolve() for each in (settings.mesh, settings.orientation) if each]
    for path in filter(None, (settings.output, settings.normal)):
        if Path(path).resolve() in read:
            raise InputError(f"{path} is an input and would be overwritten; give another name.")
    if settings.normal is not None and Path(settings.normal).resolve() == Path(settings.output).resolve():
        raise InputError(f"{settings.output} would be written twice; give --normal another name.")
    if kind == ".svg" and settings.medium is not None:
        raise InputError(f"a medium needs pixels; write {settings.output} as .png, or omit the medium.")
    return kind
