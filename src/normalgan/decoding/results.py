"""Results: what decoding a file gives: pixels, frames, layers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Decoded", "DecodedLayer", "DecodedLayers", "FileNotes", "LayerNote", "Part", "Parts", "Pixels"]

Pixels = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.int32] | NDArray[np.float32]
"""(H, W) grey of any of these types, or (H, W, 3) or (H, W, 4), red, green, blue and opacity, of 8 bits; as
stored, if that is asked for, also of 16 bits or floats."""


@dataclass(frozen=True)
class LayerNote:
    """A layer that is left out, or not shown as its program shows it.

    Args:
        name: as the file has it; empty for the whole file.
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
        text: part of a sentence; empty if it does not.
        partial: whether a layer is missing.
        layers: the same, layer by layer.
    """

    text: str = ""
    partial: bool = False
    layers: tuple[LayerNote, ...] = ()


@dataclass(frozen=True)
class Decoded:
    """A picture's pixels, upright.

    Args:
        pixels: (h, w), (h, w, 3) or (h, w, 4).
        shape: (H, W) of the file; that of the pixels unless they were reduced.
        notes: how it looks different.
    """

    pixels: Pixels
    shape: tuple[int, int]
    notes: FileNotes = FileNotes()


@dataclass(frozen=True)
class Part:
    """One frame of an animation.

    Args:
        decoded: its pixels.
        duration: milliseconds that it is shown.
    """

    decoded: Decoded
    duration: int


@dataclass(frozen=True)
class Parts:
    """A file of several pictures.

    Args:
        parts: the frames.
        loop: how often they are shown; 0 is for ever.
        notes: how it looks different.
    """

    parts: list[Part]
    loop: int
    notes: FileNotes = FileNotes()


@dataclass(frozen=True)
class DecodedLayer:
    """A visible layer, or what it shows in one frame.

    Args:
        name: as the file has it.
        groups: names of those that it lies in, the outermost first.
        opacity: 0 to 255, with that of its groups; the pixels do not have it.
        left: column of the picture in which its first one lies.
        top: row of the picture in which its first one lies.
        number: number of the layer, from the lowest up.
        frame: in which it shows this.
        pixels: (h, w, 4), all within the picture.
        clipped_to: number of the layer that it is clipped to, by which its pixels are cut; -1 if to none.
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
        durations: milliseconds that each frame is shown; one of 0 if it does not move.
        layers: frame by frame, in each the lowest first; those that nothing is drawn on are not among them.
        notes: how it looks different.
    """

    shape: tuple[int, int]
    durations: list[int]
    layers: list[DecodedLayer]
    notes: FileNotes = FileNotes()
