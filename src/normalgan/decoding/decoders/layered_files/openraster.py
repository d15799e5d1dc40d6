"""OpenRaster, the exchange format of Krita, GIMP and MyPaint: https://www.openraster.org/."""

from collections.abc import Iterator
from typing import Any

from ..opening import RefusedError
from .base import Layer
from .zips import LayeredZip, member_of, png_of, xml_of


class OpenRasterFile(LayeredZip):
    """An OpenRaster file."""

    def _described_size(self) -> tuple[str, str]:
        about = xml_of(self.zip, "stack.xml")
        return about.get("w", ""), about.get("h", "")

    def _read_layers(self) -> Iterator[Layer]:
        yield from self._stack(xml_of(self.zip, "stack.xml").find("stack"), (), 1.0)

    def _stack(self, stack: Any, path: tuple[str, ...], opacity: float) -> Iterator[Layer]:
        """Yield the layers of a stack; see https://www.openraster.org/baseline/layer-stack-spec.html."""
        for each in reversed(stack if stack is not None else ()):
            name = each.get("name", "")
            if each.get("visibility") == "hidden":
                continue
            mode = each.get("composite-op", "svg:src-over").rpartition(":")[2]
            if mode == "src-atop":
                self.notes.add(name, "clipping left out")
            elif mode != "src-over":
                self.notes.add_blend(name, mode)
            try:
                own = opacity * min(max(float(each.get("opacity", "1")), 0.0), 1.0)
                left, top = int(each.get("x", "0")), int(each.get("y", "0"))
                image = png_of(member_of(self.zip, each.get("src", ""))) if each.tag == "layer" else None
                if image is not None:
                    image.load()
            except (ValueError, OSError, SyntaxError, RefusedError) as error:
                self.notes.leave_out(name, f"cannot be read: {error}; left out", "damaged")
                continue
            if each.tag == "stack":
                yield from self._stack(each, (*path, name), own)
            elif image is not None:
                yield Layer(name, path, round(255 * own), left, top, image)
