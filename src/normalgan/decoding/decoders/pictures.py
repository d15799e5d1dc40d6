"""Pictures: decoding of files of any format, as a single picture, in frames or in layers."""

import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .formats import NO_PAGE, SUBFILE, detect_format
from .levels import exact_levels, is_tiff, viewed
from .limits import limit_time
from .opening import (
    KNOWN,
    MOST_PARTS,
    MOST_PIXELS,
    DamagedError,
    Message,
    RefusedError,
    check_sides,
    first_line,
    opened,
    reduced_size,
    with_form,
)
from .svg import draw_svg, is_svg

if TYPE_CHECKING:
    from PIL.Image import Image

    from .layered_files import Notes

_MOST_NOTES = 4000
"""Maximum length of a text sent about a picture."""
_LONGEST_NAME, _DEEPEST = 255, 32
"""Maximum length of a layer's name, and maximum number of nested groups, sent to the parent."""
_MOST_NOTED = 64
"""Maximum number of notes on layers sent to the parent."""
_TOPS = (255, 1023, 4095, 16383, 65535, 2**24 - 1, 2**31 - 1)
"""White levels of 8, 10, 12, 14, 16, 24 and 31 bits, which programs store in 16 or 32 bits."""


def decode(
    content: bytes, least: int, most: int, svg_side: int, longest: int, grey: bool, notes: list[Any]
) -> tuple[Any, tuple[int, int]]:
    """Return a picture upright, and its (width, height) before downsampling.

    The picture is an image in one of `MODES`, or an array if only OpenCV can read it.

    Args:
        content: content of the file.
        least: minimum side in pixels.
        most: maximum side in pixels, checked before any pixel is decoded.
        svg_side: longer side of the rendering of an SVG, in pixels.
        longest: longer side in pixels to which larger pictures are downsampled; 0 keeps the size.
        grey: whether to return only the brightness on white paper.
        notes: list that receives notes on the picture.

    Raises:
        RefusedError: if the picture cannot be decoded.
    """
    from PIL import UnidentifiedImageError

    if is_svg(content):
        content = draw_svg(content, svg_side, most)
    try:
        upright = _upright(content, least, most, notes)
        if upright is None:
            levels = exact_levels(content, least, most)
            return viewed(levels, longest, grey), levels.shape[1::-1]
        upright, full = plain(upright), upright.size
        if longest and max(full) > longest:
            upright = reduced(upright, longest)
        return _grey(upright) if grey else upright, full
    except (RefusedError, MemoryError):
        raise
    except UnidentifiedImageError:
        _refuse_foreign(content)
        raise RefusedError(f"is not an image that can be read; use {KNOWN}") from None
    except Exception as error:  # Pillow's decoders may raise anything on damaged data
        raise RefusedError(f"cannot be read as an image: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """Return why a picture cannot be decoded, in plain words if its end is missing."""
    cut_off = not isinstance(error, DamagedError) and "truncated" in str(error).lower()
    return "the file is incomplete" if cut_off else first_line(error)


def _upright(content: bytes, least: int, most: int, notes: list[Any]) -> "Image | None":
    """Return a picture upright; None if Pillow does not support it, such as a TIFF of float colours."""
    if (layered := _layered(content, least, most)) is not None:
        upright: Image = layered.composite()
        if str(layered.notes):
            notes.append(layered.notes)
        check_sides(upright.width, upright.height, least, most)
        upright.load()
        return upright
    try:
        image = opened(content)
    except DamagedError:
        if is_tiff(content):
            return None
        raise
    with image:
        check_sides(image.width, image.height, least, most)
        image.load()
        return turned_upright(image)


def frames(content: bytes, least: int, most: int, seconds: int) -> Iterator[Message]:
    """Yield the number of frames and of loops of an animation, and then each full frame.

    Raises:
        RefusedError: if the animation or a frame cannot be decoded.
    """
    from PIL import Image

    number = 0
    try:
        if (layered := _layered(content, least, most)) is not None:
            yield from _layered_frames(layered)
            return
        with opened(content) as image:
            if image.format == "TIFF":
                yield from _pages(image, least, most, seconds)
                return
            check_sides(image.width, image.height, least, most)
            # A PNG may begin with a picture for viewers without support for animations.
            first = 1 if getattr(image, "default_image", False) else 0
            count = getattr(image, "n_frames", 1) - first
            _check_parts(count, count * image.width * image.height, "frames")
            loop, size = image.info.get("loop", 1), image.size
            # Pillow enlarges a GIF for a frame that is larger; `_opened` lifts the limit again.
            Image.MAX_IMAGE_PIXELS = MOST_PIXELS
            yield {"count": count, "loop": loop if 0 <= loop < 2**16 else 0}, None
            for number in range(first, first + count):
                limit_time(seconds)
                image.seek(number)
                if image.size != size:
                    raise RefusedError(
                        f"has a frame {number + 1} that reaches beyond its {size[0]} × {size[1]} pixels"
                    )
                image.load()
                shown = plain(image.copy())
                milliseconds = min(max(int(image.info.get("duration", 0)), 0), 2**31)
                yield {**with_form(shown), "duration": milliseconds}, shown
    except (RefusedError, MemoryError):
        raise
    except Exception as error:  # as in `decode`
        raise RefusedError(f"cannot be read from its frame {number + 1} on: {first_line(error)}") from None


def _pages(image: Any, least: int, most: int, seconds: int) -> Iterator[Message]:
    """Yield the pages of a TIFF, which may differ in size."""
    pages, pixels = [], 0
    for number in range(min(image.n_frames, MOST_PARTS + 1)):
        image.seek(number)
        if not image.tag_v2.get(SUBFILE, 0) & NO_PAGE:
            check_sides(image.width, image.height, least, most)
            pages.append(number)
            pixels += image.width * image.height
    _check_parts(len(pages), pixels, "pages")
    yield {"count": len(pages), "loop": 0}, None
    for place, number in enumerate(pages, 1):
        limit_time(seconds)
        with _failures_refused(f"cannot be read from its page {place} on"):
            image.seek(number)
            image.load()
            shown = plain(turned_upright(image.copy()))
        yield {**with_form(shown), "duration": 0}, shown


def layers(content: bytes, least: int, most: int, seconds: int) -> Iterator[Message]:
    """Yield a description of a layered file, and then its visible layers, lowest first.

    Raises:
        RefusedError: if there are no visible layers, or they cannot be decoded; raised before the first
            message.
    """
    with _failures_refused("has layers that cannot be read"):
        layered = _layered(content, least, most)
        if layered is None:
            _refuse_foreign(content)
            raise RefusedError(
                "has no layers; those of .psd, .kra, .ora, .ase and .aseprite can be predicted"
            )
        found, pixels = [], 0
        for layer in layered.layers():
            limit_time(seconds)
            found.append(layer)
            pixels += layer.image.width * layer.image.height
            _check_parts(len(found), pixels, "layers")
    if not found:
        more = f": {layered.notes}" if str(layered.notes) else ""
        raise RefusedError(f"has no visible layer with content{more}")
    durations, full = [min(each, 2**31) for each in layered.durations], [*layered.size[::-1]]
    yield {"count": len(found), "full": full, "durations": durations, **noted(layered.notes)}, None
    for layer in found:
        names = [each[:_LONGEST_NAME] for each in (*layer.groups[:_DEEPEST], layer.name)]
        place = {name: getattr(layer, name) for name in ("left", "top", "number", "frame", "opacity")}
        base = -1 if layer.base is None else layer.base.number
        yield {**with_form(layer.image), **place, "names": names, "base": base}, layer.image


def tileset(content: bytes, least: int, most: int) -> Iterator[Message]:
    """Yield the size of a tile of an Aseprite file, and then all tiles, stacked vertically.

    Raises:
        RefusedError: if there is no tileset, or it cannot be decoded.
    """
    with _failures_refused("has a tileset that cannot be read"):
        layered = _layered(content, least, most)
        if layered is None:
            raise RefusedError("has no tileset of its own; give the size of a tile, such as 16x16")
        image, size = layered.tileset()
    check_sides(image.width, image.height, least, most)
    yield {"count": 1, "tile": [*size]}, None
    yield with_form(image), image


def _check_parts(count: int, pixels: int, name: str) -> None:
    if not 0 < count <= MOST_PARTS or pixels > MOST_PIXELS:
        raise RefusedError(
            f"has {count} {name} of {pixels} pixels together; {MOST_PARTS} of {MOST_PIXELS} can be predicted"
        )


def turned_upright(image: "Image") -> "Image":
    """Return an image rotated according to its EXIF data, or unchanged if that data is damaged."""
    from PIL import ImageOps

    try:
        return ImageOps.exif_transpose(image)
    except MemoryError:
        raise
    except Exception:  # only metadata, so the picture itself is still valid
        return image


def plain(image: "Image") -> "Image":
    """Convert an image of any mode to one of `MODES`."""
    if image.mode.startswith("I"):
        return _deep(image)
    if image.mode in {"RGBA", "LA", "PA", "RGBa", "La"} or "transparency" in image.info:
        if image.mode == "La":
            image = image.convert("LA")
        clear = image.info.get("transparency")
        if isinstance(clear, tuple) and max(clear) > 255:  # 16 bits, of which Pillow keeps 8
            image.info["transparency"] = tuple(each >> 8 for each in clear)
        return image.convert("RGBA")
    if image.mode in {"1", "L"}:
        return image.convert("L")
    return image if image.mode == "F" else image.convert("RGB")


def _deep(image: "Image") -> "Image":
    """Return a grey image of 16 or 32 bits with white at 65535.

    A picture within the lowest quarter of its range is assumed to have fewer bits than the file says. If
    one of its grey levels is transparent, it is converted to RGBA with 8 bits.
    """
    import numpy as np
    from PIL import Image

    levels = np.asarray(image if image.mode in {"I", "I;16"} else image.convert("I"))
    most, clear = int(levels.max()), image.info.get("transparency")
    top = next((each for each in _TOPS if most <= each), _TOPS[-1])
    scaled: Any = np.clip(levels, 0, top)
    if top != 65535:
        scaled = np.rint(np.multiply(scaled, np.float32(65535 / top), dtype=np.float32))
    scaled = scaled.astype(np.uint16)
    hidden = levels == clear if isinstance(clear, int) else None
    if hidden is None or not hidden.any():
        return Image.fromarray(scaled)
    grey = np.rint(scaled / np.float32(257)).astype(np.uint8)
    opacity = np.where(hidden, np.uint8(0), np.uint8(255))
    return Image.merge("RGBA", [Image.fromarray(each) for each in (grey, grey, grey, opacity)])


def reduced(image: "Image", longest: int) -> "Image":
    """Return an image downsampled by averaging."""
    from PIL import Image

    size = reduced_size(image.width, image.height, longest)
    if image.mode == "RGBA":  # colours of transparent pixels must not bleed into visible ones
        return image.convert("RGBa").resize(size, Image.Resampling.BOX).convert("RGBA")
    if image.mode == "I;16":
        image = image.convert("I")
    return image.resize(size, Image.Resampling.BOX)


def _grey(image: "Image") -> "Image":
    """Return the brightness of an image of one of `MODES` on white paper."""
    from PIL import Image

    if image.mode == "RGBA":
        image = Image.alpha_composite(Image.new("RGBA", image.size, "white"), image).convert("RGB")
    return image.convert("L") if image.mode == "RGB" else image


def _layered(content: bytes, least: int, most: int) -> Any:
    """Open a paint program's layered file without decoding it, or return None for any other file.

    Raises:
        RefusedError: if the file cannot be read, or the picture is too small or too large.
    """
    found = detect_format(content[:64])
    if found is None or not found.layered:
        return None
    from .layered_files import open_layered  # only few files need it

    return open_layered(found.name, content, lambda width, height: check_sides(width, height, least, most))


def _layered_frames(layered: Any) -> Iterator[Message]:
    width, height = layered.size
    count = len(layered.durations)
    _check_parts(count, count * width * height, "frames")
    found = layered.frames()
    first = next(found)
    yield {"count": count, "loop": 0, **noted(layered.notes)}, None
    for image, milliseconds in itertools.chain([first], found):
        yield {**with_form(image), "duration": milliseconds}, image


@contextmanager
def _failures_refused(words: str) -> Iterator[None]:
    """Convert any exception raised by a decoder to a `RefusedError` with ``words`` and the reason."""
    try:
        yield
    except (RefusedError, MemoryError):
        raise
    except Exception as error:
        raise RefusedError(f"{words}: {first_line(error)}") from None


def _refuse_foreign(content: bytes) -> None:
    """Raise `RefusedError` for an unsupported paint program's file."""
    from .layered_files import foreign

    reason = foreign(content)
    if reason is not None:
        raise RefusedError(reason)


def noted(*notes: "Notes") -> dict[str, Any]:
    """Return the notes on differences of a file for the parent, truncated to the limits."""
    return {
        "note": " ".join("; ".join(map(str, notes)).split())[:_MOST_NOTES],
        "partial": any(each.partial for each in notes),
        "notes": [
            [name[:_LONGEST_NAME], reason] for each in notes for name, reason in each.parts[:_MOST_NOTED]
        ],
    }
