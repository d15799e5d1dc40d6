"""JobPredictor: predict the drawings of a file of any kind and write their outputs."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from normalgan.decoding import Decoded
from normalgan.decoding.decoders.svg import is_svg
from normalgan.errors import InputError
from normalgan.inference.composites.animation import KINDS, PAGES, encode_animation
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.figures import figures_of
from normalgan.inference.composites.layered_job import LayeredJob, files_of_layers, layered_target
from normalgan.inference.composites.packing import OWN, Packing
from normalgan.inference.composites.series import Member, flat_map, left_flat, predict_series, prepare_member
from normalgan.inference.composites.sheets import drawings_in, predict_sheet
from normalgan.inference.composites.tile_grid import TileGrid
from normalgan.inference.composites.tilesets import predict_tileset
from normalgan.inference.drawing import Drawing
from normalgan.inference.findings import Finding, LackingError
from normalgan.inference.inputs import as_hints
from normalgan.inference.jobs.plan import DrawingFiles, Job, overwritten
from normalgan.inference.jobs.writing import Done, Writer
from normalgan.inference.mask.mask_files import OUTLINE, READER, load_mask
from normalgan.inference.network.tile import Tile
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.explanation import write_explanation
from normalgan.inference.outputs.output_set import Outputs
from normalgan.inference.pipeline import predict
from normalgan.inference.predictor import Predictor
from normalgan.inference.preparation import Prepared, hinted
from normalgan.inference.reading.drawings import SVG_SIDE, read_pixels
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import Picture, fitted, read_picture, resize, to_picture, to_pixels
from normalgan.inference.reading.svg_size import svg_size
from normalgan.inference.sprites import Sprite

Framing = Literal["own", "shared"]
_MOST_TOGETHER = 2**26
"""Maximum total number of pixels of drawings that share a frame, because all are held in memory."""


@dataclass(frozen=True)
class Destinations:
    """The files that a command writes for its drawings.

    Args:
        outputs: the files that are written for each drawing.
        packing: layout of the drawings in a sheet.
        layers: whether each visible layer of a layered file is predicted separately.
        mixed: whether, with ``layers``, a drawing without layers is predicted as it is; otherwise it is an
            error.
    """

    outputs: Outputs
    packing: Packing
    layers: bool
    mixed: bool

    def by_layers(self, job: Job) -> bool:
        """Return whether a job's layers are predicted separately."""
        return self.layers and (not self.mixed or _drawing_of(job).layered is not None)

    def target(self, job: Job) -> Path:
        """Return the path of a job's map, or of the first map if there are several.

        Raises:
            InputError: if the file is a broken animation, lacks the requested layers, or would be
                overwritten.
        """
        if self.by_layers(job):
            return layered_target(job, _drawing_of(job), self.outputs)
        return job.target if self.packing.given else _moving_target(job, _drawing_of(job), self.outputs)

    def written(self, job: Job) -> list[Path]:
        """Return the output files of a job; none if it cannot be predicted.

        For an animation, these are the map and the other outputs of the first frame.
        """
        drawing = _drawing_of(job)
        try:
            target = self.target(job)
            if self.by_layers(job):
                return [*dict.fromkeys([target, *files_of_layers(job, drawing, self.outputs)])]
            moves = not self.packing.given and drawing.moving is not None
        except InputError:  # raised again by the prediction
            return []
        first = job.numbered(1, self.outputs.ending) if moves else job
        return [target, *(first.path_with(ending) for ending in self.outputs.other_endings)]


@dataclass(frozen=True)
class JobPredictor:
    """Predicts the drawings of a job and writes its outputs. Several threads may call it.

    Args:
        predictor: the network.
        destinations: the files of each job, and how a file is divided into drawings.
        writer: writes the outputs.
        size: longer side of the maps in pixels; None keeps the drawings' size.
        frame: ``shared`` if all drawings of a file are framed by one square, ``own`` if each has a frame of
            its own; None uses ``shared`` for animations and ``own`` otherwise.
        strength: factor applied to the slopes of all maps.
        tile: directions in which each drawing repeats; None if it does not.
        single: whether a page is predicted as one object instead of separate figures.
        holes: x and y of points whose regions are flipped, in pixels of the drawing or of the sheet; see
            `prepare`.
        explain: folder for pictures of how each mask was found; None writes none.
        sprite: adapts each map to a sprite.
    """

    predictor: Predictor
    destinations: Destinations
    writer: Writer
    size: int | None = None
    frame: Framing | None = None
    strength: float = 1.0
    tile: Tile | None = None
    single: bool = False
    holes: Sequence[tuple[float, float]] = ()
    explain: Path | None = None
    sprite: Sprite = field(default_factory=Sprite)

    def __call__(self, job: Job) -> Done:
        """Predict the drawings of a job and write the outputs.

        Raises:
            InputError: if the drawing cannot be used.
            OSError: if a file cannot be written.
        """
        own = replace(
            self, writer=self.writer.apart()
        )  # a job that fails leaves no files to be written later
        done = own._done(job)
        self.writer.held.extend(own.writer.held)
        return done

    def _done(self, job: Job) -> Done:
        files, drawing = job.files, _drawing_of(job)
        if self.destinations.by_layers(job):
            shared = self.frame != "own"
            layered = LayeredJob(self.predictor, self.writer, self.size, shared, self.strength, self.sprite)
            return layered(job, drawing, layered_target(job, drawing, self.writer.outputs))
        if self.destinations.packing.tileset == OWN:
            return self._written(job, self._tileset(files, *drawing.tileset))
        flat = ["it has no layers and is predicted as it is"] if self.destinations.layers else []
        # A multi-page file counts as moving, because its pages are decoded and predicted like frames.
        if drawing.moving is not None:
            self._check_moving(drawing)
            return replace(self._animation(job, drawing), note="; ".join(flat))
        if job.exact and job.target.suffix.lower() in {".gif", ".webp"}:
            raise InputError(f"{job.target} would be an animation, but {files.drawing} is a still image.")
        if self.destinations.packing.given:
            return self._written(job, self._sheet(files, drawing))
        preds = self._drawing(job, drawing)
        figures = len(preds.cells)
        note = f"it shows {figures} separate figures, each predicted separately; --single predicts one object"
        return replace(self._written(job, preds), note="; ".join([*flat, *([note] if figures else [])]))

    def together(self, jobs: Sequence[Job]) -> Iterator[tuple[Job, Done | Exception]]:
        """Yield each job with its result, in order, for drawings in separate files that share a frame.

        Raises:
            InputError: if the drawings differ in size or have too many pixels in total.
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
            if pixels > _MOST_TOGETHER:
                raise InputError(
                    f"the drawings that share a frame have more than {_MOST_TOGETHER} pixels together; "
                    "name fewer, or omit --frame shared."
                )
            members.append(member)
            kept.append(job)
        predicted = predict_series(self.predictor, members, True, True, self.size)
        # They share one scale, as the frames of an animation do.
        own = replace(self, writer=self.writer.apart())
        for job, member, preds in zip(kept, members, predicted, strict=True):
            if isinstance(preds, InputError):
                yield job, preds
                continue
            try:
                done = own._written(job, self._adapted(preds, member.picture), hold=True)
            except OSError as error:
                yield job, error
                continue
            yield job, done
        own.writer.write_held()

    def _written(self, job: Job, preds: NormalMap, hold: bool = False) -> Done:
        self.writer.write(job, preds.stronger(self.strength), hold)
        return Done([job.target], preds.warning, partial=preds.partial)

    def _check_moving(self, drawing: Drawing) -> None:
        """Raise `InputError` if an option is set that only works for a single still picture."""
        if self.destinations.packing.given:
            why = "a sheet is a still picture"
        elif self.tile is not None:
            why = "--tile repeats a still picture"
        elif self.holes or self.explain is not None:
            why = f"{'--hole' if self.holes else '--explain'} is for a single picture"
        else:
            return
        several = "has several pages" if drawing.moving == PAGES else "is an animation"
        raise InputError(f"{drawing.path} {several}; {why}.")

    def _adapted(self, preds: NormalMap, picture: Picture) -> NormalMap:
        """Return a map adapted to a sprite, with the warning about the drawing's file added."""
        return _noted(self.sprite(preds, picture), picture)

    def _drawing(self, job: Job, drawing: Drawing) -> NormalMap:
        files = job.files
        picture = drawing.picture(self.size)
        if self.tile is not None:
            tiled = self.predictor(picture, files.hints, files.mask, self.size, self.tile)
            return self._adapted(tiled, picture)
        member = replace(self._member(picture, files), holes=self.holes)
        try:
            prepared = self._prepared(member, self.size)
        except LackingError as error:
            if error.finding.code != "no_lines":
                raise
            # The reader takes a surface for background.
            raise InputError(f"{error} For a wall or another surface, add --tile both.") from None
        split = not self.single and files.mask in {None, READER, OUTLINE}
        # Lines do not tell which of them belong to one figure, so the reader does.
        by_lines = split and files.mask == OUTLINE
        page = self._prepared(replace(member, mask=READER, holes=()), self.size) if by_lines else prepared
        cells = figures_of(page, drawing.pixels if self.size is None else None) if split else []
        if cells:
            preds = self._page(job, drawing, replace(member, reading=page.reading), cells)
        else:
            preds = predict(self.predictor.backend, prepared, self.predictor.upsample)
        if self.explain is not None:
            write_explanation(self.explain / files.below, job.stem, picture, prepared, preds)
        return self._adapted(preds, picture)

    def _prepared(self, member: Member, size: int | None = None) -> Prepared:
        return hinted(prepare_member(self.predictor, member, size), member.hints, member.picture.shape)

    def _page(self, job: Job, drawing: Drawing, page: Member, cells: Sequence[Cell]) -> NormalMap:
        """Return the map of a page whose figures are predicted separately."""
        sheet, width = drawing.pixels(), page.picture.shape[1]
        if self.size is not None:
            sheet = to_pixels(page.picture.resized(fitted(page.picture.shape, self.size)))
            scale, hints = sheet.shape[1] / width, page.hints
            if hints is not None:
                hints = Hints(hints.points * np.float32(scale), hints.normals)
            page = replace(page, hints=hints, holes=[(x * scale, y * scale) for x, y in page.holes])
        if self.explain is not None:
            self._explain_figures(job, drawings_in(sheet, cells, page))
        return predict_sheet(self.predictor, sheet, cells, page, scale=sheet.shape[1] / width)

    def _explain_figures(self, job: Job, figures: Sequence[tuple[Cell, Member]]) -> None:
        """Write the explanation of the mask of each figure of a page."""
        assert self.explain is not None
        for number, (_, member) in enumerate(figures, 1):
            prepared = self._prepared(member)
            preds = predict(self.predictor.backend, prepared, self.predictor.upsample)
            stem = f"{job.stem}_figure_{number}"
            write_explanation(self.explain / job.files.below, stem, member.picture, prepared, preds)

    def _sheet(self, files: DrawingFiles, drawing: Drawing) -> NormalMap:
        content = drawing.content
        drawn_at_any_size = is_svg(content)
        if self.size is not None and (not drawn_at_any_size or self.destinations.packing.tileset is not None):
            raise InputError("a sheet of pixels keeps its layout, and therefore its size; omit --size.")
        units = svg_size(content) if drawn_at_any_size else None
        # The tile size is in the SVG's own units.
        side = SVG_SIDE if units is None or self.destinations.packing.tileset is None else round(max(units))
        sheet = read_pixels(files.drawing, content, self.size or side)
        if self.destinations.packing.tileset is not None:
            return self._tileset(files, sheet)
        page = replace(self._whole(sheet, files), holes=self.holes)
        found = self.destinations.packing.cells(sheet, files.drawing, files.below, units)
        shared = self.frame == "shared"
        preds = predict_sheet(self.predictor, sheet, found.cells, page, shared, found.warnings)
        return self._adapted(preds, page.picture)

    def _tileset(self, files: DrawingFiles, sheet: Decoded, own: tuple[int, int] | None = None) -> NormalMap:
        """Return the map of a tileset; ``own`` is the tile size if the drawing's file stores it."""
        grid = (
            self.destinations.packing.tile_grid(files.drawing, files.below) if own is None else TileGrid(*own)
        )
        page = self._whole(sheet, files)
        preds = predict_tileset(self.predictor, sheet, grid, files.drawing, page, self.sprite)
        return _noted(preds, page.picture)

    def _animation(self, job: Job, drawing: Drawing) -> Done:
        """Predict the frames of an animation or the pages of a file, and write their outputs."""
        outputs, target = self.writer.outputs, _moving_target(job, drawing, self.writer.outputs)
        found, pages = drawing.frames, drawing.moving == PAGES
        members = [self._member(to_picture(each), job.files) for each in found.frames]
        shared = self.frame == "shared" if pages else self.frame != "own"
        predicted = predict_series(self.predictor, members, shared, shared and not pages, self.size)
        problems = _Problems("page" if pages else "frame")
        moves = outputs.normal.plain and not pages
        pixels: list[NDArray[np.uint8]] = []
        maps: list[Path] = []
        for number, preds in enumerate(self._maps(members, predicted, problems), 1):
            own = job.numbered(number, outputs.ending)
            # All frames share one scale; otherwise a body would rise and sink when an arm is raised.
            self.writer.write_others(own, preds, hold=not pages)
            if moves:
                pixels.append(preds.pixels(outputs.normal.y, outputs.normal.alpha))
            else:
                self.writer.write_map(own, preds)
                maps.append(own.target)
        if len(problems.errors) == len(members):
            raise problems.errors[0]
        if not outputs.whole_batch:
            self.writer.write_held()
        if moves:
            maps = [target]
            kind = KINDS.get(target.suffix.lower(), "png")
            moving = encode_animation(kind, pixels, found.durations, found.loop)
            self.writer.sink(target, moving)
        warning = "; ".join(filter(None, [found.notes.text, problems.summary(len(members))]))
        # Blank frames are deliberate and do not count as missing.
        partial = found.notes.partial or not all(map(_blank, problems.failed))
        return Done(maps, warning, partial=partial)

    def _maps(
        self, members: Sequence[Member], predicted: Iterable[NormalMap | InputError], problems: "_Problems"
    ) -> Iterator[NormalMap]:
        """Yield the map of each frame or page, flat if it could not be predicted, and record the problems."""
        for number, (member, each) in enumerate(zip(members, predicted, strict=True), 1):
            if isinstance(each, InputError):
                problems.fail(number, each, member.picture)
                preds = flat_map(member.picture.shape, self.size)
            else:
                problems.warn(number, each.warning)
                preds = self.sprite(each, member.picture)
            yield preds.stronger(self.strength)

    def _member(self, picture: Picture, files: DrawingFiles) -> Member:
        mask = load_mask(files.mask, picture.shape) if isinstance(files.mask, Path) else files.mask
        hints = as_hints(files.hints, picture.shape)
        return Member(picture, hints, mask, pixel_art=self.sprite.pixel_art)

    def _whole(self, sheet: Decoded, files: DrawingFiles) -> Member:
        """Return a sheet as one drawing, with a mask at the sheet's own size."""
        page = self._member(to_picture(sheet), files)
        if not isinstance(page.mask, np.ndarray):
            return page
        return replace(page, mask=resize(page.mask.astype(np.float32), sheet.shape) > 0.5)


@dataclass
class _Problems:
    """Warnings and errors of an animation's frames or a file's pages.

    Args:
        part: name of a single item, ``frame`` or ``page``.
        errors: why frames could not be predicted.
        failed: pictures of these frames.
        said: failures, then other warnings, as parts of a sentence.
    """

    part: str
    errors: list[InputError] = field(default_factory=list)
    failed: list[Picture] = field(default_factory=list)
    said: list[str] = field(default_factory=list)

    def fail(self, number: int, error: InputError, picture: Picture) -> None:
        """Record that a frame could not be predicted."""
        # Failures are listed before other warnings.
        self.said.insert(len(self.errors), f"{self.part} {number}: {left_flat(error)}")
        self.errors.append(error)
        self.failed.append(picture)

    def warn(self, number: int, warning: str) -> None:
        """Record a frame's warning; an empty one is ignored."""
        if warning:
            self.said.append(f"{self.part} {number}: {warning}")

    def summary(self, count: int) -> str:
        """Return the first problem and the number of problems among ``count`` frames; empty if none."""
        if not self.said:
            return ""
        more = f"; and so on, in {len(self.said)} of its {count} {self.part}s" if len(self.said) > 1 else ""
        return self.said[0] + more


def _drawing_of(job: Job) -> Drawing:
    return Drawing(job.files.drawing, job.files.content)


def _moving_target(job: Job, drawing: Drawing, outputs: Outputs) -> Path:
    """Return the path of an animation's map, of the first of several maps, or of a still picture's map.

    Raises:
        InputError: if the file is a broken animation or would be overwritten, or if one file is named for
            several maps.
    """
    kind = drawing.moving
    if kind is None:
        return job.target
    if kind == PAGES or not outputs.normal.plain:
        if job.exact:
            raise InputError(
                f"{job.target} holds one map, but {job.files.drawing} has several pictures; "
                "give a folder (-o)."
            )
        return job.numbered(1, outputs.ending).target
    target = job.target if job.exact else job.target.with_suffix(f".{kind}")
    if target.resolve() == job.files.drawing.resolve():
        raise overwritten(target)
    return target


def _noted(preds: NormalMap, picture: Picture) -> NormalMap:
    """Return a map with the warning about the drawing's file added."""
    notes = picture.notes
    noted = (Finding("note", words=notes.text),) if notes.text else ()
    return replace(preds, findings=noted + preds.findings, partial=preds.partial or notes.partial)


def _blank(picture: Picture) -> bool:
    """Return whether a picture is blank."""
    if picture.alpha is not None:
        return not picture.alpha.any()
    return bool((picture.colour == picture.colour[:1, :1]).all())
