"""Layers: the parts of a drawing, the hindmost first; the network sees each among the others."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from normalgan.errors import InputError, RunError
from normalgan.inference.composites.composition import compose
from normalgan.inference.findings import Finding, LackingError, finding_of
from normalgan.inference.normal_map import NormalMap
from normalgan.studio.bodies import MOST_BYTES
from normalgan.studio.drawing_request import DrawingRequest, take_drawing
from normalgan.studio.fields import Fields, take_integer, take_text
from normalgan.studio.limits import LONGEST_NAME, MOST_LAYERS
from normalgan.studio.planes import KeptPlanes
from normalgan.studio.refusals import RefusedError

__all__ = ["Layer", "predict_layers", "take_layers"]

_LARGEST = 2**31


@dataclass(frozen=True)
class Layer:
    """A part of a drawing.

    Args:
        name: for findings; empty if it is the only layer.
        drawing: what is drawn on it.
    """

    name: str
    drawing: DrawingRequest


def take_layers(fields: Fields, kept: KeptPlanes, pixels: memoryview | None) -> list[Layer]:
    """Return the layers of a request, the hindmost first.

    Args:
        fields: of the request: ``layers``, each with an ``id``, a ``name``, and what a drawing has of its
            own, with a ``source`` in place of the request's; or those of a drawing with one layer. With
            pixels, each layer tells how many ``bytes`` are its own.
        kept: what the layers' tab has sent before.
        pixels: behind the fields; None if pictures are PNG in them.

    Raises:
        BehindError: if a layer is sent as a change to one that is not kept here.
        InputError: if a field cannot be used.
    """
    if "layers" not in fields:
        ink = None if pixels is None else kept.take(take_text(fields, "tab", 64), fields, pixels)
        return [Layer("", take_drawing(fields, ink))]
    listed = fields["layers"]
    if not isinstance(listed, list) or not 1 <= len(listed) <= MOST_LAYERS:
        raise InputError(f"layers must be a list of 1 to {MOST_LAYERS}.")
    tab = take_text(fields, "tab", 48)
    found, start, ids = [], 0, set[int]()
    for entry in listed:
        if not isinstance(entry, dict):
            raise InputError("a layer is not a JSON object with fields in braces.")
        own = take_integer(entry, "id", 0, _LARGEST)
        if own in ids:
            raise InputError(f"there are two layers with the id {own}.")
        ids.add(own)
        layer = {"source": fields.get("source"), **entry}
        layer |= {name: fields[name] for name in ("number", "keep") if name in fields}
        ink = None
        if pixels is not None:
            size = take_integer(entry, "bytes", 0, MOST_BYTES)
            ink = kept.take(f"{tab} {own}", layer, pixels[start : start + size])
            start += size
        name = take_text(entry, "name", LONGEST_NAME) if len(listed) > 1 else ""
        found.append(Layer(name, take_drawing(layer, ink)))
    if pixels is not None and start != len(pixels):
        raise InputError(f"there are {len(pixels)} bytes of pixels; the layers tell of {start}.")
    if pixels is not None and len({each.drawing.shape for each in found}) > 1:
        raise InputError("the layers are of different sizes; they must have the drawing's.")
    return found


def predict_layers(
    layers: Sequence[Layer], predict: Callable[[DrawingRequest, Sequence[DrawingRequest]], NormalMap]
) -> NormalMap:
    """Return the map of all layers; its findings say which layers could not be predicted, and why.

    Args:
        layers: the hindmost first.
        predict: predicts one layer among all of them.

    Raises:
        LackingError: if none can be predicted.
    """
    if len(layers) == 1:
        return predict(layers[0].drawing, [])
    drawings = [layer.drawing for layer in layers]
    predicted, lacks = [], list[Finding]()
    for layer in layers:
        try:
            found = predict(layer.drawing, drawings)
        except InputError as error:
            if isinstance(error, RunError | RefusedError):
                raise
            lacks.append(replace(finding_of(error), layer=layer.name))
            continue
        said = tuple(replace(each, layer=layer.name) for each in found.findings)
        predicted.append(replace(found, findings=said))
    if not predicted:
        raise LackingError(lacks[0].words, lacks[0].code, lacks[0].layer)
    if len({each.mask.shape for each in predicted}) > 1:
        raise InputError("the layers are of different sizes; they must have the drawing's.")
    whole = compose(predicted)
    return replace(whole, findings=(*whole.findings, *lacks))
