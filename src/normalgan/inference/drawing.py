"""Drawing: the file of one job, decoded only once."""

from functools import cached_property
from pathlib import Path
from typing import Literal

from normalgan.decoding import Decoded, DecodedFrames, DecodedLayers, decode_frames, decode_tileset
from normalgan.inference.composites.animation import Kind, moving_kind
from normalgan.inference.composites.layers import LayeredKind, layered_kind, read_layers
from normalgan.inference.reading.drawings import LARGEST, SMALLEST, SVG_SIDE, read_content, read_pixels
from normalgan.inference.reading.picture import MOST_WORKED, Picture, to_picture

__all__ = ["Drawing"]


class Drawing:
    """The file of a drawing: its composite, frames and layers.

    Each is decoded on first use, and kept as long as this object: make one for a job, and drop
    it with the job.

    Args:
        path: its file, or its name in messages.
        content: its content, if it has been read already.
    """

    def __init__(self, path: Path, content: bytes | None = None) -> None:
        self.path = path
        self._given = content
        self._shown: Decoded | None = None

    @cached_property
    def moving(self) -> Kind | Literal["pages"] | None:
        """The kind of its animation, or `PAGES`; None of one picture.

        Raises:
            InputError: if it is a GIF that is cut short.
        """
        return moving_kind(self.path, self._given)

    @cached_property
    def layered(self) -> LayeredKind | None:
        """The kind of layered file that its layers are written back as; None if it has none."""
        return layered_kind(self.path, self._given)

    @cached_property
    def content(self) -> bytes:
        """The bytes of its file, not decoded yet.

        Raises:
            InputError: if it is missing, cannot be read, or is larger than any drawing.
        """
        return read_content(self.path, self._given)

    def picture(self, longest: int | None = None) -> Picture:
        """Return it as `reading.picture.read_picture` does; a very large one is reduced.

        Args:
            longest: longer side in pixels that an SVG is drawn with; None is `SVG_SIDE`.

        Raises:
            InputError: if it is missing, not an image, or too small or large.
        """
        side = min(longest or SVG_SIDE, MOST_WORKED)
        self._shown = read_pixels(self.path, self.content, side, MOST_WORKED)
        return to_picture(self._shown)

    def pixels(self) -> Decoded:
        """Return its pixels as its file has them; for an SVG, the last rendered size.

        A picture beyond the working size is decoded again for this.

        Raises:
            InputError: if it is missing, not an image, or too small or large.
        """
        shown = self._shown
        if shown is None or shown.pixels.shape[:2] != shown.shape:
            shown = read_pixels(self.path, self.content)
        return shown

    @cached_property
    def frames(self) -> DecodedFrames:
        """All its frames or pages, each in full.

        Raises:
            InputError: if one cannot be decoded.
        """
        return decode_frames(str(self.path), self.content, (SMALLEST, LARGEST))

    @property
    def tileset(self) -> tuple[Decoded, tuple[int, int]]:
        """Its own tiles, stacked vertically, and (width, height) of a tile.

        Raises:
            InputError: if it has none.
        """
        return decode_tileset(str(self.path), self.content, (SMALLEST, LARGEST))

    @cached_property
    def layers(self) -> DecodedLayers:
        """Its visible layers, as `composites.layers.read_layers` gives them.

        Raises:
            InputError: if it has no visible layer, or an unreadable one.
        """
        return read_layers(self.path, self.content)
