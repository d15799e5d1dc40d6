"""Layered files of paint programs, decoded in the child process: one module per format."""

from collections.abc import Callable

from ..opening import RefusedError
from .aseprite import AsepriteFile
from .base import Layer, LayeredFile, Notes
from .krita import KritaFile
from .openraster import OpenRasterFile
from .psd import PsdFile
from .zips import MERGED, open_zip

__all__ = ["Layer", "LayeredFile", "Notes", "foreign", "open_layered"]

_FOREIGN = {
    b"CSFCHUNK": ("a Clip Studio Paint file", "save it as PSD: File > Save Duplicate > .psd"),
    b"GCPF": ("a Pixelorama project", "export it from Pixelorama as PNG, GIF or APNG"),
    b"gimp xcf": ("a GIMP file", "export it from GIMP as PSD or ORA"),
    b"SAI-CANVAS": ("a PaintTool SAI file", "export it from SAI as PSD"),
    b"mdipack": ("a MediBang file", "export it from MediBang as PSD"),
    b"PDN3": ("a Paint.NET file", "save it from Paint.NET as PNG"),
    b"\0\xffKA": ("an Affinity file", "export it from Affinity as PSD"),
}
"""Descriptions of other paint programs' files and how to convert them, by first bytes."""
_FOREIGN_ZIPS = {
    "data.json": ("a Pixelorama project", "export it from Pixelorama as PNG, GIF or APNG"),
    "Document.archive": ("a Procreate file", "share it from Procreate as PSD"),
}
"""The same for ZIP files, by the name of a file in them."""


def foreign(content: bytes) -> str | None:
    """Return the description of an unsupported paint program's file and how to convert it, or None.

    >>> foreign(b"gimp xcf v011")
    'is a GIMP file, which cannot be read; export it from GIMP as PSD or ORA'
    """
    found = next((words for start, words in _FOREIGN.items() if content.startswith(start)), None)
    return None if found is None else f"is {found[0]}, which cannot be read; {found[1]}"


def open_layered(kind: str, content: bytes, check_size: Callable[[int, int], None]) -> LayeredFile:
    """Open a layered file without decoding its pictures; ``kind`` is the name of its format.

    Raises:
        RefusedError: if the file is broken, or from an unknown version or an unsupported program.
    """
    match kind:
        case "PSD":
            return PsdFile(content, check_size)
        case "Aseprite":
            return AsepriteFile(content, check_size)
    return _zip_format(content)(content, check_size)


def _zip_format(content: bytes) -> type[KritaFile] | type[OpenRasterFile]:
    with open_zip(content) as file:
        names = file.namelist()
    if "maindoc.xml" in names:
        return KritaFile
    if "stack.xml" in names or MERGED in names:
        return OpenRasterFile
    for name, (what, way_out) in _FOREIGN_ZIPS.items():
        if name in names:
            raise RefusedError(f"is {what}, which cannot be read; {way_out}")
    raise RefusedError(f"is a ZIP without {MERGED}; OpenRaster and Krita files have one")
