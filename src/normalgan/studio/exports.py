"""Exports: files of a painted drawing, the very ones that `normalgan generate` writes, one or all at once."""

import io
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, Literal

from PIL import Image

from normalgan.inference.jobs.plan import DrawingFiles, Job
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.engines import CONVENTIONS, Engine, sidecar
from normalgan.inference.outputs.outputs import SHADING, Outputs, Shading, encode_height, shading_of
from normalgan.normals import encode_grey
from normalgan.studio.drawing import LEAST_SIDE, MOST_SIDE, read_png
from normalgan.studio.fields import Fields, take_bytes, take_choice, take_integer, take_text
from normalgan.studio.names import LONGEST, check_name

__all__ = ["FORMATS", "PRESETS", "ExportRequest", "Names", "Preset", "read_export_request"]

FORMATS = {
    "map": ("png8", "png16", "exr", "tiff"),
    "preview": ("png", "gif"),
    "height": ("png", "tiff"),
    "relief": ("glb", "obj"),
    "mask": ("png",),
    "occlusion": ("png",),
    "curvature": ("png",),
    "specular": ("png",),
    "all": ("plain", "unity", "unreal", "godot", "godot3", "blender"),
}
"""What can be exported, and as what; the first is the default."""


@dataclass(frozen=True)
class Names:
    """What a program's files are called but the map, each with ``{}`` for the drawing's name.

    Args:
        line: line art.
        mask: where the object is.
        height: height map.
        ao: ambient occlusion.
        curvature: ridges and hollows.
        specular: how much each place reflects.
        preview: the map under a lamp.
    """

    line: str = "{}_line"
    mask: str = "{}_mask"
    height: str = "{}_height"
    ao: str = "{}_ao"
    curvature: str = "{}_curvature"
    specular: str = "{}_specular"
    preview: str = "{}_preview"

    def of(self, drawing: str) -> "Names":
        """Return the names of a drawing's files, without endings."""
        return Names(**{part: name.format(drawing) for part, name in asdict(self).items()})


@dataclass(frozen=True)
class Preset:
    """How a program wants its files.

    Args:
        names: of its files.
        notes: what is to be set there, a sentence.
        engine: which has conventions for the map, and a file by which it imports it; None has none.
        prefix: of all names.
        height: kind of the height map.
    """

    names: Names
    notes: str
    engine: Engine | None = None
    prefix: str = ""
    height: Literal["png", "tiff"] = "png"

    @property
    def outputs(self) -> Outputs:
        """How its files are written: as `normalgan generate --engine` does."""
        plain = Outputs(height=self.height, alpha=True)
        if self.engine is None:
            return plain
        wanted = CONVENTIONS[self.engine]
        return replace(plain, y=wanted.y, bits=wanted.bits, suffix=wanted.suffix)


PRESETS: Final = {
    "unity": Preset(
        Names(
            line="{}_LineArt",
            mask="{}_Mask",
            height="{}_Height",
            ao="{}_Occlusion",
            curvature="{}_Curvature",
            specular="{}_Specular",
            preview="{}_Preview",
        ),
        "Unity: the file .meta makes _NormalMap a normal map, which sprites take for a secondary texture. "
        "Switch sRGB off for _Mask, _Height, _Occlusion, _Curvature and _Specular.",
        "unity",
    ),
    "unreal": Preset(
        Names(
            line="{}_L",
            mask="{}_M",
            height="{}_H",
            ao="{}_AO",
            curvature="{}_C",
            specular="{}_S",
            preview="{}_Preview",
        ),
        "Unreal: green points down (DirectX) as the engine expects. Set the compression of _N to Normalmap, "
        "and of _M, _H, _AO, _C and _S to Masks (no sRGB); the script does so for _N.",
        "unreal",
        prefix="T_",
    ),
    "godot": Preset(
        Names(),
        "Godot: green points up (OpenGL) as the engine expects. Use _n as the normal texture of a "
        "CanvasTexture and _specular as its specular texture, or _n as Normal Map of a StandardMaterial3D.",
        "godot",
    ),
    "godot3": Preset(
        Names(),
        "Godot 3: green points down, as its 2D lights read it. Use _n as the Normal Map of a Sprite.",
        "godot3",
    ),
    "blender": Preset(
        Names(),
        "Blender: set the colour space of all but _line and _preview to Non-Color, and put _normal through a "
        "Normal Map node, as the script does. _height is in pixels.",
        "blender",
        height="tiff",
    ),
}
_SHADING: Final[dict[str, Shading]] = {"occlusion": "ao", "curvature": "curvature", "specular": "specular"}
_PLAIN: Final = Preset(Names(), "Green points up (OpenGL); flip it for DirectX.")


@dataclass(frozen=True)
class ExportRequest:
    """One file that is wanted.

    Args:
        name: of the drawing, without a suffix.
        kind: ``map``, what lies beside it, or ``all``.
        outputs: how it is written.
        longest: longer side in pixels; None is the drawing's.
        preset: for what program, if it is all.
        line_art: PNG of the lines, if it is all.
    """

    name: str
    kind: str
    outputs: Outputs
    longest: int | None
    preset: str = "plain"
    line_art: bytes | None = None

    def write(self, preds: NormalMap) -> tuple[str, bytes]:
        """Return the file's name and what is in it."""
        match self.kind:
            case "mask":
                return f"{self.name}_mask.png", encode_grey(preds.alpha)
            case "occlusion" | "curvature" | "specular":
                name = _SHADING[self.kind]
                return f"{self.name}_{name}.png", encode_grey(shading_of(preds, [name])[name])
            case "all":
                return f"{self.name}_{self.preset}.zip", self._zip(preds)
        with TemporaryDirectory() as folder:
            target = Path(folder) / f"{self.name}{self.outputs.ending}"
            job = Job(DrawingFiles(Path(f"{self.name}.png")), target, self.name)
            self.outputs.write(job, preds)
            file = target if self.kind == "map" else job.beside(next(iter(self.outputs.others())))
            return file.name, file.read_bytes()

    def _zip(self, preds: NormalMap) -> bytes:
        """Return all files, as a program wants them."""
        preset = PRESETS.get(self.preset, _PLAIN)
        file = io.BytesIO()
        with zipfile.ZipFile(file, "w") as archive:
            for name, content in self._files(preset, preds):
                # The same drawing gives the same bytes; pictures are compressed already.
                archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), content)
        return file.getvalue()

    def _files(self, preset: Preset, preds: NormalMap) -> Iterator[tuple[str, bytes]]:
        own = preset.prefix + self.name
        names = preset.names.of(own)
        outputs, height = preset.outputs, preds.height()
        target = Path(own + outputs.ending)
        yield target.name, preds.encode(outputs.format, outputs.bits, outputs.y, outputs.alpha)
        if preset.engine is not None:
            beside, content = sidecar(preset.engine, target)
            yield beside.name, content
        yield f"{names.mask}.png", encode_grey(preds.alpha)
        yield f"{names.height}.{preset.height}", encode_height(height, preds, preset.height)
        for name, values in shading_of(preds, SHADING, height).items():
            yield f"{getattr(names, name)}.png", encode_grey(values)
        yield f"{names.preview}.png", _preview(preds)
        if self.line_art is not None:
            yield f"{names.line}.png", self.line_art
        yield "README.txt", f"{preset.notes}\n".encode()


def _preview(preds: NormalMap) -> bytes:
    """Return the map as clay under a lamp at the upper left, a PNG."""
    from normalgan.inference.outputs.preview import lit

    file = io.BytesIO()
    Image.fromarray(lit(preds.extended, preds.mask, 130, 40)).save(file, "PNG")
    return file.getvalue()


def read_export_request(fields: Fields) -> ExportRequest:
    """Return what a request wants to have written.

    Raises:
        InputError: if a field cannot be used.
    """
    kind = take_choice(fields, "what", tuple(FORMATS), "map")
    chosen = take_choice(fields, "format", FORMATS[kind], FORMATS[kind][0])
    y: Literal["up", "down"] = take_choice(fields, "y", ("up", "down"), "up")
    alpha = take_choice(fields, "alpha", (False, True), False)
    longest = None
    if fields.get("size") is not None:
        longest = take_integer(fields, "size", LEAST_SIDE, MOST_SIDE)
    name = check_name(take_text(fields, "name", LONGEST) if "name" in fields else "drawing")
    if kind == "all":
        art = None
        if fields.get("line_art") is not None:
            art = take_bytes(fields, "line_art")
            read_png("line art", art)  # what is no picture is none of the files
        return ExportRequest(name, kind, Outputs(), longest, chosen, art)
    if kind == "mask" or kind in _SHADING:
        return ExportRequest(name, kind, Outputs(), longest)
    if kind != "map":
        return ExportRequest(name, kind, Outputs(**{kind: chosen}), longest)
    bits = {"png8": 8, "png16": 16}.get(chosen)
    if bits is None:
        return ExportRequest(name, kind, Outputs(format=chosen, y=y, alpha=alpha), longest)
    return ExportRequest(
        name, kind, Outputs(format="png", bits=16 if bits == 16 else 8, y=y, alpha=alpha), longest
    )
