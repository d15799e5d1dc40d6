"""LayeredFile: base class of layered file formats, with layers and notes."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..opening import RefusedError

if TYPE_CHECKING:
    from PIL.Image import Image

_MOST_NOTES = 12
"""Maximum number of notes given in full; others are only counted."""


class Notes:
    """Notes on differences between a layered file as decoded and as displayed by its own program."""

    def __init__(self) -> None:
        self._said: dict[str, list[str]] = {}
        self.partial = False
        """Whether a whole layer is missing, not only an effect."""

    def leave_out(self, name: str, words: str, reason: str) -> None:
        """Add a note on a missing layer, which is ``damaged``, has ``no_pixels``, or is ``foreign``."""
        self.partial = True
        self.add(name, words, reason)

    def add(self, name: str, words: str, reason: str = "effect") -> None:
        """Add a note on a layer."""
        self._said[f"{name!r}: {words}"] = [name, reason]

    def add_blend(self, name: str, mode: str) -> None:
        """Add a note on an unsupported blend mode."""
        self.add(name, f"blend mode {mode.replace('_', ' ').lower()} shown as normal")

    def add_file(self, words: str) -> None:
        """Add a note on the whole file."""
        self._said[words] = ["", "frame"]

    @property
    def parts(self) -> list[list[str]]:
        """The layer's name (empty for the whole file) and the reason of each note."""
        return list(self._said.values())

    def __str__(self) -> str:
        said = list(self._said)
        more = f"; and {len(said) - _MOST_NOTES} more" if len(said) > _MOST_NOTES else ""
        return "; ".join(said[:_MOST_NOTES]) + more


@dataclass(eq=False)
class Layer:
    """A visible layer, or one frame of it.

    Args:
        name: name of the layer in the file.
        groups: names of the groups around it, outermost first.
        opacity: opacity from 0 to 255, multiplied by that of the groups; not applied to the image.
        left: column of the image's left edge in the picture; may be negative.
        top: row of the image's top edge in the picture; may be negative.
        image: RGBA image.
        number: index of the layer from the bottom; -1 assigns indices in the order of the layers.
        frame: index of the frame.
        base: layer that it is clipped to; the image is already clipped.
    """

    name: str
    groups: tuple[str, ...]
    opacity: int
    left: int
    top: int
    image: "Image"
    number: int = -1
    frame: int = 0
    base: "Layer | None" = None


class LayeredFile(ABC):
    """Base class of layered files. Opening a file reads its structure; its pictures are decoded later.

    Args:
        content: content of the file.
        check_size: called with width and height before anything else is read; may raise to refuse the file.

    Raises:
        RefusedError: if it is broken, or of an unknown version.
    """

    def __init__(self, content: bytes, check_size: Callable[[int, int], None]) -> None:
        self.content = content
        self.notes = Notes()
        """Differences from the file's own program, in the parts read so far."""
        self.size = self._read_size()
        """(width, height) in pixels."""
        check_size(*self.size)
        self.durations = [0]
        """Duration of each frame in milliseconds; [0] for a still file."""

    def frames(self) -> "Iterator[tuple[Image, int]]":
        """Yield each frame with its duration in milliseconds."""
        yield self.composite(), 0

    def tileset(self) -> "tuple[Image, tuple[int, int]]":
        """Return the tiles of the first visible tilemap, stacked vertically, and the size of a tile.

        Raises:
            RefusedError: if the file has no tilemap.
        """
        raise RefusedError("has no tileset of its own; give the size of a tile, such as 16x16")

    def layers(self) -> Iterator[Layer]:
        """Yield the visible layers, bottom to top, each cropped to its opaque part.

        Layers of an animation are yielded frame by frame. Empty layers are left out. A layer that cannot
        be decoded is left out with a note.

        Raises:
            RefusedError: if the file cannot be read.
        """
        width, height = self.size
        for number, each in enumerate(self._read_layers()):
            if each.number < 0:
                each.number = number
            box = max(-each.left, 0), max(-each.top, 0), width - each.left, height - each.top
            image = each.image.convert("RGBA")
            right, bottom = min(box[2], image.width), min(box[3], image.height)
            if right <= box[0] or bottom <= box[1]:
                continue  # completely outside the picture
            image = image.crop((box[0], box[1], right, bottom))
            opaque = image.getchannel("A").getbbox()
            if opaque is None:
                continue
            each.image = image.crop(opaque)
            each.left, each.top = each.left + box[0] + opaque[0], each.top + box[1] + opaque[1]
            yield each

    @abstractmethod
    def composite(self) -> "Image":
        """Return the composite, or the first frame of an animation.

        Raises:
            RefusedError: if the file cannot be read.
        """

    @abstractmethod
    def _read_size(self) -> tuple[int, int]:
        """Return (width, height) from the header."""

    @abstractmethod
    def _read_layers(self) -> Iterator[Layer]:
        """Yield the visible layers, bottom to top, uncropped."""


def flattened(size: tuple[int, int], found: Iterable[Layer]) -> "Image":
    """Return the composite of layers, given bottom to top."""
    from PIL import Image

    canvas = Image.new("RGBA", size)
    for layer in found:
        over = Image.new("RGBA", size)
        over.paste(_faded(layer.image, layer.opacity), (layer.left, layer.top))
        canvas = Image.alpha_composite(canvas, over)
    return canvas


def _faded(image: "Image", opacity: int) -> "Image":
    image = image.convert("RGBA")
    if opacity < 255:
        image.putalpha(image.getchannel("A").point([value * opacity // 255 for value in range(256)]))
    return image
