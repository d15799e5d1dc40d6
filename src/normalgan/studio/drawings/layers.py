"""Layers: the layers of a drawing, and the prediction of their composite."""

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


@dataclass(frozen=True)
class Layer:
    """A layer of a drawing.

    Args:
        name: name for findings; empty if it is the only layer.
        drawing: content of the layer.
    """

    name: str
    drawing: DrawingRequest


def take_layers(fields: RequestFields, kept: KeptPlanes, pixels: memoryview | None) -> list[Layer]:
    """Return the layers of a request, back to front.

    Args:
        fields: fields of the request. A layer without a ``source`` uses that of the request.
        kept: pixels from earlier requests.
        pixels: bytes that followed the fields; None if the fields contain PNGs.

    Raises:
        BehindError: if a layer is a change to pixels that are not kept.
        InputError: if the pixels do not match the layers.
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
        raise InputError(f"there are {len(pixels)} bytes of pixels; the layers declare {start}.")
    if pixels is not None and len({each.drawing.shape for each in found}) > 1:
        raise InputError("the layers have different sizes; all must have the size of the drawing.")
    return found


def predict_layers(
    layers: Sequence[Layer], predict: Callable[[DrawingRequest, Sequence[DrawingRequest]], NormalMap]
) -> NormalMap:
    """Return the composite map of all layers, with a finding for each layer that could not be predicted.

    Args:
        layers: the layers, back to front.
        predict: predicts one layer among all layers.

    Raises:
        LackingError: if no layer can be predicted.
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
        raise InputError("the layers have different sizes; all must have the size of the drawing.")
    # A PNG's own size is not known here, but only raw pixels are sent for maps of another size.
    shape = drawings[0].shape or predicted[0].mask.shape
    told = [_in_sight(each.findings, predicted[i + 1 :], shape) for i, each in enumerate(predicted)]
    whole = compose([replace(each, findings=said) for each, said in zip(predicted, told, strict=True)])
    return replace(whole, findings=(*whole.findings, *lacks))


def _in_sight(
    findings: Sequence[Finding], front: Sequence[NormalMap], shape: tuple[int, ...]
) -> tuple[Finding, ...]:
    """Return the findings of a layer without open edges that a layer in front of it hides.

    Args:
        findings: the findings, with places in pixels of the drawing.
        front: maps of the layers in front.
        shape: (H, W) of the drawing.
    """

    def is_hidden(place: tuple[float, float]) -> bool:
        return any(bool(each.mask[_index(place, shape, each.mask.shape)]) for each in front)

    return tuple(each for each in findings if each.code != "edge" or not all(map(is_hidden, each.places)))


def _index(place: tuple[float, float], shape: tuple[int, ...], size: tuple[int, ...]) -> tuple[int, int]:
    """Return the row and column in a map (h, w) of a place x, y in a drawing (H, W)."""
    (x, y), (height, width), (rows, columns) = place, shape, size
    return min(int(y * rows / height), rows - 1), min(int(x * columns / width), columns - 1)
