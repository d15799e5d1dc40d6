"""Painting a job: a file of whatever kind, one drawing or many, to what is written for it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask
from normalgan.decoding import decode_frames
from normalgan.decoding.worker import is_svg
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.inference.composites.animation import encode_animation, kind_of, moving_kind
from normalgan.inference.composites.layered_job import LayeredJob, layered_target
from normalgan.inference.composites.packing import Packing
from normalgan.inference.composites.series import Member, flat_map, left_flat, predict_series
from normalgan.inference.composites.sheets import predict_sheet
from normalgan.inference.inputs import as_hints
from normalgan.inference.jobs.plan import DrawingFiles, Job
from normalgan.inference.mask.masks import load_mask
from normalgan.inference.network.tile import Tile
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.outputs import Heights, Outputs, level_heights
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.drawings import LARGEST, SMALLEST, SVG_SIDE, read_content, read_pixels
from normalgan.inference.reading.picture import Picture, fitted, read_picture, resize, to_picture
from normalgan.inference.reading.svg_size import svg_size

__all__ = ["MOST_TOGETHER", "Done", "Framing", "JobPredictor", "target_of", "written_for"]

Framing = Literal["own", "shared"]
MOST_TOGETHER = 2**26
"""Pixels of all drawings that share a frame: they are in memory together."""

_SHEET = 4
"""Objects of like size from which a picture is a sheet: three may be a scene of one's own."""
_ALIKE = 0.3
"""Share of the largest one's area that makes one alike."""
_LOOKED = 512
"""Longest side at which they are counted."""


@dataclass(frozen=True)
class Done:
    """What came of a job.

    Args:
        target: where the map is.
        warning: what is to be said of it, a part of a sentence; empty if nothing is.
        heights: the height maps as PNG.
    """

    target: Path
    warning: str = ""
    heights: Heights = field(default_factory=list)


@dataclass(frozen=True)
class JobPredictor:
    """Paints what a job names and writes what belongs to it. It may be called by several threads.

    Args:
        predictor: the network.
        outputs: what is written.
        size: longer side of the maps in pixels; None is the drawing's.
        packing: how the drawings of a sheet are found.
        frame: whether the network is shown the same square of all drawings that belong together; None is
            ``shared`` for an animation, and ``own`` else.
        strength: what the slopes of all maps are multiplied by.
        layers: whether each visible layer of a layered file is painted for itself.
        tile: the ways in which each drawing is repeated, and its map can be; None is not at all.
    """

    predictor: Predictor
    outputs: Outputs = field(default_factory=Outputs)
    size: int | None = None
    packing: Packing = field(default_factory=Packing)
    frame: Framing | None = None
    strength: float = 1.0
    layers: bool = False
    tile: Tile | None = None

    def __call__(self, job: Job) -> Done:
        """Paint and write one job.

        Raises:
            InputError: if the drawing cannot be used.
            OSError: if a file cannot be written.
        """
        if self.layers:
            shared = self.frame != "own"
            predict = LayeredJob(self.predictor, self.outputs, self.size, shared, self.strength)
            return Done(self._target(job), *predict(job))
        files, kind = job.files, moving_kind(job.files.drawing, job.files.content)
        if kind is not None and self.packing.given:
            raise InputError(f"{files.drawing} is an animation; a sheet is a still picture.")
        if kind is not None and self.tile is not None:
            raise InputError(f"{files.drawing} is an animation; --tile repeats a still picture.")
        if kind is not None:
            return self._animation(job)
        if job.exact and job.target.suffix.lower() in {".gif", ".webp"}:
            raise InputError(f"{job.target} would be an animation, but {files.drawing} does not move.")
        preds = self._sheet(files) if self.packing.given else self._drawing(files)
        if not self.packing.given and self.tile is None and files.mask is None:
            preds = replace(preds, warning="; ".join(filter(None, [preds.warning, _several(preds.mask)])))
        return self._written(job, preds)

    def together(self, jobs: Sequence[Job]) -> Iterator[tuple[Job, Done | Exception]]:
        """Yield what came of drawings in files of their own that share a frame, in order.

        Raises:
            InputError: if they differ in size, or are too many.
        """
        members, kept, pixels = [], [], 0
        for job in jobs:
            try:
                picture = read_picture(job.files.drawing, job.files.content, self.size)
                member = self._member(picture, job.files)
            except InputError as error:
                yield job, error
                continue
            pixels += picture.size[0] * picture.size[1]
            if pixels > MOST_TOGETHER:
                raise InputError(
                    f"the drawings that are to share a frame have more than {MOST_TOGETHER} pixels together; "
                    "name fewer, or leave --frame shared out."
                )
            members.append(member)
            kept.append(job)
        predicted = predict_series(self.predictor, members, True, True, self.size)
        for job, member, preds in zip(kept, members, predicted, strict=True):
            if isinstance(preds, InputError):
                yield job, preds
                continue
            try:
                yield job, self._written(job, _noted(preds, member.picture.note))
            except OSError as error:
                yield job, error

    def _written(self, job: Job, preds: NormalMap) -> Done:
        heights = self.outputs.write(job, preds.stronger(self.strength))
        return Done(job.target, preds.warning, heights)

    def _drawing(self, files: DrawingFiles) -> NormalMap:
        picture = read_picture(files.drawing, files.content, self.size)
        return _noted(self.predictor(picture, files.hints, files.mask, self.size, self.tile), picture.note)

    def _sheet(self, files: DrawingFiles) -> NormalMap:
        content = read_content(files.drawing, files.content)
        drawn_at_any_size = is_svg(content)
        if self.size is not None and not drawn_at_any_size:
            raise InputError("a sheet of pixels keeps its packing, and so its size; leave --size out.")
        units = svg_size(content) if drawn_at_any_size else None
        sheet = read_pixels(files.drawing, content, self.size or SVG_SIDE)
        hints = as_hints(files.hints, sheet.shape)
        found = self.packing.cells(sheet, files.drawing, files.below, units)
        mask = _mask(files, sheet.shape)
        shared = self.frame == "shared"
        return predict_sheet(self.predictor, sheet, found.cells, hints, mask, shared, found.warnings)

    def _animation(self, job: Job) -> Done:
        path, content = job.files.drawing, job.files.content
        found = decode_frames(str(path), read_content(path, content), (SMALLEST, LARGEST))
        members = [self._member(to_picture(each.decoded), job.files) for each in found.parts]
        shared = self.frame != "own"
        pixels: list[NDArray[np.uint8]] = []
        said: list[str] = []
        failed: list[InputError] = []
        heights: Heights = []
        for number, each in enumerate(predict_series(self.predictor, members, shared, shared, self.size), 1):
            if isinstance(each, InputError):
                preds = flat_map(members[number - 1].picture.shape, self.size)
                failed.append(each)
                said.append(f"frame {number}: {left_flat(each)}")
            else:
                preds = each
                said += [f"frame {number}: {each.warning}"] if each.warning else []
            own = job.numbered(number, self.outputs.ending)
            preds = preds.stronger(self.strength)
            heights += self.outputs.write_others(own, preds)
            if _moves(self.outputs):
                pixels.append(preds.pixels(self.outputs.y, self.outputs.alpha))
            else:
                self.outputs.write_map(own, preds)
        if len(failed) == len(members):
            raise failed[0]
        target = self._target(job)
        if _moves(self.outputs):
            self.outputs.write_sidecar(target)
            durations = [each.duration for each in found.parts]
            write_bytes(target, encode_animation(kind_of(target), pixels, durations, found.loop))
        level_heights(heights)  # else a body would rise and sink with what it holds up
        more = f"; and so on, in {len(said)} of its {len(members)} frames" if len(said) > 1 else ""
        return Done(target, "; ".join(filter(None, [found.note, said[0] + more if said else ""])), heights)

    def _target(self, job: Job) -> Path:
        return target_of(job, self.outputs, self.packing, self.layers)

    def _member(self, picture: Picture, files: DrawingFiles) -> Member:
        return Member(picture, as_hints(files.hints, picture.shape), _mask(files, picture.shape))


def target_of(job: Job, outputs: Outputs, packing: Packing, layers: bool = False) -> Path:
    """Return where the map of a job goes; of several that do not go into one file, where the first goes.

    Raises:
        InputError: if it is a broken animation, has no layers that are asked for, or would be written over.
    """
    if layers:
        return layered_target(job, outputs)
    kind = None if packing.given else moving_kind(job.files.drawing, job.files.content)
    if kind is None:
        return job.target
    if not _moves(outputs):
        return job.numbered(1, outputs.ending).target
    target = job.target if job.exact else job.target.with_suffix(f".{kind}")
    if target.resolve() == job.files.drawing.resolve():
        raise InputError(f"{target} is read and would be written over; give another folder (-o) or --suffix.")
    return target


def written_for(job: Job, outputs: Outputs, packing: Packing, layers: bool = False) -> Iterator[Path]:
    """Yield what is written for a job; of several frames the map and what belongs to the first."""
    try:
        target = target_of(job, outputs, packing, layers)
        moves = not packing.given and moving_kind(job.files.drawing, job.files.content) is not None
    except InputError:  # it is told when it is painted, and nothing is written then
        return
    yield target
    if not layers:
        first = job.numbered(1, outputs.ending) if moves else job
        yield from (first.beside(ending) for ending in outputs.others())


def _moves(outputs: Outputs) -> bool:
    """Return whether the maps of an animation go into one: it has 8 bits."""
    return outputs.format == "png" and outputs.bits == 8


def _several(mask: BoolMask) -> str:
    """Return what is to be said of a picture whose objects (H, W) look like a sheet; empty if they do not."""
    shape = mask.shape[0], mask.shape[1]
    small = mask if max(shape) <= _LOOKED else resize(mask.astype(np.float32), fitted(shape, _LOOKED)) > 0.5
    areas = cv2.connectedComponentsWithStats(small.astype(np.uint8))[2][1:, cv2.CC_STAT_AREA]
    alike = int((areas > _ALIKE * areas.max(initial=0)).sum())
    if alike < _SHEET:
        return ""
    return (
        f"it holds {alike} separate objects, painted as one; --split auto or --sheet paints each for itself"
    )


def _noted(preds: NormalMap, note: str) -> NormalMap:
    """Return a map that also says what is to be said of its drawing's file."""
    return replace(preds, warning="; ".join(filter(None, [note, preds.warning])))


def _mask(files: DrawingFiles, shape: tuple[int, int]) -> BoolMask | str | None:
    """Return a drawing's mask (H, W), or how it is to be found."""
    if not isinstance(files.mask, Path):
        return files.mask
    return resize(load_mask(files.mask, shape).astype(np.float32), shape) > 0.5
