"""Explanation: write a picture of each stage in which the mask of a drawing was found."""

from pathlib import Path

import numpy as np

from normalgan.errors import writing
from normalgan.files.writing import write_bytes
from normalgan.inference.cleaning.reader import over_paper
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.preparation import Prepared
from normalgan.inference.reading.picture import Picture
from normalgan.normals import pack_png

STAGES = ("input", "ink", "regions", "presence", "mask")
"""The stages in order; file names contain the number of the stage."""


def write_explanation(
    folder: Path, stem: str, picture: Picture, prepared: Prepared, preds: NormalMap
) -> None:
    """Write `<stem>_<number>_<stage>.png` for each stage.

    The input is shown on white or black paper, as the reader sees it. If the mask was given or comes from the
    opacity, there are no regions and no presence.

    Args:
        folder: output folder; created if missing.
        stem: stem of the drawing's name.
        picture: the drawing.
        prepared: the prepared drawing.
        preds: map of the drawing, whose mask is the last stage.

    Raises:
        RunError: if a file cannot be written.
    """
    stages = {
        "input": np.rint(255 * over_paper(picture)).astype(np.uint8),
        "ink": np.rint(255 * (1 - prepared.ink)).astype(np.uint8),
        **({} if prepared.decision is None else prepared.decision.explain()),
        "mask": np.where(preds.mask, 255, 0).astype(np.uint8),
    }
    with writing("the explanation", folder):
        folder.mkdir(parents=True, exist_ok=True)
        for number, stage in enumerate(STAGES, 1):
            if stage in stages:
                pixels = stages[stage] if stages[stage].ndim == 2 else stages[stage][..., ::-1]
                write_bytes(folder / f"{stem}_{number}_{stage}.png", pack_png(pixels))
