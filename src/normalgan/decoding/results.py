"""Results of decoding a file: pixels, frames, layers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DecodedPixels = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.int32] | NDArray[np.float32]
"""(H, W) grey of any of these types, or (H, W, 3) or (H, W, 4) with red, green, blue and opacity of 8
bits. If the stored levels are requested, colours may also be 16 bits or floats."""


@dataclass(frozen=True)
class LayerNote:
    """A layer that is left out, or looks different than in its program.

    Args:
        name: name of the layer in the file; empty for the whole file.
        reason: reason for leaving out a layer: it is ``damaged``, has ``no_pixels`` of its own, or is
            ``foreign`` (only its program can draw it). For other differences, ``effect``, or ``frame`` if
            only one frame of an animation is used.
    """

    name: str
    reason: str


@dataclass(frozen=True)
class FileNotes:
    """Differences of a decoded file from its rendering in the original program.

    Args:
        text: description as part of a sentence; empty if there are no differences.
        partial: whether a layer is missing.
        layers: differences by layer.
    """

    text: str = ""
    partial: bool = False
    layers: tuple[LayerNote, ...] = ()


@dataclass(frozen=True)
class Decoded:
    """A picture's pixels, upright.

    Args:
        pixels: (h, w), (h, w, 3) or (h, w, 4).
        shape: (H, W) of the file before downsampling.
        notes: differences between the decoded file and what its own program shows.
    """

    pixels: DecodedPixels
    shape: tuple[int, int]
    notes: FileNotes = FileNotes()


@dataclass(frozen=True)
class DecodedFrames:
    """The frames of an animation, or the pages of a file.

    Args:
        frames: full frames.
        durations: durations of the frames in milliseconds.
        loop: number of loops; 0 for endless.
        notes: differences between the decoded file and what its own program shows.
    """

    frames: list[Decoded]
    durations: list[int]
    loop: int
    notes: FileNotes = FileNotes()


@dataclass(frozen=True)
class DecodedLayer:
    """A visible layer, or one frame of it.

    Args:
        name: name of the layer in the file.
        groups: names of the groups around it, outermost first.
        opacity: opacity from 0 to 255, multiplied by that of the groups; not applied to the pixels.
        left: column of the left edge in the picture.
        top: row of the top edge in the picture.
        number: index of the layer from the bottom.
        frame: index of the frame.
        pixels: (h, w, 4) pixels, completely inside the picture.
        clipped_to: index of the layer that it is clipped to, -1 for none; the pixels are already clipped.
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
        durations: durations of the frames in milliseconds; [0] for a still file.
        layers: layers by frame, bottom to top; empty layers are left out.
        notes: differences between the decoded file and what its own program shows.
    """

    shape: tuple[int, int]
    durations: list[int]
    layers: list[DecodedLayer]
    notes: FileNotes = FileNotes()
