"""ZIP files of paint programs: the common parts of OpenRaster and Krita files."""

import io
import zipfile
import zlib
from abc import abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..opening import RefusedError
from .base import LayeredFile, flattened

if TYPE_CHECKING:
    from PIL.Image import Image

MERGED = "mergedimage.png"
"""Name of the merged picture."""
_MOST_MEMBER = 2**29
"""Maximum size of a file in a ZIP, in bytes."""


class LayeredZip(LayeredFile):
    """A ZIP with an XML file that describes its layers, and usually the merged picture."""

    def composite(self) -> "Image":
        """Return the merged picture that the program saved, or else the composite of the layers."""
        if MERGED not in self.zip.namelist():  # MyPaint does not save it
            return flattened(self.size, self._read_layers())
        return png_of(member_of(self.zip, MERGED))

    @cached_property
    def zip(self) -> zipfile.ZipFile:
        """The open ZIP."""
        return open_zip(self.content)

    def _read_size(self) -> tuple[int, int]:
        if MERGED in self.zip.namelist():
            return png_of(member_of(self.zip, MERGED)).size
        width, height = self._described_size()
        try:
            return int(width), int(height)
        except ValueError:
            raise RefusedError("does not give its size") from None

    @abstractmethod
    def _described_size(self) -> tuple[str, str]:
        """Return width and height from the XML, empty if missing."""


def open_zip(content: bytes) -> zipfile.ZipFile:
    """Open a ZIP."""
    try:
        return zipfile.ZipFile(io.BytesIO(content))
    except (zipfile.BadZipFile, ValueError) as error:
        raise RefusedError(f"is a broken ZIP: {error}") from None


def member_of(file: zipfile.ZipFile, name: str) -> bytes:
    """Return the content of a file in a ZIP; raise `RefusedError` if it is missing, broken or too large."""
    try:
        about = file.getinfo(_stored_name(file, name))
        if about.file_size > _MOST_MEMBER:
            raise RefusedError(f"has more than {_MOST_MEMBER} bytes in its {name}")
        with file.open(about) as member:
            return member.read(_MOST_MEMBER)
    except KeyError:
        raise RefusedError(f"is a ZIP without {name}; OpenRaster and Krita files have one") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise RefusedError(f"is broken: {error}") from None


def _stored_name(file: zipfile.ZipFile, name: str) -> str:
    """Return a name as stored in the ZIP: without the Unicode flag, Python decodes UTF-8 as cp437."""
    if name in file.NameToInfo:
        return name
    return name.encode("utf-8", "replace").decode("cp437")


def png_of(data: bytes) -> "Image":
    """Open a PNG without decoding its pixels."""
    from PIL import Image

    return Image.open(io.BytesIO(data), formats=("PNG",))


def xml_of(file: zipfile.ZipFile, name: str) -> Any:
    """Return the root of an XML file in a ZIP, with namespaces removed from tags."""
    from xml.etree import ElementTree as Tree

    try:
        root = Tree.fromstring(member_of(file, name))
    except Tree.ParseError as error:
        raise RefusedError(f"has a broken {name}: {error}") from None
    for each in root.iter():
        each.tag = each.tag.rpartition("}")[2]
    return root
