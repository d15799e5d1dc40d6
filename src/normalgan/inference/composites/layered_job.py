"""Layered job: predict each visible layer of a file and write the results."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from normalgan.decoding import DecodedLayer, DecodedLayers
from normalgan.errors import InputError
from normalgan.inference.composites.layer_context import Context, context_of, surest, ways_to_see
from normalgan.inference.composites.layers import cut, encode_layers, is_plain, picture_of
from normalgan.inference.composites.series import Member, predict_series, prepare_member
from normalgan.inference.drawing import Drawing
from normalgan.inference.jobs.plan import Job, overwritten
from normalgan.inference.jobs.writing import Done, Writer
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.output_set import Outputs
from normalgan.inference.parallel import result_of, stream
from normalgan.inference.pipeline import finish
from normalgan.inference.predictor import Predictor
from normalgan.inference.preparation import Prepared
from normalgan.inference.reading.picture import fitted
from normalgan.inference.sprites import Sprite

_LONGEST = 48
"""Maximum length of a layer's name within a file name."""


@dataclass(frozen=True)
class LayeredJob:
    """Predicts the layers of one file.

    Args:
        predictor: the network.
        writer: writes their maps.
        size: longer side of the maps in pixels; None keeps the drawing's size.
        shared: whether all frames of an animated layer are framed by one square and smoothed over time.
        strength: factor applied to the slopes of all maps.
        sprite: adapts each map to a sprite.
    """

    predictor: Predictor
    writer: Writer
    size: int | None
    shared: bool
    strength: float
    sprite: Sprite

    def __call__(self, job: Job, drawing: Drawing, target: Path) -> Done:
        """Predict and write the layers.

        Args:
            job: the job of the layered file.
            drawing: content of the file.
            target: path from `layered_target`.

        Raises:
            InputError: if the file has no layers, or no layer can be predicted.
            OSError: if a file cannot be written.
        """
        if job.files.hints is not None or isinstance(job.files.mask, Path):
            raise InputError(
                f"{drawing.path} is predicted layer by layer; a mask or hints belong to one drawing."
            )
        found = drawing.layers
        drawn = [layer for layer in found.layers if not is_plain(layer, found.shape)]
        numbers = sorted({layer.number for layer in drawn})
        predicted: list[DecodedLayer] = []
        said = [found.notes.text] if found.notes.text else []
        failed: list[InputError] = []
        written: list[Path] = []
        context = self._context(job, found, drawn)
        for number, got in stream(numbers, lambda number: self._predict(job, found, number, context)):
            name = next(layer.name for layer in drawn if layer.number == number)
            if isinstance(got, InputError):
                failed.append(got)
                said.append(f"layer {name!r}: it is left out, because {str(got).rstrip('.')}")
                continue
            layers, warning, maps = result_of(got)
            predicted += layers
            said += [f"layer {name!r}: {warning}"] if warning else []
            written += maps
        if len(failed) == len(numbers):
            raise failed[0] if failed else InputError("none of its layers holds a drawing.")
        if drawing.layered is not None and self.writer.outputs.normal.plain:
            shape = fitted(found.shape, self.size)
            predicted.sort(key=lambda layer: (layer.frame, layer.number))
            self.writer.sink(target, encode_layers(drawing.layered, shape, predicted, found.durations))
            written = [target]
        return Done(written, "; ".join(said), partial=found.notes.partial or bool(failed))

    def _context(self, job: Job, found: DecodedLayers, drawn: list[DecodedLayer]) -> Context | None:
        """Return the context of all layers; None for a single layer and for animations."""
        if len(found.durations) > 1:
            return None

        def prepared(layer: DecodedLayer) -> Prepared:
            return prepare_member(self.predictor, self._member(job, layer, found.shape), self.size)

        # Layers are prepared again for prediction: keeping all layers of a large file would fill the memory.
        parts = (each for _, each in stream(drawn, prepared) if isinstance(each, Prepared))
        first, second = next(parts, None), next(parts, None)
        return None if first is None or second is None else context_of(chain((first, second), parts))

    def _predict(
        self, job: Job, found: DecodedLayers, number: int, context: Context | None
    ) -> tuple[list[DecodedLayer], str, list[Path]]:
        """Return a layer's predictions frame by frame, the warning and the written maps."""
        outputs = self.writer.outputs
        own = [layer for layer in found.layers if layer.number == number]
        members = [self._member(job, layer, found.shape) for layer in own]
        several = self.shared and len(own) > 1
        predicted: list[DecodedLayer] = []
        said: list[str] = []
        failed: list[InputError] = []
        written: list[Path] = []
        series: Iterable[NormalMap | InputError]
        if context is None:
            series = predict_series(self.predictor, members, several, several, self.size)
        else:
            series = [self._among(member, context) for member in members]
        for layer, member, preds in zip(own, members, series, strict=True):
            if not isinstance(preds, NormalMap):
                failed.append(preds)
                continue
            said += [preds.warning] if preds.warning else []
            stronger = self.sprite(preds, member.picture).stronger(self.strength)
            each = _job_of(job, layer, outputs.ending, len(found.durations))
            self.writer.write_others(each, stronger)
            if not outputs.normal.plain:
                self.writer.write_map(each, stronger)
                written.append(each.target)
                continue
            inside = cut(layer, stronger.pixels(outputs.normal.y, alpha=True))
            predicted += [] if inside is None else [inside]
        if len(failed) == len(own):
            raise failed[0]
        return predicted, said[0] if said else "", written

    def _member(self, job: Job, layer: DecodedLayer, shape: tuple[int, int]) -> Member:
        where = job.files.mask if isinstance(job.files.mask, str) else None
        return Member(picture_of(layer, shape), None, where, pixel_art=self.sprite.pixel_art)

    def _among(self, member: Member, context: Context) -> NormalMap | InputError:
        """Return the map of a layer predicted alone or among the others, or the error."""
        backend = self.predictor.backend
        try:
            ways = ways_to_see(prepare_member(self.predictor, member, self.size), context)
            seen, preds, confidence = surest(ways, lambda way: backend.predict(way.model_input, way.hints))
            return finish(seen, preds, confidence, self.predictor.upsample)
        except InputError as error:
            return error


def layered_target(job: Job, drawing: Drawing, outputs: Outputs) -> Path:
    """Return the path of the layered file, or of the first layer's file if each layer is written separately.

    Raises:
        InputError: if the file has no layers, or the user named a single output file.
    """
    if job.exact:
        raise InputError(f"{job.target} holds one map; --layers needs a folder (-o).")
    if not outputs.normal.plain:
        found = drawing.layers
        first = next((each for each in found.layers if not is_plain(each, found.shape)), found.layers[0])
        return _job_of(job, first, outputs.ending, len(found.durations)).target
    if drawing.layered is None:
        drawing.layers  # noqa: B018 -- raises the error: the file has no layers, or is missing
    target = job.target.with_suffix(f".{drawing.layered}")
    if target.resolve() == drawing.path.resolve():
        raise overwritten(target)
    return target


def files_of_layers(job: Job, drawing: Drawing, outputs: Outputs) -> Iterator[Path]:
    """Yield the output files of all layers and frames, besides a layered file.

    Raises:
        InputError: if the file has no layers.
    """
    if outputs.normal.plain and not outputs.other_endings:
        return  # decoding the layers of a large file takes seconds
    found = drawing.layers
    for layer in found.layers:
        if not is_plain(layer, found.shape):
            own = _job_of(job, layer, outputs.ending, len(found.durations))
            if not outputs.normal.plain:
                yield own.target
            yield from (own.path_with(ending) for ending in outputs.other_endings)


def _job_of(job: Job, layer: DecodedLayer, ending: str, frames: int) -> Job:
    """Return the job of one layer; its file name has the layer's number, groups, name and frame."""
    name = re.sub(r"[^\w-]+", "-", "_".join((*layer.groups, layer.name))).strip("-_")[:_LONGEST]
    stem = f"{job.stem}_{layer.number + 1:02d}{'_' if name else ''}{name}"
    stem += f"_{layer.frame + 1:04d}" if frames > 1 else ""
    return Job(job.files, job.target.with_name(stem + ending), stem)
