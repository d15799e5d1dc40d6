"""Photoshop files (PSD and PSB), read by psd-tools."""

import io
import struct
from collections.abc import Iterator
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from ..opening import RefusedError
from .base import Layer, LayeredFile, Notes

if TYPE_CHECKING:
    from PIL.Image import Image

_DRAWN_EFFECTS = {"stroke", "coloroverlay", "gradientoverlay", "patternoverlay"}
"""Photoshop effects that psd-tools draws, by class name."""
_STROKE = 250
"""Maximum extent in pixels of a Photoshop stroke beyond its layer."""


class PsdFile(LayeredFile):
    """A PSD or PSB file."""

    def composite(self) -> "Image":
        """Return the merged picture that Photoshop saved, or else the composite by psd-tools."""
        found = self._psd.topil() if self._psd.has_preview() else self._psd.composite()
        if found is None:
            raise RefusedError("holds no picture")
        image: Image = found
        return image

    def _read_size(self) -> tuple[int, int]:
        version, height, width = struct.unpack(">4xH8xII", self.content[:22].ljust(22, b"\0"))
        if version not in {1, 2}:
            raise RefusedError(f"is a PSD of version {version}; 1 and 2 can be read")
        return width, height

    def _read_layers(self) -> Iterator[Layer]:
        if self._psd.color_mode.name not in {"RGB", "GRAYSCALE"}:
            raise RefusedError(
                f"has its colours in {self._psd.color_mode.name}; layers in RGB or greyscale can be predicted"
            )
        yield from _group(self._psd, self._psd, (), 255, self.notes)

    @cached_property
    def _psd(self) -> Any:
        from psd_tools import PSDImage

        return PSDImage.open(io.BytesIO(self.content))


def _group(psd: Any, group: Any, chain: tuple[Any, ...], opacity: int, notes: Notes) -> Iterator[Layer]:
    """Yield the layers of a group; ``chain`` holds the surrounding groups, outermost first, and the group."""
    base: Layer | None = None
    hidden = False
    for layer in group:
        clipped = bool(layer.clipping)
        if not clipped:
            base, hidden = None, not layer.visible
        if not layer.visible or (clipped and hidden):  # layers clipped to a hidden base are hidden too
            continue
        own = opacity * layer.opacity // 255
        if layer.blend_mode.name not in {"NORMAL", "PASS_THROUGH"}:
            notes.add_blend(layer.name, layer.blend_mode.name)
        if layer.is_group():
            _drawn_effects(layer, notes)
            if clipped:
                notes.add(layer.name, "clipping of a group left out")
            yield from _group(psd, layer, (*chain, layer), own, notes)
            continue
        found = _layer(psd, layer, chain, own, notes)
        if found is None:
            continue
        if clipped:
            if base is None:
                notes.add(layer.name, "clipping to a group left out")
            else:
                found.base = base
                _cut(found, base)
        else:
            base = found
        yield found


def _layer(psd: Any, layer: Any, chain: tuple[Any, ...], opacity: int, notes: Notes) -> Layer | None:
    """Return a layer of a PSD as composited by psd-tools, or None for an empty layer."""
    from psd_tools.constants import Tag

    effects = _drawn_effects(layer, notes)
    fills = layer.kind == "shape" or layer.kind.endswith("fill")
    if not fills and not layer.has_pixels():
        _note_left_out(layer, notes)
        return None
    if not effects:  # psd-tools applies the opacity to the layer but not to its effects
        opacity = opacity * layer.tagged_blocks.get_data(Tag.BLEND_FILL_OPACITY, 255) // 255
    found = partial(Layer, layer.name, tuple(each.name for each in chain), opacity)
    masked = any(_has_mask(each) for each in (*chain, layer))
    if not (fills or effects or masked):
        return found(layer.left, layer.top, layer.topil().convert("RGBA"))
    left, top, right, bottom = _box(psd, layer, _STROKE if "stroke" in effects else 0)
    if right <= left or bottom <= top:
        return None
    try:
        return found(left, top, _alone(psd, layer, chain, (left, top, right, bottom)))
    except ImportError:  # psd-tools needs an additional library to draw the outline of a shape
        notes.add(layer.name, "outline of a shape left out; rasterize it")
        image = layer.topil() if layer.has_pixels() else None
        return None if image is None else found(layer.left, layer.top, image)
    except MemoryError:
        raise
    except Exception as error:  # a library may raise anything on damaged data
        notes.leave_out(layer.name, f"cannot be read: {error}; left out", "damaged")
        return None


def _note_left_out(layer: Any, notes: Notes) -> None:
    """Add a note on a layer that has neither pixels nor a fill, unless it is merely empty."""
    if layer.kind in {"type", "smartobject"}:
        noun = "text" if layer.kind == "type" else "smart object"
        notes.leave_out(layer.name, f"{noun} without pixels left out; rasterize it", "no_pixels")
    elif layer.kind != "pixel":
        notes.add(layer.name, f"adjustment layer ({layer.kind}) left out")


def _box(psd: Any, layer: Any, reach: int) -> tuple[int, int, int, int]:
    """Return the part of the picture that a layer covers: left, top, right and bottom in pixels.

    A fill without pixels covers the whole picture, and effects up to ``reach`` pixels around the layer.
    """
    if not layer.has_pixels():
        return 0, 0, psd.width, psd.height
    return (
        max(layer.left - reach, 0),
        max(layer.top - reach, 0),
        min(layer.right + reach, psd.width),
        min(layer.bottom + reach, psd.height),
    )


def _alone(psd: Any, layer: Any, chain: tuple[Any, ...], box: tuple[int, int, int, int]) -> "Image":
    """Return a layer as RGBA with its effects and with its own and its groups' masks, but without opacity."""
    import numpy as np
    from PIL import Image
    from psd_tools.composite import composite as render

    shown = {id(each) for each in (*chain, layer)}
    layer.clipping = False  # otherwise psd-tools draws it only together with its base
    # A vector mask is ignored if there is also a mask rendered from it, and otherwise drawn only if
    # forced.
    forced = layer.kind == "pixel" and layer.vector_mask is not None and layer.mask is None
    color, shape, _ = render(psd, 0.0, 0.0, box, lambda each: id(each) in shown and each.visible, forced)
    color = np.repeat(color, 3, -1) if color.shape[-1] == 1 else color
    levels = np.clip(np.rint(255 * np.dstack([color[..., :3], shape])), 0, 255)
    return Image.fromarray(levels.astype(np.uint8))


def _drawn_effects(layer: Any, notes: Notes) -> set[str]:
    """Return the effects of a layer that psd-tools draws, and add notes on the others."""
    if not layer.has_effects() or not layer.effects.enabled:
        return set()
    found = {type(each).__name__: each for each in layer.effects if each.enabled}
    for name in found:
        if name.lower() not in _DRAWN_EFFECTS:
            words = "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name).strip()
            notes.add(layer.name, f"{words} left out")
    return {name.lower() for name in found} & _DRAWN_EFFECTS


def _has_mask(layer: Any) -> bool:
    mask, path = layer.mask, layer.vector_mask
    return (
        (mask is not None and not mask.disabled)
        or (path is not None and not path.disabled)
        or layer.kind == "artboard"
    )


def _cut(layer: Layer, base: Layer) -> None:
    """Multiply a layer's opacity by that of the layer it is clipped to."""
    from PIL import Image, ImageChops

    whole = Image.new("L", layer.image.size)
    whole.paste(base.image.getchannel("A"), (base.left - layer.left, base.top - layer.top))
    layer.image.putalpha(ImageChops.multiply(layer.image.getchannel("A"), whole))
