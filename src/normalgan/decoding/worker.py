"""The program of the child process that decodes pictures; `normalgan.decoding` says what it is for.

It answers requests over a `multiprocessing.connection` until that ends. Each message is JSON or pixels, and
none is a pickle. It runs without the package on its path and imports nothing of it, so that it starts in a
fraction of the time.
"""

import base64
import binascii
import codecs
import encodings
import io
import itertools
import json
import os
import pkgutil
import re
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pyexpat import ErrorString, ExpatError, ParserCreate
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from PIL.Image import Image

if TYPE_CHECKING or __package__:
    from normalgan.decoding.formats import ENDINGS, format_of
else:  # as a program, which has no package
    sys.path.append(os.path.dirname(os.path.abspath(__file__)))  # noqa: PTH100, PTH120
    from formats import ENDINGS, format_of

__all__ = [
    "DTYPES",
    "MODES",
    "MOST_DEPTH",
    "MOST_PARTS",
    "MOST_PIXELS",
    "MOST_TEXT",
    "DamagedError",
    "Message",
    "RefusedError",
    "UnknownTiffError",
    "decode",
    "draw_svg",
    "exact_levels",
    "float_white",
    "frames",
    "import_all",
    "is_svg",
    "layers",
    "limit",
    "limit_time",
    "loses_levels",
    "main",
    "needed",
    "plain",
    "reduced",
    "sanitize_svg",
    "tileset",
    "turned_upright",
    "viewed",
]

Message = tuple[dict[str, Any], Any]
"""What is sent: some words and numbers, and an image or an array, whose pixels follow in strips; or None."""
MOST_PARTS, MOST_PIXELS = 1024, 2**26
"""Frames of an animation, and pixels of all of them together: as many as the largest drawing has."""
MODES: dict[str, tuple[str, tuple[int, ...]]] = {
    "L": ("uint8", ()),
    "RGB": ("uint8", (3,)),
    "RGBA": ("uint8", (4,)),
    "I;16": ("uint16", ()),
    "I": ("int32", ()),
    "F": ("float32", ()),
}
"""Modes of Pillow in which pixels are sent: the type of a number, and the channels."""
DTYPES = ("uint8", "uint16", "int32", "float32")

MOST_DEPTH = 128
"""Elements within one another in an SVG: the drawing library needs stack for each, and ends without."""
MOST_TEXT = 2**26
"""Characters of an SVG with its entities written out."""

_KNOWN = " ".join(ENDINGS)
_SUBFILE, _NO_PAGE = 254, 1 | 4
"""A tag of TIFF that says what a picture of it is, and its bits for a small copy and for a mask."""
_STRIP = 2**20
_MOST_NOTES = 4000
"""Characters of the words that are sent about a picture."""
_LONGEST_NAME, _DEEPEST = 255, 32
"""Characters of a layer's name, and groups within one another, of which the parent is told."""
_DPI = 96.0
"""What CSS takes an inch for; without it millimetres have no size."""
_EMBEDDED = re.compile(r"data:image/(?:png|jpe?g|gif|webp);base64,", re.IGNORECASE)


class UnknownTiffError(Exception):
    """A TIFF that Pillow does not know, such as one of floats with colours; OpenCV may."""


class DamagedError(OSError):
    """A picture of a known format that its decoder does not know."""


class RefusedError(Exception):
    """A picture that is not decoded; its text goes after the picture's name: "is … pixels"."""


def main(handle: int, needs: str, seconds: int, memory: int, folders: list[str]) -> None:
    """Answer requests until the other end is closed.

    Args:
        handle: of the connection.
        needs: what `needed` says of the pictures that will come.
        seconds: of processor time for one picture.
        memory: bytes of address space on top of what the libraries map.
        folders: where the libraries lie.
    """
    from multiprocessing import connection as connections

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one who asks
    if sys.platform == "win32":
        connection = connections.PipeConnection(handle)
    else:
        connection = connections.Connection(handle)
    sys.path.extend(folders)
    try:
        import_all(needs)
        limit(memory)
    except Exception as error:
        _send(connection, _refusal(f"{type(error).__name__}: {error}"), None)
        return
    _send(connection, {"ready": True}, None)
    while True:
        try:
            request, content = json.loads(connection.recv_bytes()), connection.recv_bytes()
        except (EOFError, OSError):
            return
        limit_time(seconds)
        try:
            for header, pixels in _answers(request, content, seconds):
                _send(connection, header, pixels)
                del pixels
        except RefusedError as refusal:
            _send(connection, _refusal(str(refusal)), None)
        except MemoryError:
            words = f"needs more than {memory >> 20} MiB of memory to be decoded"
            _send(connection, _refusal(words), None)
        del content


def needed(content: bytes, exact: bool = False) -> str:
    """Return which library a picture needs besides what all have; empty if none."""
    found = format_of(content[:64])
    name = found.name if found is not None else ""
    if name in {"PSD", "HEIC"}:
        return {"PSD": "psd_tools", "HEIC": "pillow_heif"}[name]
    return "cv2" if name == "TIFF" or (exact and loses_levels(content)) else ""


def import_all(needs: str) -> None:
    """Import all that decoding needs: once the limits hold, no file can be opened, not even for that."""
    modules = [
        "resvg_py",
        "layered_files",
        "xml.etree.ElementTree",
        "PIL.ImageChops",
        "PIL.ImageOps",
        "numpy",
    ]
    modules += [f"PIL.{plugin}ImagePlugin" for plugin in ("Avif", "Mpo", "Tiff", "WebP")]
    if needs == "psd_tools":
        modules += ["psd_tools.composite", "PIL.ImageCms"]
        modules += [f"scipy.{part}" for part in ("interpolate", "ndimage", "spatial")]
    elif needs == "cv2":
        modules += ["cv2"]
    for module in modules:
        import_module(module)
    from PIL import Image

    Image.preinit()  # what it would import for the first picture
    if needs == "pillow_heif":
        with suppress(ImportError):  # `_opened` says that it is not installed
            _import_plugin("HEIF")
    for found in pkgutil.iter_modules(encodings.__path__):  # those of SVG and of names in ZIP
        if found.name.startswith(("cp", "iso8859", "koi8", "mac_", "utf_")):
            codecs.lookup(found.name)


def _answers(request: dict[str, Any], content: bytes, seconds: int) -> Iterator[Message]:
    least, most = request["sides"]
    if request["what"] == "frames":
        yield from frames(content, least, most, seconds)
    elif request["what"] == "layers":
        yield from layers(content, least, most, seconds)
    elif request["what"] == "tileset":
        yield tileset(content, least, most)
    elif request["exact"] and loses_levels(content):
        levels = exact_levels(content, least, most)
        yield _with_form(levels), levels
    else:
        sizes = request["svg_side"], request["longest"]
        notes: list[Any] = []
        try:
            image, (width, height) = decode(content, least, most, *sizes, request["grey"], notes)
            said = {"note": _told("; ".join(map(str, notes))), "partial": any(each.partial for each in notes)}
            yield {**_with_form(image), "full": [height, width], **said}, image
        except UnknownTiffError:
            levels = viewed(exact_levels(content, least, most), request["longest"], request["grey"])
            yield _with_form(levels), levels


def _with_form(pixels: Any) -> dict[str, Any]:
    """Return the type and the shape of an image or an array; that of its file is the same."""
    if hasattr(pixels, "dtype"):
        dtype, shape = pixels.dtype.name, pixels.shape
    else:
        dtype, channels = MODES[pixels.mode]
        shape = (pixels.height, pixels.width, *channels)
    return {"dtype": dtype, "shape": [*shape], "full": [*shape[:2]]}


def _send(connection: Any, header: dict[str, Any], pixels: Any) -> None:
    connection.send_bytes(json.dumps(header).encode())
    if pixels is None:
        return
    height, width = header["shape"][:2]
    rows = max(_STRIP // width, 1)  # in strips: a whole copy of a large one is as large again
    for top in range(0, height, rows):
        bottom = min(top + rows, height)
        strip = pixels[top:bottom] if hasattr(pixels, "dtype") else pixels.crop((0, top, width, bottom))
        connection.send_bytes(strip.tobytes())


def _told(notes: object) -> str:
    """Return what is to be said of a picture, in one line of bounded length."""
    return " ".join(str(notes).split())[:_MOST_NOTES]


def _refusal(words: str) -> dict[str, str]:
    return {"refused": " ".join(words.split())[:600]}


def limit(memory: int) -> None:
    """Take from this process what decoding does not need: files, and memory without bound."""
    try:
        import resource
    except ImportError:  # Windows has nothing like it
        return
    # No file, socket or pipe is opened from here on, whatever a decoder is talked into.
    for what in (resource.RLIMIT_CORE, resource.RLIMIT_FSIZE):
        _lower(what, 0)
    if sys.platform == "linux":  # macOS does not heed it
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 -- nothing more is imported
            mapped = int(file.read().split()[0]) * resource.getpagesize()
        _lower(resource.RLIMIT_AS, mapped + memory)
    _lower(resource.RLIMIT_NOFILE, 0)


def limit_time(seconds: int) -> None:
    """Have the system end this process if the next picture takes too much processor time."""
    if sys.platform == "win32":
        return
    import resource

    used = resource.getrusage(resource.RUSAGE_SELF)
    until = int(used.ru_utime + used.ru_stime) + 1 + seconds
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    resource.setrlimit(
        resource.RLIMIT_CPU, (until if hard == resource.RLIM_INFINITY else min(until, hard), hard)
    )


def _lower(what: int, most: int) -> None:
    """Set a limit of this process, unless a lower one holds."""
    import resource

    hard = resource.getrlimit(what)[1]
    most = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(what, (most, most))


def frames(content: bytes, least: int, most: int, seconds: int) -> Iterator[Message]:
    """Yield how many frames an animation has and how often they are shown, and then each frame, whole.

    Raises:
        RefusedError: if it, or a frame of it, cannot be decoded.
    """
    from PIL import Image

    number = 0
    try:
        if (layered := _layered(content, least, most)) is not None:
            yield from _layered_frames(layered)
            return
        with _opened(content) as image:
            if image.format == "TIFF":
                yield from _pages(image, least, most, seconds)
                return
            _check_sides(image.width, image.height, least, most)
            # A PNG may begin with a picture for those who know no animations.
            first = 1 if getattr(image, "default_image", False) else 0
            count = getattr(image, "n_frames", 1) - first
            _check_parts(count, count * image.width * image.height, "frames")
            loop, size = image.info.get("loop", 1), image.size
            # A frame can be larger than its GIF, which Pillow then enlarges; `_opened` lifts the limit again.
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
                yield {**_with_form(shown), "duration": milliseconds}, shown
    except (RefusedError, MemoryError):
        raise
    except Exception as error:  # as in `decode`
        raise RefusedError(f"cannot be read from its frame {number + 1} on: {_brief(error)}") from None


def _pages(image: Any, least: int, most: int, seconds: int) -> Iterator[Message]:
    """Yield the pages of a TIFF, which may differ in size."""
    pages, pixels = [], 0
    for number in range(min(image.n_frames, MOST_PARTS + 1)):
        image.seek(number)
        if not image.tag_v2.get(_SUBFILE, 0) & _NO_PAGE:
            _check_sides(image.width, image.height, least, most)
            pages.append(number)
            pixels += image.width * image.height
    _check_parts(len(pages), pixels, "pages")
    yield {"count": len(pages), "loop": 0}, None
    for place, number in enumerate(pages, 1):
        limit_time(seconds)
        try:
            image.seek(number)
            image.load()
            shown = plain(turned_upright(image.copy()))
        except MemoryError:
            raise
        except Exception as error:  # as in `decode`
            raise RefusedError(f"cannot be read from its page {place} on: {_brief(error)}") from None
        yield {**_with_form(shown), "duration": 0}, shown


def layers(content: bytes, least: int, most: int, seconds: int) -> Iterator[Message]:
    """Yield what a layered file is, and then its visible layers, the lowest first.

    Raises:
        RefusedError: if it has none, or they cannot be decoded; before anything is yielded.
    """
    try:
        layered = _layered(content, least, most)
        if layered is None:
            _refuse_foreign(content)
            raise RefusedError(
                "has no layers; those of .psd, .kra, .ora, .ase and .aseprite can be predicted"
            )
        found, pixels = [], 0
        with _unreadable_refused():
            for layer in layered.layers():
                limit_time(seconds)
                found.append(layer)
                pixels += layer.image.width * layer.image.height
                _check_parts(len(found), pixels, "layers")
    except (RefusedError, MemoryError):
        raise
    except Exception as error:  # as in `decode`
        raise RefusedError(f"has layers that cannot be read: {_brief(error)}") from None
    if not found:
        more = f": {layered.notes}" if str(layered.notes) else ""
        raise RefusedError(f"has no visible layer that anything is drawn on{more}")
    durations, full = [min(each, 2**31) for each in layered.durations], [*layered.size[::-1]]
    said = {"note": _told(layered.notes), "partial": layered.notes.partial}
    yield {"count": len(found), "full": full, "durations": durations, **said}, None
    for layer in found:
        names = [each[:_LONGEST_NAME] for each in (*layer.groups[:_DEEPEST], layer.name)]
        place = {name: getattr(layer, name) for name in ("left", "top", "number", "frame", "opacity")}
        base = -1 if layer.base is None else layer.base.number
        yield {**_with_form(layer.image), **place, "names": names, "base": base}, layer.image


def tileset(content: bytes, least: int, most: int) -> Message:
    """Return the tiles of an Aseprite file, one below the other, with the size of one.

    Raises:
        RefusedError: if it has none, or it cannot be decoded.
    """
    try:
        layered = _layered(content, least, most)
        if layered is None:
            raise RefusedError("has no tileset of its own; give the size of a tile, such as 16x16")
        with _unreadable_refused():
            image, size = layered.tileset()
    except (RefusedError, MemoryError):
        raise
    except Exception as error:  # as in `decode`
        raise RefusedError(f"has a tileset that cannot be read: {_brief(error)}") from None
    _check_sides(image.width, image.height, least, most)
    return {**_with_form(image), "tile": [*size]}, image


def _check_parts(count: int, pixels: int, name: str) -> None:
    if not 0 < count <= MOST_PARTS or pixels > MOST_PIXELS:
        raise RefusedError(
            f"has {count} {name} of {pixels} pixels together; {MOST_PARTS} of {MOST_PIXELS} can be predicted"
        )


def loses_levels(content: bytes) -> bool:
    r"""Return whether Pillow may round the levels of a picture: a colour PNG of 16 bits a channel, or a TIFF.

    >>> loses_levels(b"II*\0 and so on"), loses_levels(b"\xff\xd8\xff a JPEG")
    (True, False)
    """
    if content.startswith(b"\x89PNG"):
        return content[24:25] == b"\x10" and content[25:26] in {b"\x02", b"\x06"}
    return _is_tiff(content)


def _is_tiff(content: bytes) -> bool:
    found = format_of(content[:64])
    return found is not None and found.name == "TIFF"


def exact_levels(content: bytes, least: int, most: int) -> Any:
    """Return the pixels of such a picture as an array (h, w) or (h, w, 3 or 4): red, green, blue, opacity.

    Raises:
        RefusedError: if it cannot be decoded.
    """
    import cv2  # late: few pictures need it
    import numpy as np

    try:
        levels = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise RefusedError(f"cannot be read as an image: {_brief(error)}") from None
    if levels is None:
        raise RefusedError(
            "cannot be read as an image: it is damaged, or of a kind that is not known; save it as PNG"
        )
    if levels.dtype in {np.dtype(np.float64), np.dtype(np.float16)}:
        levels = levels.astype(np.float32)
    _check_sides(levels.shape[1], levels.shape[0], least, most)
    if levels.ndim == 3:
        levels = levels[..., [2, 1, 0, 3][: levels.shape[2]]]
    if levels.dtype.name not in DTYPES or levels.shape[2:] not in {(), (3,), (4,)}:
        raise RefusedError(f"holds {levels.dtype.name}; levels are of 8 or 16 bits, or floats of 32")
    return np.ascontiguousarray(levels)


def float_white(most: float) -> float:
    """Return the value of white in a picture of floats, whose range no standard fixes.

    Args:
        most: its largest value. Up to 16 white is 1, as in HDR pictures; above, it is that of 8 or 16 bits.
    """
    return 1.0 if most <= 16 else 255.0 if most <= 255 else 65535.0


def viewed(levels: Any, longest: int, grey: bool) -> Any:
    """Return levels (h, w) or (h, w, C), reduced and grey on white as `decode` does it."""
    import cv2
    import numpy as np

    if longest and max(levels.shape[:2]) > longest:
        scale = longest / max(levels.shape[:2])
        size = (max(round(levels.shape[1] * scale), 1), max(round(levels.shape[0] * scale), 1))
        levels = cv2.resize(levels, size, interpolation=cv2.INTER_AREA)
    if not grey or levels.ndim == 2:
        return np.ascontiguousarray(levels)
    floats = levels.dtype == np.float32
    top = float_white(float(np.nan_to_num(levels).max())) if floats else float(np.iinfo(levels.dtype).max)
    brightness = levels[..., :3].astype(np.float32) @ np.array([0.299, 0.587, 0.114], np.float32)
    if levels.shape[2] == 4:
        opacity = levels[..., 3].astype(np.float32) / top
        brightness = brightness * opacity + top * (1 - opacity)
    return np.ascontiguousarray(brightness.astype(levels.dtype))


def decode(
    content: bytes,
    least: int,
    most: int,
    svg_side: int,
    longest: int,
    grey: bool,
    notes: list[Any] | None = None,
) -> "tuple[Image, tuple[int, int]]":
    """Return a picture upright, in one of `MODES`, and the (width, height) that it had before it was reduced.

    Args:
        content: its file.
        least: pixels that either side must have.
        most: pixels that neither side may exceed; it is held to before any pixel is decoded.
        svg_side: longer side in pixels that an SVG is drawn with.
        longest: longer side in pixels that a larger one is reduced to; 0 leaves it.
        grey: whether to return only how bright it is on white paper.
        notes: takes what is to be said of the picture.

    Raises:
        RefusedError: if it cannot be decoded.
    """
    from PIL import UnidentifiedImageError

    if is_svg(content):
        content = draw_svg(content, svg_side, most)
    try:
        if (layered := _layered(content, least, most)) is not None:
            with _unreadable_refused():
                upright = layered.composite()
            if notes is not None and str(layered.notes):
                notes.append(layered.notes)
            _check_sides(upright.width, upright.height, least, most)
            upright.load()
        else:
            try:
                image = _opened(content)
            except DamagedError:
                if _is_tiff(content):
                    raise UnknownTiffError from None
                raise
            with image:
                _check_sides(image.width, image.height, least, most)
                image.load()
                upright = turned_upright(image)
            del image
        upright, full = plain(upright), upright.size
        if longest and max(full) > longest:
            upright = reduced(upright, longest)
        return _grey(upright) if grey else upright, full
    except (RefusedError, UnknownTiffError, MemoryError):
        raise
    except UnidentifiedImageError:
        _refuse_foreign(content)
        raise RefusedError(f"is not an image that can be read; give one of {_KNOWN}") from None
    except Exception as error:  # a decoder of Pillow that trips over damage raises anything
        raise RefusedError(f"cannot be read as an image: {_brief(error)}") from None


def turned_upright(image: "Image") -> "Image":
    """Return an image turned as its camera says; as it lies, if what the camera wrote is damaged."""
    from PIL import ImageOps

    try:
        return ImageOps.exif_transpose(image)
    except MemoryError:
        raise
    except Exception:  # notes about a picture, which is sound without them
        return image


def _layered(content: bytes, least: int, most: int) -> Any:
    """Return a layered file of a paint program, of which nothing is decoded yet; None of any other file.

    Raises:
        RefusedError: if it cannot be read, or is of no possible size.
    """
    if not content.startswith((b"8BPS", b"PK\x03\x04")) and content[4:6] != b"\xe0\xa5":
        return None
    with _unreadable_refused():
        return _layered_files().open_layered(
            content, lambda width, height: _check_sides(width, height, least, most)
        )


def _layered_frames(layered: Any) -> Iterator[Message]:
    width, height = layered.size
    count = len(layered.durations)
    _check_parts(count, count * width * height, "frames")
    with _unreadable_refused():
        found = layered.frames()
        first = next(found)
        said = {"note": _told(layered.notes), "partial": layered.notes.partial}
        yield {"count": count, "loop": 0, **said}, None
        for image, milliseconds in itertools.chain([first], found):
            yield {**_with_form(image), "duration": milliseconds}, image


def _layered_files() -> Any:
    # By its own name in the child: the package is not on this program's path.
    return import_module("normalgan.decoding.layered_files" if __package__ else "layered_files")


@contextmanager
def _unreadable_refused() -> Iterator[None]:
    """Refuse a layered file whose reader says that it cannot be read."""
    try:
        yield
    except _layered_files().UnreadableError as error:
        raise RefusedError(str(error)) from None


def _refuse_foreign(content: bytes) -> None:
    """Raise `RefusedError` if a file is of a paint program whose files cannot be read."""
    told = _layered_files().foreign(content)
    if told is not None:
        raise RefusedError(told)


def _opened(content: bytes) -> "Image":
    """Return a picture whose pixels are not decoded yet.

    Raises:
        UnidentifiedImageError: if it begins as no format that Pillow decodes.
        OSError: if it begins as one, and is damaged.
    """
    from PIL import Image, UnidentifiedImageError

    Image.MAX_IMAGE_PIXELS = None  # ours are lower
    found = format_of(content[:64])
    if found is None or found.plugin is None:
        raise UnidentifiedImageError
    try:
        _import_plugin(found.plugin)
    except ImportError:
        raise RefusedError(
            f"is a {found.name}; run `pip install 'normalgan[{found.name.lower()}]'` to read it, or save it "
            "as PNG or JPEG"
        ) from None
    try:
        return Image.open(io.BytesIO(content), formats=(found.plugin,))
    except UnidentifiedImageError:
        raise DamagedError(f"it begins as a {found.name} and is cut short or damaged") from None


def _import_plugin(plugin: str) -> None:
    """Import what decodes a format; Pillow brings all but one.

    Raises:
        ImportError: if it is not installed.
    """
    if plugin == "HEIF":
        import_module("pillow_heif").register_heif_opener(thumbnails=False)
        return
    module = {"WEBP": "WebP"}.get(plugin, plugin.capitalize())
    found = import_module(f"PIL.{module}ImagePlugin")
    if not getattr(found, "SUPPORTED", True):
        raise ImportError


def _check_sides(width: int, height: int, least: int, most: int) -> None:
    if not (least <= width <= most and least <= height <= most):
        raise RefusedError(f"is {width} × {height} pixels; a drawing has {least} to {most} a side")


def plain(image: "Image") -> "Image":
    """Return an image of any mode in one of `MODES`."""
    if image.mode.startswith("I"):
        return _deep(image)
    if image.mode in {"RGBA", "LA", "PA", "RGBa", "La"} or "transparency" in image.info:
        if image.mode == "La":
            image = image.convert("LA")
        clear = image.info.get("transparency")
        if isinstance(clear, tuple) and max(clear) > 255:  # of 16 bits, of which Pillow keeps 8
            image.info["transparency"] = tuple(each >> 8 for each in clear)
        return image.convert("RGBA")
    if image.mode in {"1", "L"}:
        return image.convert("L")
    return image if image.mode == "F" else image.convert("RGB")


_TOPS = (255, 1023, 4095, 16383, 65535, 2**24 - 1, 2**31 - 1)
"""White of greys of 8, 10, 12, 14, 16, 24 and 31 bits, which programs store in 16 or 32."""


def _deep(image: "Image") -> "Image":
    """Return a grey image of 16 or 32 bits with white at 65535.

    One that has no level in the upper three quarters of its bits has fewer of them than its file. If one of
    its greys is transparent, it comes with opacity and 8 bits.
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
    """Return an image with each pixel the mean of those it takes the place of."""
    from PIL import Image

    scale = longest / max(image.size)
    size = (max(round(image.width * scale), 1), max(round(image.height * scale), 1))
    if image.mode == "RGBA":  # colours of pixels that nobody sees must not bleed into those that are seen
        return image.convert("RGBa").resize(size, Image.Resampling.BOX).convert("RGBA")
    if image.mode == "I;16":
        image = image.convert("I")
    return image.resize(size, Image.Resampling.BOX)


def _grey(image: "Image") -> "Image":
    """Return how bright an image of one of `MODES` is on white paper."""
    from PIL import Image

    if image.mode == "RGBA":
        image = Image.alpha_composite(Image.new("RGBA", image.size, "white"), image).convert("RGB")
    return image.convert("L") if image.mode == "RGB" else image


def is_svg(content: bytes) -> bool:
    r"""Return whether a file is XML with an SVG in it; a picture whose notes hold one is none.

    >>> is_svg(b'<?xml version="1.0"?><!-- long --><svg/>'), is_svg(b"\x89PNG... <svg")
    (True, False)
    """
    start = content[:64].removeprefix(b"\xef\xbb\xbf").lstrip()
    if content[:2] in {b"\xff\xfe", b"\xfe\xff"}:
        return "<" in content[2:64].decode("utf-16-le" if content[:1] == b"\xff" else "utf-16-be", "replace")
    return start.startswith(b"<")


def draw_svg(content: bytes, side: int, most: int) -> bytes:
    """Return an SVG as PNG, transparent where it has nothing.

    Args:
        content: the file.
        side: longer side in pixels that it is drawn with.
        most: pixels that no side of a picture within it may exceed.

    Raises:
        RefusedError: if it cannot be drawn, or would draw another file.
    """
    from PIL import Image
    from resvg_py import svg_to_bytes

    text = sanitize_svg(content, most)
    try:
        # Without fonts: what is drawn must not depend on those that a machine has.
        # Within a square: with a width alone, one that is very high would end the process for want of memory.
        small = bytes(svg_to_bytes(svg_string=text, width=64, height=64, dpi=_DPI, skip_system_fonts=True))
        with Image.open(io.BytesIO(small), formats=("PNG",)) as image:
            wide = image.height <= image.width
        width, height = (side, None) if wide else (None, side)
        return bytes(
            svg_to_bytes(svg_string=text, width=width, height=height, dpi=_DPI, skip_system_fonts=True)
        )
    except ValueError as error:
        raise RefusedError(f"cannot be drawn as SVG: {_brief(error)}") from None
    except BaseException as error:  # a panic of Rust comes as one that is no Exception
        if isinstance(error, MemoryError):
            raise
        raise RefusedError(f"cannot be drawn as SVG: {_brief(error)}") from None


def sanitize_svg(content: bytes, most: int) -> str:
    """Return an SVG written anew, with its entities expanded and nothing in it that leads out of it.

    It is written anew, not only looked at: what another parser would make of the same bytes does not matter.

    Args:
        content: the file, in any encoding that XML knows.
        most: pixels that no side of a picture within it may exceed.

    Raises:
        RefusedError: if it is no XML, nested too deeply, too long, or would draw another file.
    """
    parser = ParserCreate()
    parser.buffer_text = True
    written: list[str] = []
    depth = length = 0

    def write(text: str) -> None:
        nonlocal length
        length += len(text)
        if length > MOST_TEXT:
            raise RefusedError(f"stands for more than {MOST_TEXT} characters of SVG")
        written.append(text)

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MOST_DEPTH:
            raise RefusedError(f"is nested more than {MOST_DEPTH} deep; a drawing is not")
        if depth == 1 and _local(name) != "svg":
            raise RefusedError(f"is not an image that can be read; give one of {_KNOWN}")
        kept = "".join(
            f' {key}="{_escaped(value)}"' for key, value in _allowed(_local(name), attributes, most)
        )
        write(f"<{name}{kept}>")

    def end(name: str) -> None:
        nonlocal depth
        depth -= 1
        write(f"</{name}>")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = lambda data: write(_escaped(data))
    try:
        parser.Parse(content, True)
    except ExpatError as error:
        told = f"cannot be drawn as SVG: line {error.lineno}: {ErrorString(error.code)}"
        raise RefusedError(told) from None
    except (ValueError, LookupError) as error:  # an encoding that is none
        raise RefusedError(f"cannot be drawn as SVG: {_brief(error)}") from None
    return "".join(written)


def _allowed(name: str, attributes: dict[str, str], most: int) -> Iterator[tuple[str, str]]:
    """Yield an element's attributes, without links to elsewhere.

    Raises:
        RefusedError: if it would draw what a link leads to.
    """
    for key, value in attributes.items():
        if _local(key) == "href":
            link = value.strip()
            if name in {"image", "feImage"} and not link.startswith("#"):
                _check_embedded(link, most)
            elif not link.startswith("#"):
                continue  # of a text that can be clicked, or of a part of another file
        yield key, value


def _check_embedded(link: str, most: int) -> None:
    """Raise `RefusedError` if a picture in an SVG lies elsewhere, or is larger than a drawing may be."""
    start = _EMBEDDED.match(link)
    if start is None:
        shown = link if len(link) <= 60 else f"{link[:57]}…"
        raise RefusedError(
            f"draws {shown!r}, and no file but itself is read; embed that picture as PNG, JPEG, GIF or WebP"
        )
    try:
        # As the drawing library does: without what is no base64.
        data = base64.b64decode(re.sub(r"\s+", "", link[start.end() :]) + "===", validate=False)
        with _opened(data) as image:
            size = image.size
    except (OSError, SyntaxError, ValueError, binascii.Error) as error:
        raise RefusedError(f"has a picture in it that cannot be read: {_brief(error)}") from None
    if max(size) > most:
        raise RefusedError(f"has a picture of {size[0]} × {size[1]} pixels in it; {most} a side are read")


def _local(name: str) -> str:
    """Return an XML name without its prefix."""
    return name.rpartition(":")[2]


def _escaped(text: str) -> str:
    if "&" in text or "<" in text or ">" in text or '"' in text:
        text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")
    return text.replace("\n", "&#10;").replace("\t", "&#9;").replace("\r", "&#13;")


def _brief(error: BaseException) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2], int(sys.argv[3]), int(sys.argv[4]), sys.argv[5:])
