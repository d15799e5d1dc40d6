"""Drawing: the file of a job, decoded at most once."""

from functools import cached_property
from pathlib import Path
from typing import Literal

from normalgan.decoding import Decoded, DecodedFrames, DecodedLayers, decode_frames, decode_tileset
from normalgan.inference.composites.animation import Kind, moving_kind
from normalgan.inference.composites.layers import LayeredKind, layered_kind, read_layers
from normalgan.inference.reading.drawings import LARGEST, SMALLEST, SVG_SIDE, read_content, read_pixels
from normalgan.inference.reading.picture import MOST_WORKED, Picture, to_picture


class Drawing:
    """The file of a drawing, with its composite, frames and layers.

    Each is decoded on first use and kept until the object is discarded, so use one object per job.

    Args:
        path: the file, or its name in messages.
        content: content of the file, if it has been read already.
    """

    def __init__(self, path: Path, content: bytes | None = None) -> None:
        self.path = path
        self._given = content
        self._shown: Decoded | None = None

    @cached_property
    def moving(self) -> Kind | Literal["pages"] | None:
        """The kind of the animation, `PAGES` for a multi-page file, or None for a single picture.

        Raises:
            InputError: if the file is a truncated GIF.
        """
        return moving_kind(self.path, self._given)

    @cached_property
    def layered(self) -> LayeredKind | None:
        """The format that the layers are written in; None if the file has no layers."""
        return layered_kind(self.path, self._given)

    @cached_property
    def content(self) -> bytes:
        """The bytes of the file.

        Raises:
            InputError: if the file is missing, cannot be read, or is too large.
        """
        return read_content(self.path, self._given)

    def picture(self, longest: int | None = None) -> Picture:
        """Return the composite as `reading.picture.read_picture` does; a very large picture is reduced.

        Args:
            longest: longer side in pixels at which an SVG is rendered; None uses `SVG_SIDE`.

        Raises:
            InputError: if the file is missing, not an image, or too small or large.
        """
        side = min(longest or SVG_SIDE, MOST_WORKED)
        self._shown = read_pixels(self.path, self.content, side, MOST_WORKED)
        return to_picture(self._shown)

    def pixels(self) -> Decoded:
        """Return the pixels of the file at full size; of an SVG, as last rendered.

        A picture larger than the working size is decoded a second time.

        Raises:
            InputError: if the file is missing, not an image, or too small or large.
        """
        shown = self._shown
        if shown is None or shown.pixels.shape[:2] != shown.shape:
            shown = read_pixels(self.path, self.content)
        return shown

    @cached_property
    def frames(self) -> DecodedFrames:
        """All frames or pages, each as a whole picture.

        Raises:
            InputError: if a frame cannot be decoded.
        """
        return decode_frames(str(self.path), self.content, (SMALLEST, LARGEST))

    @property
    def tileset(self) -> tuple[Decoded, tuple[int, int]]:
        """The file's own tiles, stacked vertically, and the (width, height) of a tile.

        Raises:
            InputError: if the file has no tileset.
        """
        return decode_tileset(str(self.path), self.content, (SMALLEST, LARGEST))

    @cached_property
    def layers(self) -> DecodedLayers:
        """The visible layers, as returned by `composites.layers.read_layers`.

        Raises:
            InputError: if the file has no visible layer, or an unreadable one.
        """
        return read_layers(self.path, self.content)
