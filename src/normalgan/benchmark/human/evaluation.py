"""Evaluate drawings by people: predict them like `generate`, and compare with the true normals."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.accumulator import Accumulator, Figure, mesh_of
from normalgan.benchmark.hints import hint_points
from normalgan.benchmark.human.drawings import HumanDrawing
from normalgan.benchmark.human.registration import camera_of, read_placed_mesh
from normalgan.benchmark.measure import Measured
from normalgan.callbacks.gallery import Row, batch_row
from normalgan.data.sources.pair_files import PairFiles
from normalgan.errors import InputError
from normalgan.hints import hints_at
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.drawings import read_drawing
from normalgan.inference.regions import Bounds, box_of
from normalgan.metrics import angular_error, without_hints
from normalgan.rendering.renderers.embree import EmbreeRenderer

COUNTS = (0, 15)
"""Numbers of hints with which every drawing is predicted, as in the benchmark's table 1."""
_VISIBLE = 0.05
"""Minimum ink of a line."""
_LARGEST_SIDE = 4096
"""Maximum side of a drawing in pixels; a larger one would take minutes to predict."""
_APART = 0.1
"""Minimum overlap of the boxes of the lines and the object; less means a wrong sheet size or camera."""
_CPU = torch.device("cpu")
_placed = lru_cache(maxsize=4)(read_placed_mesh)  # drawings of the same mesh are consecutive


@dataclass
class Measurement:
    """The figures of a folder of drawings.

    Args:
        groups: figures of each group, in the form of a benchmark method's figures.
        drawings: name, group, object, size and figures of each drawing.
        left_out: a message for each drawing that could not be measured.
        shown: rows of the gallery, without hints and with the largest number of hints.
    """

    groups: dict[str, dict[str, Any]] = field(default_factory=dict)
    drawings: list[dict[str, Any]] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    shown: list[tuple[Row, Row]] = field(default_factory=list)


def sample_of(drawing: HumanDrawing) -> Batch:
    """Return a drawing with its true normals as a batch of one, padded to a square with paper.

    Raises:
        InputError: if a file or the camera is invalid, the mesh is outside the sheet, or the lines and the
            object are at different positions.
    """
    ink = read_drawing(drawing.drawing)
    side = max(ink.shape)
    if side > _LARGEST_SIDE:
        raise InputError(f"it is {side} pixels wide; the limit is {_LARGEST_SIDE}.")
    normal, mask = np.zeros((side, side, 3), np.float32), np.zeros((side, side), bool)
    if drawing.projection is None:
        pair = PairFiles(drawing.name, drawing.drawing, drawing.truth).load()
        within = tuple(slice(length) for length in pair.mask.shape)
        normal[within], mask[within] = pair.normal, pair.mask
    else:
        placed = _placed(drawing.truth)
        maps = EmbreeRenderer().render(placed.mesh, camera_of(drawing.projection, placed, side), side)
        normal, mask = maps.normal, maps.mask
    if not mask.any():
        raise InputError("its camera does not see the mesh.")
    ink = np.pad(ink, [(0, side - length) for length in ink.shape])
    shared = _shared(box_of(ink > _VISIBLE), box_of(mask))
    if shared < _APART:
        raise InputError(
            "the lines and the projected mesh are at different positions: their boxes overlap by "
            f"{shared:.0%}; is the camera for a sheet of {side} pixels?"
        )
    return {
        "sketch": torch.from_numpy(ink)[None, None],
        "normal": torch.from_numpy(np.ascontiguousarray(normal.transpose(2, 0, 1)))[None],
        "mask": torch.from_numpy(mask.astype(np.float32))[None, None],
        "name": [drawing.name],
    }


def _shared(one: Bounds, other: Bounds) -> float:
    """Return the intersection over union of two boxes."""
    height = max(min(one[1], other[1]) - max(one[0], other[0]), 0)
    width = max(min(one[3], other[3]) - max(one[2], other[2]), 0)
    areas = sum((bottom - top) * (right - left) for top, bottom, left, right in (one, other))
    return height * width / (areas - height * width)


def measure_drawings(
    drawings: Sequence[HumanDrawing],
    predictor: Predictor,
    seed: int,
    gallery: int,
    say: Callable[[str], None],
) -> Measurement:
    """Return the figures of all drawings that can be measured, and messages about the others.

    Hints are the true normals at uniform random points on the object; hinted pixels are not counted. A
    drawing in which no object is found counts as an empty prediction. ``gallery`` drawings are kept for the
    gallery.
    """
    found = Measurement()
    gathered: dict[str, dict[str, Accumulator]] = {}
    ordered = sorted(drawings, key=lambda one: (str(one.truth), one.name))
    every = max(len(ordered) // max(gallery, 1), 1)
    for number, drawing in enumerate(ordered):
        try:
            batch = sample_of(drawing)
        except InputError as error:
            found.left_out.append(f"{drawing.name} is left out: {error}")
            continue
        group = gathered.setdefault(drawing.group, {str(count): Accumulator(_CPU) for count in COUNTS})
        record: dict[str, Any] = {"name": drawing.name, "group": drawing.group}
        record |= {"object": mesh_of(drawing.name), "size": batch["mask"].shape[-1], "figures": {}}
        rows = []
        for count in COUNTS:
            predicted, hints, warning = _predict(predictor, batch, count, seed)
            group[str(count)].update(predicted, batch["normal"], batch["mask"], hints[:, 3:], batch["name"])
            record["figures"][str(count)] = _of_one(predicted, batch, hints[:, 3:])
            record["warning"] = warning
            rows.append(batch_row(batch, 0, hints, predicted[:, :3], of_pairs=True))
        found.drawings.append(record)
        if number % every == 0 and len(found.shown) < gallery:
            found.shown.append((rows[0], rows[-1]))
        if (number + 1) % 25 == 0:
            say(f"{number + 1} of {len(ordered)} drawings")
    found.groups = {group: asdict(Measured.of(by_count)) for group, by_count in sorted(gathered.items())}
    return found


def _predict(predictor: Predictor, batch: Batch, count: int, seed: int) -> tuple[Tensor, Tensor, str]:
    """Return the prediction (1, 3 or 4, S, S), zero off the object; the hints; and the findings."""
    where = hint_points(batch["mask"], batch["name"], seed, count)
    hints = hints_at(batch["normal"], where)
    given = np.ascontiguousarray(hints[0].permute(1, 2, 0).numpy()) if count else None
    try:
        seen = predictor(1 - batch["sketch"][0, 0].numpy(), given)
    except InputError as error:
        return torch.zeros_like(batch["normal"]), hints, str(error)
    channels = [seen.normal] if seen.confidence is None else [seen.normal, seen.confidence[..., None]]
    predicted = np.concatenate(channels, axis=-1).transpose(2, 0, 1)
    return torch.from_numpy(np.ascontiguousarray(predicted, np.float32))[None], hints, seen.warning


def _of_one(predicted: Tensor, batch: Batch, where: Tensor) -> Figure:
    """Return the error on the object, the error where both objects overlap, and the IoU of the prediction."""
    preds = predicted[:, :3]
    there, seen = batch["mask"] > 0.5, (preds != 0).any(1, keepdim=True)
    counted = without_hints(batch["mask"], where) > 0.5
    angle = angular_error(preds, batch["normal"])
    return {
        "angular_mean": _mean(angle[counted]),
        "angular_shared": _mean(angle[counted & seen]),
        "mask_iou": float((there & seen).sum() / (there | seen).sum()),
    }


def _mean(values: Tensor) -> float | None:
    return float(values.double().mean()) if values.numel() else None
