"""Submissions: measure another program's normal maps of the test views.

A submission is a folder with ``submission.json``, ``{"name": "…"}``, and normal maps: ``0/horse/3.png`` is
the prediction for view 3 of the mesh horse without hints, ``15/horse/3.png`` the prediction with the
benchmark's 15 hints. The colours of a map give the direction at each pixel, and its opacity marks the object.
In an opaque map, pixels with a vector longer than 1/2 belong to the object, as for our methods.
"""

import json
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.hints import hint_order
from normalgan.benchmark.methods import Method
from normalgan.errors import InputError
from normalgan.files.json_files import read_json
from normalgan.files.writing import write_bytes
from normalgan.hints import NoHints, UniformHints
from normalgan.inference.reading.drawings import read_pixels, to_unit
from normalgan.normals import encode_grey

_SUBMISSION = "submission.json"
_SILENT = 0.05
"""Minimum length of a vector; shorter vectors are background grey, in 8 or 16 bits."""
_OBJECT = 0.5
"""Minimum length of a vector on the object."""
_CHANNELS = ("red", "green", "blue")
_THERE, _ABSENT = 1.0, 0.25
"""Vector lengths assigned to pixels that a submission marks as object and as background."""


@dataclass(frozen=True)
class Submission:
    """Another program's predictions.

    Args:
        folder: folder of the submission.
        name: name in tables.
        counts: numbers of hints for which there are maps, including 0.
    """

    folder: Path
    name: str
    counts: tuple[int, ...]

    def method(self) -> Method:
        """Return the maps as a method, which reads the maps that match the number of given hints."""
        warned = False

        def predict(batch: Batch, hints: Tensor | None) -> Tensor:
            given = [0] * len(batch["name"]) if hints is None else hints[:, 3].sum((1, 2)).int().tolist()
            size = batch["normal"].shape[2]
            # A small object may have fewer hints than requested.
            folders = [min(count for count in self.counts if count >= number) for number in given]
            named = zip(folders, batch["name"], strict=True)
            maps = torch.stack([self._read(*one, size) for one in named])
            _check_axes(self.folder, maps, batch)
            nonlocal warned
            if not warned and (maps.square().sum(1) > _OBJECT**2).all():
                warned = True
                warnings.warn(
                    f"the maps in {self.folder} mark all pixels as object; the background needs the opacity "
                    "0, or the colour (128, 128, 128).",
                    stacklevel=2,
                )
            return maps.to(batch["normal"])

        # A submission with hinted maps uses hints, but has no sampler of its own.
        return Method(predict, UniformHints(0, 0) if max(self.counts) else NoHints(), timed=False)

    def _read(self, count: int, name: str, size: int) -> Tensor:
        path = self.folder / str(count) / f"{name}.png"
        if not path.is_file() and (others := sorted(path.parent.glob(f"{path.stem}.*"))):
            raise InputError(f"there is no file {path}, but {others[0].name}; a submission has PNG files.")
        pixels = to_unit(read_pixels(path).pixels)
        if pixels.shape[:2] != (size, size) or pixels.ndim != 3 or pixels.shape[2] < 3:
            raise InputError(
                f"{path} has the shape {pixels.shape}; a normal map of this benchmark has {size} × {size} "
                "pixels in colour."
            )
        normals: NDArray[np.floating] = 2 * pixels[..., :3] - 1
        length = np.linalg.norm(normals, axis=-1, keepdims=True)
        if pixels.shape[2] == 4:
            present = pixels[..., 3:] > 0.5
            normals = normals / np.maximum(length, _SILENT) * np.where(present, _THERE, _ABSENT)
        # 8-bit grey has no exact centre: 128 is a short vector, whose direction would count as a prediction.
        normals[length[..., 0] < _SILENT] = 0
        return torch.from_numpy(np.ascontiguousarray(normals)).permute(2, 0, 1)


def _check_axes(folder: Path, maps: Tensor, batch: Batch) -> None:
    """Raise `InputError` if the truth shows that channels are flipped, or that two are exchanged.

    Args:
        folder: folder of the submission.
        maps: (N, 3, H, W).
        batch: batch with the true normals.
    """
    on = (batch["mask"][:, 0].cpu() > 0.5) & (maps.square().sum(1) > 0)
    if on.sum() < 2:
        return
    axes = [*maps.unbind(1), *batch["normal"].cpu().unbind(1)]
    found = torch.corrcoef(torch.stack([axis[on].double() for axis in axes]))[:3, 3:].tolist()
    own = [found[axis][axis] for axis in range(3)]
    # An untrained network has a correlation within 0.05 of zero, and one with the error of a constant normal
    # has 0.4.
    for flipped, other, advice in ((1, 0, "green up, as in OpenGL"), (0, 1, "red to the right")):
        if own[other] > 0.2 and own[flipped] < -0.2:
            raise InputError(
                f"the maps in {folder} seem to have a flipped {_CHANNELS[flipped]} channel: {'xy'[other]} "
                f"agrees with the true normals (correlation {own[other]:.2f}) and {'xy'[flipped]} "
                f"contradicts them ({own[flipped]:.2f}); write {advice}."
            )
    if max(own[:2]) < -0.2:
        raise InputError(
            f"the maps in {folder} seem to have flipped red and green channels: x and y contradict the true "
            f"normals (correlations {own[0]:.2f} and {own[1]:.2f}), as if the object were hollow; write red "
            "to the right and green up."
        )
    for one, other in combinations(range(3), 2):
        crossed = min(found[one][other], found[other][one])
        clear = crossed > 0.1 and max(found[one][other], found[other][one]) > 0.2  # z varies little
        if clear and crossed > 2 * max(own[one], own[other]):
            raise InputError(
                f"the maps in {folder} seem to have {_CHANNELS[one]} and {_CHANNELS[other]} exchanged: each "
                f"agrees with the true normals of the other ({crossed:.2f} or more, against "
                f"{max(own[one], own[other]):.2f} or less with its own); write the channels in the order "
                "red, green, blue."
            )
    if (z := float(maps[:, 2][on].mean())) < -0.2:
        raise InputError(
            f"the maps in {folder} point away from the viewer: z is {z:.2f} on average on the object; write "
            "blue so that above 128 it points to the viewer."
        )


def read_submission(folder: Path) -> Submission:
    """Return the submission in a folder.

    Raises:
        InputError: if the folder has no readable ``submission.json`` with a name, or no maps without hints.
    """
    path, like = folder / _SUBMISSION, 'it must be like {"name": "theirs"}.'
    content = read_json(path, like=like)
    name = content.get("name") if isinstance(content, dict) else None
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"{path} has no name; {like}")
    counts = sorted(int(one.name) for one in folder.iterdir() if one.is_dir() and one.name.isdecimal())
    if 0 not in counts:
        raise InputError(f"{folder} has no folder 0 with the maps predicted without hints.")
    return Submission(folder, name, tuple(counts))


def write_inputs(folder: Path, batch: Batch, counts: Sequence[int], seed: int) -> None:
    """Write the sketches and hints that another program needs to predict a batch.

    ``sketches/horse/3.png`` is black ink on white. ``hints/horse/3.json`` lists the points in order, each
    with ``x``, ``y`` (whole pixels from the left and the top) and ``normal``; n hints are the first n points.
    """
    most = max(counts, default=0)
    for i, name in enumerate(batch["name"]):
        ink = batch["sketch"][i, 0].numpy()
        write_bytes(folder / "sketches" / f"{name}.png", encode_grey(1 - ink))
        width = ink.shape[1]
        points = []
        for place in hint_order(batch["mask"][i], name, seed, most).tolist():
            row, column = divmod(place, width)
            normal = [round(float(v), 6) for v in batch["normal"][i, :, row, column]]
            points.append({"x": column, "y": row, "normal": normal})
        write_bytes(folder / "hints" / f"{name}.json", (json.dumps(points) + "\n").encode())
