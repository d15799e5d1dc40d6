"""Outputs: what is written for a drawing: its normal map; on request pictures, a height map, a relief."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.inference.jobs.plan import Job
from normalgan.inference.network.tile import middle, wrapped
from normalgan.inference.normal_map import Format, NormalMap, as_it_lies, part_of
from normalgan.inference.outputs.engines import CONVENTIONS, Engine, sidecar
from normalgan.normals import Bits, Green, encode_grey

__all__ = [
    "FEWEST",
    "SHADING",
    "Heights",
    "Outputs",
    "Shading",
    "encode_height",
    "engine_defaults",
    "level_heights",
    "shading_of",
]

Heights = list[tuple[Path, float]]
"""Height maps as PNG, and how far each reaches from black to white, in pixels of its map."""

Shading = Literal["ao", "curvature", "specular"]
SHADING: tuple[Shading, ...] = ("ao", "curvature", "specular")
"""What the files of `shading_of` are called."""
_OFF: dict[Shading, float] = {"ao": 1, "curvature": 0.5, "specular": 0}
"""What they hold off the object."""
_BESIDE = 0.25
"""How much of its repeats is looked at about a map that has some, as a share of its longer side."""
FEWEST = 12
"""Fewest triangles of a relief that is closed."""


@dataclass(frozen=True)
class Outputs:
    """What is to be written for each drawing.

    Args:
        suffix: of the map's name, after the drawing's.
        format: of the map; exr and tiff hold floats.
        bits: of each channel of a PNG.
        y: up is green as in OpenGL, down as in DirectX.
        alpha: write the object's mask as alpha channel.
        engine: sets y, bits and suffix as it wants them, and writes what it imports the map by.
        show_input: write what the model saw.
        preview: write the map under a lamp that goes around it.
        height: write a height map: png is 16 bits from the lowest to the highest, tiff floats in pixels.
        height_scale: pixels from black to white of a height png; batch takes those of the highest drawing.
        relief: write a relief mesh.
        faces: triangles of the relief at most; null is four for each pixel.
        ao: write the ambient occlusion.
        curvature: write the curvature, ridges light and hollows dark.
        specular: write how much each place reflects, ridges polished and hollows dull.

    Raises:
        InputError: if they do not go together.
    """

    suffix: str = "_normal"
    format: Format = "png"
    bits: Bits = 8
    y: Green = "up"
    alpha: bool = False
    engine: Engine | None = None
    show_input: bool = False
    preview: Literal["png", "gif"] | None = None
    height: Literal["png", "tiff"] | None = None
    height_scale: float | Literal["batch"] | None = None
    relief: Literal["glb", "obj"] | None = None
    faces: int | None = None
    ao: bool = False
    curvature: bool = False
    specular: bool = False

    def __post_init__(self) -> None:
        if self.bits not in {8, 16}:
            raise InputError(f"the bits of a normal map are 8 or 16, not {self.bits}.")
        if self.bits == 16 and self.format != "png":
            raise InputError(f"bits are of a PNG; a map as {self.format} always has floats of 32 bits.")
        if self.suffix and Path(self.suffix).name != self.suffix:
            raise InputError(f"the suffix {self.suffix!r} is no part of a file's name; it is like _normal.")
        if self.height_scale is not None and self.height != "png":
            raise InputError("a height_scale is that of a height png; add --height png.")
        if isinstance(self.height_scale, float | int) and not self.height_scale > 0:
            raise InputError(f"height_scale is {self.height_scale}; it is pixels, more than 0, or batch.")
        if self.faces is not None and (self.relief is None or self.faces < FEWEST):
            raise InputError(f"faces are those of a relief (--relief glb), {FEWEST} or more.")

    @property
    def ending(self) -> str:
        """What a map's name ends in, such as ``_normal.png``."""
        return f"{self.suffix}.{self.format}"

    def others(self) -> Iterator[str]:
        """Yield what the names of everything else end in."""
        if self.show_input:
            yield "_input.png"
        for name in ("preview", "height", "relief"):
            if kind := getattr(self, name):
                yield f"_{name}.{kind}"
        yield from (f"_{name}.png" for name in SHADING if getattr(self, name))

    def write(self, job: Job, preds: NormalMap) -> Heights:
        """Write what belongs to a drawing, each file whole or not at all; return the height maps.

        Raises:
            OSError: if a file cannot be written.
        """
        heights = self.write_others(job, preds)
        self.write_map(job, preds)  # last, so that where there is a map, there is the rest too
        return heights

    def write_map(self, job: Job, preds: NormalMap) -> None:
        """Write the map alone, and what an engine imports it by."""
        self.write_sidecar(job.target)
        write_bytes(job.target, preds.encode(self.format, self.bits, self.y, self.alpha))

    def write_sidecar(self, target: Path) -> None:
        """Write what an engine imports a map by, unless the engine has it already.

        Unity's and Godot's own file holds the id by which scenes name the map, and what was set there since.
        """
        if self.engine is None:
            return
        # Of the whole path: two folders may each have a normals/fox_NormalMap.png, and their ids must differ.
        path, content = sidecar(self.engine, target.absolute())
        if path.suffix == ".py" or not path.exists():
            write_bytes(path, content)

    def write_others(self, job: Job, preds: NormalMap) -> Heights:
        """Write all but the map; return the height maps."""
        if self.show_input:
            write_bytes(job.beside("_input.png"), encode_grey(1 - preds.seen))
        if self.preview is not None:
            from normalgan.inference.outputs.preview import preview_gif, preview_png

            lit = preview_png if self.preview == "png" else preview_gif
            write_bytes(job.beside(f"_preview.{self.preview}"), lit(as_it_lies(preds), preds.mask))
        height = preds.height() if self._needs_height else None
        self._write_shading(job, preds, height)
        if height is None:
            return []
        if self.relief is not None:
            from normalgan.inference.heights.relief import relief_mesh, simpler, write_relief

            shape = height, preds.mask
            simple = shape if self.faces is None else simpler(*shape, self.faces)
            write_relief(job.beside(f"_relief.{self.relief}"), relief_mesh(*simple))
        if self.height is None:
            return []
        path = job.beside(f"_height.{self.height}")
        inside = height[preds.mask] if preds.mask.any() else np.zeros(1, np.float32)
        spread = max(float(np.ptp(inside)), 1e-6)
        if isinstance(self.height_scale, float | int):
            spread = float(self.height_scale)
        write_bytes(path, encode_height(height, preds, self.height, spread))
        return [(path, spread)] if self.height == "png" else []

    @property
    def _needs_height(self) -> bool:
        return self.height is not None or self.relief is not None or self.ao or self.specular

    def _write_shading(self, job: Job, preds: NormalMap, height: Floats | None) -> None:
        wanted = [name for name in SHADING if getattr(self, name)]
        for name, values in shading_of(preds, wanted, height).items():
            write_bytes(job.beside(f"_{name}.png"), encode_grey(values))


def shading_of(
    preds: NormalMap, wanted: Collection[Shading], height: Floats | None = None
) -> dict[Shading, Floats]:
    """Return maps of how much light a surface is given and gives back, (H, W) in [0, 1].

    Args:
        preds: the map they are of.
        wanted: which of them.
        height: (H, W) in pixels, as `NormalMap.height` gives it; None has it integrated where it is needed.
    """
    if not wanted:
        return {}
    if preds.cells:
        return _shading_of_cells(preds, wanted, preds.height() if height is None else height)
    from normalgan.inference.outputs.occlusion import occlusion
    from normalgan.inference.outputs.shading_maps import curvature, gloss

    longest = max(preds.mask.shape)
    room = (round(_BESIDE * longest),) * 2
    normals, mask = (wrapped(each, preds.tile, room) for each in (preds.extended, preds.mask))
    maps: dict[Shading, Floats] = {}
    if "ao" in wanted or "specular" in wanted:
        height = preds.height() if height is None else height
        around = wrapped(height.astype(np.float32, copy=False), preds.tile, room)
        maps["ao"] = occlusion(around, normals, mask, longest)
    if "curvature" in wanted or "specular" in wanted:
        maps["curvature"] = curvature(normals, mask, longest)
    if "specular" in wanted:
        maps["specular"] = gloss(maps["ao"], maps["curvature"], mask)
    return {name: middle(maps[name], preds.tile, room) for name in SHADING if name in wanted}


def _shading_of_cells(preds: NormalMap, wanted: Collection[Shading], height: Floats) -> dict[Shading, Floats]:
    """Return what `shading_of` does of a sheet: no drawing of it shades another."""
    maps = {name: np.full(preds.mask.shape, _OFF[name], np.float32) for name in SHADING if name in wanted}
    for cell in preds.cells:
        own = np.ascontiguousarray(cell.upright(height[cell.box]))
        for name, values in shading_of(part_of(preds, cell), wanted, own).items():
            cell.put(maps[name], values)
    return maps


def encode_height(
    height: Floats, preds: NormalMap, kind: Literal["png", "tiff"], spread: float | None = None
) -> bytes:
    """Return the content of a height map's file.

    Args:
        height: (H, W) in pixels, as `NormalMap.height` gives it.
        preds: the map it is of.
        kind: png is 16 bits from the lowest to the highest, tiff floats in pixels.
        spread: pixels from black to white of a png; None is from the lowest to the highest.
    """
    inside = height[preds.mask] if preds.mask.any() else np.zeros(1, np.float32)
    if kind == "tiff":
        return encode_grey(np.where(preds.mask, height, inside.min()), ".tiff")
    spread = max(float(np.ptp(inside)), 1e-6) if spread is None else spread
    return encode_grey(np.where(preds.mask, (height - inside.min()) / spread, 0), ".png", 16)


def level_heights(heights: Sequence[tuple[Path, float]]) -> None:
    """Write height maps anew with one scale for all: that of the one that reaches farthest.

    Raises:
        OSError: if one cannot be read or written.
    """
    import cv2

    most = max((spread for _, spread in heights), default=0.0)
    for path, spread in heights:
        levels = cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_UNCHANGED)
        if levels is None:
            raise OSError(0, "it is no height map any more", str(path))
        if spread < most:
            write_bytes(
                path, encode_grey(np.asarray(levels * (spread / most / 65535), np.float32), ".png", 16)
            )


def engine_defaults(engine: Engine) -> dict[str, object]:
    """Return the settings of `Outputs` that an engine sets, unless the user does."""
    convention = CONVENTIONS[engine]
    return {"y": convention.y, "bits": convention.bits, "suffix": convention.suffix}
