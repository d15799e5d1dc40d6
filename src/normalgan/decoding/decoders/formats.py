"""Picture formats: the table of all supported formats of drawings.

It imports nothing else of normalgan, because the child process (`worker.py`) runs without the package.
"""

from typing import NamedTuple


class Format(NamedTuple):
    """A picture format.

    To add one that Pillow decodes, add an entry to `FORMATS`, from which files, folders, the studio's dialog
    and the decoding process read it, then run ``tests/decoding/test_formats.py``: it names the add-on and the
    page of the docs that list the formats. A paint program's format also has a class in ``layered_files``.

    Args:
        name: name of the format in messages.
        endings: file extensions.
        starts: possible magic bytes.
        plugin: Pillow's name of the format; None if Pillow does not decode it.
        modules: modules that decode the format, Pillow's plug-in first. The child process imports them before
            its limits are set.
        library: library that is slow to import, so that it is imported only for this format; or empty.
        moves: whether a file may contain several pictures, which are all read.
        layered: whether a file may contain layers.
    """

    name: str
    endings: tuple[str, ...]
    starts: tuple[bytes, ...]
    plugin: str | None = None
    modules: tuple[str, ...] = ()
    library: str = ""
    moves: bool = False
    layered: bool = False


_TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_PSD = ("psd_tools.composite", "PIL.ImageCms", "scipy.interpolate", "scipy.ndimage", "scipy.spatial")
_MPO = "PIL.MpoImagePlugin"  # Pillow opens a JPEG that holds several pictures, as phones write them, with it
FORMATS = (
    Format("PNG", (".png", ".apng"), (b"\x89PNG",), "PNG", ("PIL.PngImagePlugin",), moves=True),
    Format("JPEG", (".jpg", ".jpeg"), (b"\xff\xd8\xff",), "JPEG", ("PIL.JpegImagePlugin", _MPO)),
    Format("WebP", (".webp",), (b"RIFF",), "WEBP", ("PIL.WebPImagePlugin",), moves=True),
    Format("BMP", (".bmp",), (b"BM",), "BMP", ("PIL.BmpImagePlugin",)),
    Format("TIFF", (".tif", ".tiff"), _TIFF, "TIFF", ("PIL.TiffImagePlugin",), "cv2", moves=True),
    Format("GIF", (".gif",), (b"GIF8",), "GIF", ("PIL.GifImagePlugin",), moves=True),
    Format("SVG", (".svg",), (), None, ("resvg_py", "xml.etree.ElementTree")),
    Format("AVIF", (".avif",), (), "AVIF", ("PIL.AvifImagePlugin",), moves=True),
    Format("HEIC", (".heic", ".heif"), (), "HEIF", ("pillow_heif",), "pillow_heif"),
    Format("PSD", (".psd",), (b"8BPS",), None, _PSD, "psd_tools", layered=True),
    Format("Krita", (".kra",), (b"PK\x03\x04",), layered=True),
    Format("OpenRaster", (".ora",), (b"PK\x03\x04",), layered=True),
    Format("Aseprite", (".ase", ".aseprite"), (), moves=True, layered=True),
)
"""The formats, in the order of listed extensions.

Pillow supports forty others, one of which runs Ghostscript.
"""
ENDINGS = tuple(ending for each in FORMATS for ending in each.endings)
"""File extensions of drawings, in lower case."""
MOVING = tuple(ending for each in FORMATS if each.moves for ending in each.endings)
"""Extensions of formats that may contain several pictures."""
LAYERED = tuple(ending for each in FORMATS if each.layered for ending in each.endings)
"""Extensions of paint programs' files, which often have an exported picture next to them."""
SUBFILE, NO_PAGE = 254, 1 | 4
"""TIFF tag for the type of a picture, and its bits for a thumbnail and for a mask."""
_NAMED = {each.name: each for each in FORMATS}
_AVIF = {b"avif", b"avis"}
_HEIC = {b"heic", b"heix", b"hevc", b"hevx", b"heim", b"heis", b"mif1", b"msf1"}
"""Brands of the two formats based on ISO/IEC 14496-12 boxes."""


def detect_format(start: bytes) -> Format | None:
    r"""Return the format of a file, given its first 64 bytes; None for SVG and unknown formats.

    >>> detect_format(b"\x89PNG...").name, detect_format(b"\0\0\0\x18ftypmif1\0\0\0\0avif").endings
    ('PNG', ('.avif',))
    """
    if start[4:6] == b"\xe0\xa5" and len(start) >= 64:
        return _NAMED["Aseprite"]
    if start[4:8] == b"ftyp":
        length = min(int.from_bytes(start[:4], "big"), len(start))
        brands = {start[at : at + 4] for at in (8, *range(16, length, 4))}
        return _NAMED["AVIF"] if brands & _AVIF else _NAMED["HEIC"] if brands & _HEIC else None
    return next((each for each in FORMATS if each.starts and start.startswith(each.starts)), None)
