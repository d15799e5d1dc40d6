"""Decoding: files of any picture format to pixels, in a child process with limits.

A file of a few kilobytes can make a decoder crash, hang, or take all memory, and an SVG can name other files
to be drawn. So no foreign picture is decoded in this process. A child that is started once and kept does
it; it can open no files, has limits of memory and of processor time where the system knows such, and is ended
by the clock everywhere.
"""

from normalgan.decoding.process import decode, decode_frames, decode_layers, decode_tileset, start
from normalgan.decoding.results import Decoded, DecodedLayer, DecodedLayers, LayerNote, Part, Parts, Pixels

__all__ = [
    "Decoded",
    "DecodedLayer",
    "DecodedLayers",
    "LayerNote",
    "Part",
    "Parts",
    "Pixels",
    "decode",
    "decode_frames",
    "decode_layers",
    "decode_tileset",
    "start",
]
