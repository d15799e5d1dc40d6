"""Decoding: converts files of any picture format to pixels, in a child process with limits.

A file of a few kilobytes can make a decoder crash, hang or use all memory, and an SVG can refer to other
files. Pictures are therefore decoded in a child process, which is started once and reused. It cannot open
files and is killed after a time limit. Where the system supports it, memory and processor time are limited
too.
"""

from normalgan.decoding.process import decode, decode_frames, decode_layers, decode_tileset, start
from normalgan.decoding.results import (
    Decoded,
    DecodedFrames,
    DecodedLayer,
    DecodedLayers,
    DecodedPixels,
    FileNotes,
    LayerNote,
)

__all__ = [
    "Decoded",
    "DecodedFrames",
    "DecodedLayer",
    "DecodedLayers",
    "DecodedPixels",
    "FileNotes",
    "LayerNote",
    "decode",
    "decode_frames",
    "decode_layers",
    "decode_tileset",
    "start",
]
