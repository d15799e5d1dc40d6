"""Series: predict related drawings consistently, such as cells of a sheet or frames of an animation."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.reader import Reading
from normalgan.inference.cleaning.silhouette import opaque_part
from normalgan.inference.composites.steadying import steadied
from normalgan.inference.mask.mask_files import MaskOrSource
from normalgan.inference.network.framing import bounds_of
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.parallel import result_of, stream
from normalgan.inference.pipeline import finish
from normalgan.inference.predictor import Predictor
from normalgan.inference.preparation import Prepared, hinted, prepare, reframed
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import Picture, fitted
from normalgan.inference.regions import Bounds, united
from normalgan.inference.sprites import to_art_pixels


@dataclass(frozen=True)
class Member:
    """One drawing of a series.

    Args:
        picture: the drawing.
        hints: hints in pixels of the drawing, or None.
        mask: the object or the source of the mask, as in `prepare`.
        holes: x and y of points whose regions are flipped, as in `prepare`.
        reading: the reader's output, if it is known; or None.
        pixel_art: whether the network sees one pixel for each art pixel of an enlarged sprite. The steps of
            the art pixels would otherwise be part of its outline.
    """

    picture: Picture
    hints: Hints | None = None
    mask: MaskOrSource = None
    holes: Sequence[tuple[float, float]] = ()
    reading: Reading | None = None
    pixel_art: bool = False


def predict_series(
    predictor: Predictor,
    members: Sequence[Member],
    shared: bool = False,
    steady: bool = False,
    size: int | None = None,
) -> Iterator[NormalMap | InputError]:
    """Yield the map of each drawing, or the error.

    Args:
        predictor: the network.
        members: the drawings; with ``shared``, all of one size.
        shared: whether all drawings are framed by one square that contains the lines of all. Parts that do
            not move then have the same pixels in each input, and a drawing with few lines is not enlarged.
        steady: whether the normals of consecutive drawings are averaged where their lines agree, so that
            still parts do not flicker; needs ``shared``. If the bounding boxes of all drawings have the same
            size, the object moves as a whole, and each drawing gets a frame of its own around it.
        size: longer side of the maps in pixels; None keeps the drawings' size.

    Raises:
        InputError: if ``shared`` is set and the sizes differ.
    """
    prepared = [got for _, got in stream(members, lambda each: prepare_member(predictor, each, size))]
    good = [i for i, each in enumerate(prepared) if isinstance(each, Prepared)]
    if shared and good:
        _check_sizes(members)
        bounds = [bounds_of(result_of(prepared[i]).ink) for i in good]
        # An object that only moves as a whole is still in frames centred on it, and fills them.
        if not (steady and _of_one_size(bounds)):
            for i in good:
                prepared[i] = reframed(result_of(prepared[i]), united(bounds))
    for i in good:
        prepared[i] = hinted(result_of(prepared[i]), members[i].hints, members[i].picture.shape)

    def predict(each: Prepared | Exception) -> tuple[Floats, Floats | None]:
        ready = result_of(each)
        return predictor.backend.predict(ready.model_input, ready.hints)

    predicted = [got for _, got in stream(prepared, predict)]
    if shared and steady:
        fine = [i for i in good if not isinstance(predicted[i], Exception)]
        shown = [result_of(prepared[i]).model_input for i in fine]
        averaged = steadied(shown, [result_of(predicted[i])[0] for i in fine])
        for i, normals in zip(fine, averaged, strict=True):
            predicted[i] = normals, result_of(predicted[i])[1]

    def place(i: int) -> NormalMap:
        return finish(result_of(prepared[i]), *result_of(predicted[i]), predictor.upsample)

    for _, got in stream(range(len(members)), place):
        yield got if isinstance(got, InputError) else result_of(got)


def left_flat(error: InputError) -> str:
    """Return the warning about a drawing that could not be predicted, as part of a sentence."""
    return f"it is left flat, because {str(error).rstrip('.')}"


def flat_map(shape: tuple[int, int], size: int | None = None) -> NormalMap:
    """Return a flat map without an object for a drawing (H, W).

    Args:
        shape: (H, W) of the drawing.
        size: longer side of the map in pixels; None keeps the drawing's size.
    """
    shape = fitted(shape, size)
    normals = np.zeros((*shape, 3), np.float32)
    normals[..., 2] = 1
    nothing = np.zeros(shape, np.float32)
    return NormalMap(normals, nothing > 0, nothing)


def prepare_member(predictor: Predictor, member: Member, size: int | None = None) -> Prepared:
    """Return a drawing of a series, cleaned and framed separately, without hints."""
    widths = predictor.backend.line_widths
    picture = to_art_pixels(member.picture) if member.pixel_art else member.picture
    given = picture, predictor.size, member.mask, None, size
    prepared = prepare(*given, line_widths=widths, holes=member.holes, reading=member.reading)
    if picture is member.picture or prepared.alpha is None:
        return prepared
    alpha = member.picture.resized((prepared.ink.shape[0], prepared.ink.shape[1])).alpha
    if alpha is None:
        return prepared
    return replace(prepared, alpha=member.picture.alpha, mask=opaque_part(alpha))


def _of_one_size(boxes: Sequence[Bounds]) -> bool:
    """Return whether boxes have the same size, to within the one pixel that a soft edge may add."""
    sizes = np.array([(bottom - top, right - left) for top, bottom, left, right in boxes])
    return bool((np.ptp(sizes, axis=0) <= 1).all())


def _check_sizes(members: Sequence[Member]) -> None:
    sizes = {each.picture.shape for each in members}
    if len(sizes) > 1:
        (height, width), (other_height, other_width) = sorted(sizes)[:2]
        raise InputError(
            f"drawings of {width} × {height} and {other_width} × {other_height} pixels cannot share a frame; "
            "use --frame own for drawings of different sizes."
        )
