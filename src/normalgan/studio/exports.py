"""Exports: files of a painted drawing, the very ones that `normalgan generate` writes."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from normalgan.painting.jobs import DrawingFiles, Job
from normalgan.painting.normal_map import NormalMap
from normalgan.painting.outputs import Outputs
from normalgan.studio.drawing import LEAST_SIDE, MOST_SIDE
from normalgan.studio.fields import Fields, take_choice, take_integer, take_text
from normalgan.studio.names import LONGEST, check_name

FORMATS = {
    "map": ("png8", "png16", "exr", "tiff"),
    "preview": ("png", "gif"),
    "height": ("png", "tiff"),
    "relief": ("glb", "obj"),
}
"""What can be exported, and as what; the first is the default."""


@dataclass(frozen=True)
class Wish:
    """One file that is wanted.

    Args:
        name: of the drawing, without a suffix.
        kind: ``map``, or what lies beside it.
        outputs: how it is written.
        longest: longer side in pixels; None is the drawing's.
    """

    name: str
    kind: str
    outputs: Outputs
    longest: int | None

    def write(self, preds: NormalMap) -> tuple[str, bytes]:
        """Return the file's name and what is in it."""
        with TemporaryDirectory() as folder:
            target = Path(folder) / f"{self.name}{self.outputs.ending}"
            job = Job(DrawingFiles(Path(f"{self.name}.png")), target, self.name)
            self.outputs.write(job, preds)
            file = target if self.kind == "map" else job.beside(next(iter(self.outputs.others())))
            return file.name, file.read_bytes()


def take_wish(fields: Fields) -> Wish:
    """Return what a request wants to have written.

    Raises:
        InputError: if a field cannot be used.
    """
    kind = take_choice(fields, "what", tuple(FORMATS), "map")
    chosen = take_choice(fields, "format", FORMATS[kind], FORMATS[kind][0])
    y = take_choice(fields, "y", ("up", "down"), "up")
    alpha = take_choice(fields, "alpha", (False, True), False)
    longest = None
    if fields.get("size") is not None:
        longest = take_integer(fields, "size", LEAST_SIDE, MOST_SIDE)
    name = check_name(take_text(fields, "name", LONGEST) if "name" in fields else "drawing")
    if kind != "map":
        return Wish(name, kind, Outputs(**{kind: chosen}), longest)
    bits = {"png8": 8, "png16": 16}.get(chosen)
    if bits is None:
        return Wish(name, kind, Outputs(format=chosen, y=y, alpha=alpha), longest)
    return Wish(name, kind, Outputs(format="png", bits=16 if bits == 16 else 8, y=y, alpha=alpha), longest)
