"""Results: the results of decoding a file: pixels, frames, layers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Decoded", "DecodedFrames", "DecodedLayer", "DecodedLayers", "FileNotes", "LayerNote", "Pixels"]

Pixels = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.int32] | NDArray[np.float32]
"""(H, W) grey of any of these types, or (H, W, 3) or (H, W, 4), red, green, blue and opacity, of 8 bits; as
stored, if that is asked for, also of 16 bits or floats."""


@dataclass(frozen=True)
class LayerNote:
    """A layer that is left out, or looks different than in its program.

    Args:
        name: its name in the file; empty for the whole file.
        reason: why a layer is left out: it is ``damaged``, has ``no_pixels`` of its own, or is ``foreign``
            (only its program can draw it). Else ``effect``, or ``frame`` if one frame of an animation is
            used.
    """

    name: str
    reason: str


@dataclass(frozen=True)
class FileNotes:
    """How a file looks different than in its program.

    Args:
        text: part of a sentence; empty if there is no difference.
        partial: whether a layer is missing.
        layers: the differences, layer by layer.
    """

    text: str = ""
    partial: bool = False
    layers: tuple[LayerNote, ...] = ()


@dataclass(frozen=True)
class Decoded:
    """A picture's pixels, upright.

    Args:
        pixels: (h, w), (h, w, 3) or (h, w, 4).
        shape: (H, W) of the file, before any reduction.
        notes: how the file looks different.
    """

    pixels: Pixels
    shape: tuple[int, int]
    notes: FileNotes = FileNotes()


@dataclass(frozen=True)
class DecodedFrames:
    """The frames of an animation, or the pages of a file.

    Args:
        frames: each in full.
        durations: duration of each in milliseconds.
        loop: number of loops; 0 is endless.
        notes: how the file looks different.
    """

    frames: list[Decoded]
    durations: list[int]
    loop: int
    notes: FileNotes = FileNotes()


@dataclass(frozen=True)
class DecodedLayer:
    """A visible layer, or one frame of it.

    Args:
        name: its name in the file.
        groups: names of the groups around it, the outermost first.
        opacity: 0 to 255, multiplied by its groups'; not applied to the pixels.
        left: column of its left edge in the picture.
        top: row of its top edge in the picture.
        number: number of the layer, counted from the bottom.
        frame: number of the frame.
        pixels: (h, w, 4), all within the picture.
        clipped_to: number of the layer that it is clipped to, -1 for none; the pixels are already cut.
    """

    name: str
    groups: tuple[str, ...]
    opacity: int
    left: int
    top: int
    number: int
    frame: int
    pixels: NDArray[np.uint8]
    clipped_to: int = -1


@dataclass(frozen=True)
class DecodedLayers:
    """The visible layers of a layered file.

    Args:
        shape: (H, W) of the picture.
        durations: duration of each frame in milliseconds; [0] for a still file.
        layers: frame by frame, bottom to top; empty layers are left out.
        notes: how the file looks different.
    """

    shape: tuple[int, int]
    durations: list[int]
    layers: list[DecodedLayer]
    notes: FileNotes = FileNotes()
