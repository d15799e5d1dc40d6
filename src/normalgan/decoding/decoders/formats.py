"""Picture formats: the table of all formats that a drawing may have.

It imports nothing of the package, because the child process (`worker.py`) runs without it.
"""

from typing import NamedTuple

__all__ = ["ENDINGS", "FORMATS", "LAYERED", "MOVING", "NO_PAGE", "SUBFILE", "Format", "format_of"]


class Format(NamedTuple):
    """A picture format.

    Args:
        name: for messages.
        endings: endings of its files.
        starts: magic bytes, any of them.
        plugin: Pillow's name of it; None if Pillow does not decode it.
        modules: modules that decode it, imported before the child process may open no more files. The first
            is that of Pillow's plug-in.
        library: library that is imported only for such files, because it takes long; empty if there is none.
        moves: whether a file may hold several pictures, which are all read.
        layered: whether a file may hold layers.
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
"""The formats, in the order in which endings are listed.

Pillow has forty more, one of which starts Ghostscript.
"""
ENDINGS = tuple(ending for each in FORMATS for ending in each.endings)
"""Endings of the names of drawings, in lower case."""
MOVING = tuple(ending for each in FORMATS if each.moves for ending in each.endings)
"""Endings of the formats in which a file may hold several pictures."""
LAYERED = tuple(ending for each in FORMATS if each.layered for ending in each.endings)
"""Endings of the files of paint programs, beside which there often lies a picture that was exported."""
SUBFILE, NO_PAGE = 254, 1 | 4
"""A tag of TIFF that says what a picture of it is, and its bits for a small copy and for a mask."""
_NAMED = {each.name: each for each in FORMATS}
_AVIF = {b"avif", b"avis"}
_HEIC = {b"heic", b"heix", b"hevc", b"hevx", b"heim", b"heis", b"mif1", b"msf1"}
"""Brands of the two formats that are boxes of ISO/IEC 14496-12."""


def format_of(start: bytes) -> Format | None:
    r"""Return the format of a file by its first 64 bytes; None for SVG and unknown formats.

    >>> format_of(b"\x89PNG...").name, format_of(b"\0\0\0\x18ftypmif1\0\0\0\0avif")
    ('PNG', Format(name='AVIF', endings=('.avif',), starts=(), plugin='AVIF', moves=True, layered=False))
    """
    if start[4:6] == b"\xe0\xa5" and len(start) >= 64:
        return _NAMED["Aseprite"]
    if start[4:8] == b"ftyp":
        length = min(int.from_bytes(start[:4], "big"), len(start))
        brands = {start[at : at + 4] for at in (8, *range(16, length, 4))}
        return _NAMED["AVIF"] if brands & _AVIF else _NAMED["HEIC"] if brands & _HEIC else None
    return next((each for each in FORMATS if each.starts and start.startswith(each.starts)), None)
