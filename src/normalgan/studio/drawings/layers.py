"""Layers: the parts of a drawing, the hindmost first; the network sees each among the others."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from normalgan.errors import InputError, RunError
from normalgan.inference.composites.composition import compose
from normalgan.inference.findings import Finding, LackingError, finding_of
from normalgan.inference.normal_map import NormalMap
from normalgan.studio.drawings.drawing_request import DrawingRequest
from normalgan.studio.drawings.planes import KeptPlanes
from normalgan.studio.drawings.schemas import RequestFields
from normalgan.studio.server.refusals import RefusedError

__all__ = ["Layer", "predict_layers", "take_layers"]


@dataclass(frozen=True)
class Layer:
    """A part of a drawing.

    Args:
        name: for findings; empty if it is the only layer.
        drawing: what is drawn on it.
    """

    name: str
    drawing: DrawingRequest


def take_layers(fields: RequestFields, kept: KeptPlanes, pixels: memoryview | None) -> list[Layer]:
    """Return the layers of a request, the hindmost first.

    Args:
        fields: of the request. A layer without a ``source`` has that of the request.
        kept: what the layers' tab has sent before.
        pixels: behind the fields; None if pictures are PNG in them.

    Raises:
        BehindError: if a layer is sent as a change to one that is not kept here.
        InputError: if the pixels do not go with the layers.
    """
    if fields.layers is None:
        ink = None if pixels is None else kept.take(fields.tab, fields, pixels, fields.number, fields.keep)
        return [Layer("", DrawingRequest.of(fields, ink))]
    found, start = [], 0
    for layer in fields.layers:
        ink = None
        if pixels is not None:
            part = pixels[start : start + layer.bytes]
            ink = kept.take(f"{fields.tab} {layer.id}", layer, part, fields.number, fields.keep)
            start += layer.bytes
        drawing = DrawingRequest.of(layer, ink, layer.source or fields.source)
        found.append(Layer(layer.name if len(fields.layers) > 1 else "", drawing))
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
