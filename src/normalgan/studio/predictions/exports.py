"""Exports: encode one or all files of a drawing as `normalgan generate` writes them."""

import io
import json
import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Final, Literal

from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.normal_map import Format, NormalMap
from normalgan.inference.outputs import OUTPUTS, Normal, Output, Preview
from normalgan.inference.outputs.engines import CONVENTIONS, Engine
from normalgan.normals import Bits
from normalgan.studio.drawings.drawing_request import read_png
from normalgan.studio.drawings.schemas import ExportFields
from normalgan.studio.names import check_name
from normalgan.studio.page_files import PAGE


@dataclass(frozen=True)
class Preset:
    """The file conventions of a program.

    Args:
        notes: instructions for importing the files; ``{linear}`` stands for the suffixes of data textures.
        engine: engine whose names and conventions the files follow, or None.
        prefix: prefix of all names.
        line_art: suffix of the line art.
        colours: suffix of the drawing in colour.
    """

    notes: str
    engine: Engine | None = None
    prefix: str = ""
    line_art: str = "_line"
    colours: str = "_colour"

    @property
    def normal(self) -> Normal:
        """The settings of the map, the same as with `normalgan generate --engine`."""
        if self.engine is None:
            return Normal(alpha=True)
        wanted = CONVENTIONS[self.engine]
        return Normal(y=wanted.y, bits=wanted.bits, suffix=wanted.suffix, alpha=True, engine=self.engine)

    @property
    def readme(self) -> str:
        """The text of the zip's README."""
        suffixes = [kind.zip_suffix(self.engine) for kind in _zipped_kinds()]
        return self.notes.format(linear=f"{', '.join(suffixes[:-1])} and {suffixes[-1]}") + "\n"


_PRESETS: Final = {
    "unity": Preset(
        "Unity: the .meta file marks _NormalMap as a normal map, which sprites use as a secondary texture. "
        "Switch sRGB off for {linear}.",
        "unity",
        line_art="_LineArt",
        colours="_Colour",
    ),
    "unreal": Preset(
        "Unreal: green points down (DirectX) as the engine expects. Set the compression of _N to Normalmap, "
        "and of {linear} to Masks (no sRGB); the script does so for _N.",
        "unreal",
        prefix="T_",
        line_art="_L",
        colours="_D",
    ),
    "godot": Preset(
        "Godot: green points up (OpenGL) as the engine expects. Use _n as the normal texture of a "
        "CanvasTexture and _specular as its specular texture, or _n as Normal Map of a StandardMaterial3D.",
        "godot",
    ),
    "godot3": Preset(
        "Godot 3: green points down, as its 2D lights read it. Use _n as the Normal Map of a Sprite.",
        "godot3",
    ),
    "blender": Preset(
        "Blender: set the colour space of all but _line, _colour and _preview to Non-Color, and put _normal "
        "through a Normal Map node, as the script does. _height is in pixels.",
        "blender",
    ),
}
_PLAIN: Final = Preset("Green points up (OpenGL); flip it for DirectX.")


def _zipped_kinds() -> list[type[Output]]:
    return [kind for kind in OUTPUTS if kind.in_zip]


_FORMATS: Final[dict[str, Format]] = {"png8": "png", "png16": "png", "exr": "exr", "tiff": "tiff"}


def offered() -> dict[str, tuple[str, ...]]:
    """Return the formats of each export by name; the first format is the default."""
    beside = {kind.name: kind.formats() for kind in OUTPUTS}
    return {"map": tuple(_FORMATS), "all": ("plain", *_PRESETS), **beside}


def with_export_menu(page: str) -> str:
    """Return the page with the export menu inserted.

    Labels come from the page's texts, or from the output if the page has no text for it. Each entry lists its
    file names, with ``{}`` for the drawing's name.
    """
    labels = {kind.name: kind.label for kind in OUTPUTS}
    options = []
    for name, formats in offered().items():
        word = f"what{name.capitalize()}"
        known = f"  {word}: " in (PAGE / "text" / "text.js").read_text(encoding="utf-8")
        own, label = (f' data-text="{word}"', "") if known else ("", escape(labels[name]))
        files = {form: _request("{}", name, form, line_art=b"", colours=b"").names for form in formats}
        more = f'data-formats="{" ".join(formats)}" data-files="{escape(json.dumps(files))}"'
        options.append(f'<option value="{name}" {more}{own}>{label}</option>')
    down = " ".join(name for name, preset in _PRESETS.items() if preset.normal.y == "down")
    return page.replace("<!-- outputs -->", "".join(options)).replace("<!-- down -->", down)


@dataclass(frozen=True)
class ExportRequest:
    """The files to export of a drawing.

    Args:
        name: name of the drawing, without a suffix.
        output: kind of file; None exports a zip file of all kinds.
        longest: longer side in pixels; None keeps the drawing's size.
        preset: target program of a zip file.
        line_art: PNG of the lines, for the zip file.
        colours: PNG of the drawing in colour, for the zip file.
        lit: PNG of the map under the user's lights, for the zip file; None lights it from the upper left.
    """

    name: str
    output: Output | None
    longest: int | None
    preset: str = "plain"
    line_art: bytes | None = None
    colours: bytes | None = None
    lit: bytes | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the files."""
        return tuple(name for name, _ in self._files(None))

    def encode(self, preds: NormalMap) -> tuple[str, bytes]:
        """Return the name and content of the file; several files are zipped."""
        # A temporary copy, which caches the heights for all outputs.
        files = list(self._files(replace(preds)))
        if self.output is not None and len(files) == 1:
            return files[0]
        kind = self.preset if self.output is None else self.output.name
        return f"{self.name}_{kind}.zip", _zipped(files)

    def _files(self, preds: NormalMap | None) -> Iterator[tuple[str, bytes]]:
        """Yield the name and content of each file; without a map, only the names are meaningful."""

        def encoded(output: Output) -> Iterable[tuple[str, bytes]]:
            files = dict.fromkeys(output.endings, b"") if preds is None else output.encode(preds)
            return files.items()

        if self.output is not None:
            for ending, content in encoded(self.output):
                yield self.name + ending, content
            return
        preset = _PRESETS.get(self.preset, _PLAIN)
        own, normal = preset.prefix + self.name, preset.normal
        for ending, content in encoded(normal):
            yield own + ending, content
            if (beside := normal.sidecar(Path(own + ending))) is not None:
                yield beside[0].name, beside[1]
        for kind in _zipped_kinds():
            form = None if preset.engine is None else kind.engine_formats.get(preset.engine)
            for ending, content in encoded(kind() if form is None else kind(format=form)):
                suffix = kind.zip_suffix(preset.engine) + ending.removeprefix(f"_{kind.name}")
                yield own + suffix, content
        lit = _preview(preds) if self.lit is None and preds is not None else self.lit
        yield f"{own}{Preview.zip_suffix(preset.engine)}.png", lit or b""
        for suffix, picture in ((preset.line_art, self.line_art), (preset.colours, self.colours)):
            if picture is not None:
                yield f"{own}{suffix}.png", picture
        yield "README.txt", preset.readme.encode()


def _zipped(files: Iterable[tuple[str, bytes]]) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in files:
            # Fixed time stamps make the zip deterministic. Pictures are already compressed.
            archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), content)
    return file.getvalue()


def _preview(preds: NormalMap) -> bytes:
    """Return a PNG of the map as clay, lit from the upper left."""
    from normalgan.inference.outputs.preview import lit

    file = io.BytesIO()
    Image.fromarray(lit(preds.extended, preds.mask, 130, 40)).save(file, "PNG")
    return file.getvalue()


def read_export_request(fields: ExportFields) -> ExportRequest:
    """Return the export described by the fields of a request.

    Raises:
        InputError: if the kind or the format is unknown, the name is invalid, or a picture cannot be read.
    """
    formats = offered()
    kind = _known("what", fields.what, formats)
    chosen = formats[kind][0] if fields.format is None else _known("format", fields.format, formats[kind])
    name = check_name(fields.name)
    request = _request(name, kind, chosen, longest=fields.size, y=fields.y, alpha=fields.alpha)
    if kind != "all":
        return request
    pictures = {
        "line art": fields.line_art,
        "drawing in colour": fields.colours,
        "lit picture": fields.lit_picture,
    }
    for title, content in pictures.items():
        if content is not None:
            read_png(title, content)  # only valid pictures go into the zip
    return replace(request, line_art=fields.line_art, colours=fields.colours, lit=fields.lit_picture)


def _known(field: str, value: str, choices: Iterable[str]) -> str:
    if value not in choices:
        known = ", ".join(map(repr, choices))
        raise InputError(f"{field} is {value[:40]!r}; it should be one of {known}.")
    return value


def _request(
    name: str,
    kind: str,
    chosen: str,
    *,
    longest: int | None = None,
    y: Literal["up", "down"] = "up",
    alpha: bool = False,
    line_art: bytes | None = None,
    colours: bytes | None = None,
) -> ExportRequest:
    """Return the export request for a kind of file in one of its formats."""
    if kind == "all":
        return ExportRequest(name, None, longest, chosen, line_art, colours)
    if kind == "map":
        bits: Bits = 16 if chosen == "png16" else 8
        return ExportRequest(name, Normal(_FORMATS[chosen], bits=bits, y=y, alpha=alpha), longest)
    wanted = next(each for each in OUTPUTS if each.name == kind)
    return ExportRequest(name, wanted(format=chosen), longest)
