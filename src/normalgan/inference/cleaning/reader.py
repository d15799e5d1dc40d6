"""Reader: a small network that finds the ink and the object in a raw picture."""

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.reading.picture import Picture, fitted
from normalgan.weights.shipped import READER_FILE

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

SIDES = 256, 384
"""Minimum and maximum longer side of the network's input, in pixels."""
NEARER = 1.5, 2.5
"""Minimum and maximum enlargement of the second pass: less would add little detail, more would be slow."""
PAPER = 0.15
"""Margin around the drawing in the second pass, as a fraction of its longer side, as in training."""
STRIDE = 32
"""The sides of the network's input are multiples of this number of pixels."""
NARROWEST = 0.3
"""Minimum ratio, before rounding, of the sides of the network's input. In narrower pictures, such as banners,
it finds no object, so they get margins of paper."""
GREY = np.array([0.299, 0.587, 0.114], np.float32)
"""Weights of red, green and blue in the luminance."""
ONE_TONE = 0.08
"""Maximum brightness difference between neighbours within one tone, allowing for grain and uneven light."""
DOUBT = 0.1
"""Minimum fraction of ink, and of paper, in an ambiguous area; pale lines make up less of a page."""
WINDOW, FLAT = 9, 1e-3
"""Side of the guided filter's window in network pixels, and the variance below which it averages instead."""


@dataclass(frozen=True)
class Reading:
    """The network's output for a picture, at the scale of the network's input.

    Args:
        ink: (h, w), probability that a pixel is a line of a drawing.
        presence: (h, w), probability that a pixel belongs to an object; holes do not.
        middle: (2, h, w), x and y of the centre of the pixel's object, as fractions of the picture's sides.
    """

    ink: Floats
    presence: Floats
    middle: Floats

    def presence_at(self, shape: tuple[int, int]) -> Floats:
        """Return the presence resized to (H, W) pixels."""
        return _enlarged(self.presence, shape)

    def part(self, box: tuple[slice, slice], shape: tuple[int, int]) -> "Reading":
        """Return the reading of the rows and columns in a box of a picture (H, W)."""
        scale = np.array(self.ink.shape) / shape
        start = np.floor([each.start for each in box] * scale).astype(int)
        end = np.maximum(np.rint([each.stop for each in box] * scale).astype(int), start + 1)
        rows, columns = slice(start[0], end[0]), slice(start[1], end[1])
        sides, first = np.array(self.ink.shape)[::-1], start[::-1]
        middle = (self.middle[:, rows, columns].T * sides - first) / (end - start)[::-1]
        return Reading(self.ink[rows, columns], self.presence[rows, columns], middle.T.astype(np.float32))

    def ink_at(self, picture: Picture) -> Floats:
        """Return the ink (H, W) in [0, 1] at the picture's own size.

        The network's ink is blurred for large drawings. A guided filter restores the detail: within a window,
        ink is a linear function of the brightness and of the brightness gradient, which marks where areas
        without an outline meet. The coefficients are fitted at the network's size and applied at full size.

        Args:
            picture: (H, W), the picture that this reading is of, at any size.

        References:
            He, Sun, Tang 2013, "Guided Image Filtering", equations 14 to 16.
            He, Sun 2015, "Fast Guided Filter".
        """
        grey = np.asarray(over_paper(picture) @ GREY, np.float32)
        small = reduced(grey, (self.ink.shape[0], self.ink.shape[1]))
        steps = _steps(small)
        grey_mean, steps_mean, ink_mean = _mean(small), _mean(steps), _mean(self.ink)
        grey_var = _mean(small * small) - grey_mean * grey_mean + FLAT
        steps_var = _mean(steps * steps) - steps_mean * steps_mean + FLAT
        both = _mean(small * steps) - grey_mean * steps_mean
        by_grey = _mean(small * self.ink) - grey_mean * ink_mean
        by_steps = _mean(steps * self.ink) - steps_mean * ink_mean
        determinant = grey_var * steps_var - both * both
        along_grey = _mean((steps_var * by_grey - both * by_steps) / determinant)
        along_steps = _mean((grey_var * by_steps - both * by_grey) / determinant)
        intercept = self.ink - along_grey * small - along_steps * steps
        found = _enlarged(along_grey, picture.size) * grey + _enlarged(intercept, picture.size)
        found += _enlarged(along_steps, picture.size) * _steps(grey)
        return np.clip(found, 0, 1, out=found)


def read(picture: Picture) -> Reading:
    """Return the network's output; a small drawing on a large page gets a second pass on an enlarged crop.

    Args:
        picture: the raw drawing; transparent parts become white, or black if the opaque part has a light
            edge.
    """
    colour = over_paper(picture)
    page = _run_network(colour)
    window = _around_drawing(page, picture.size)
    return page if window is None else _put_in(page, _run_network(colour[window]), window, picture.size)


def _around_drawing(page: Reading, shape: tuple[int, int]) -> tuple[slice, slice] | None:
    """Return the rows and columns of a picture (H, W) to crop to; None if a crop adds little detail."""
    rows, columns = np.nonzero((page.ink > 0.5) | (page.presence > 0.5))
    if not len(rows):
        return None
    scale = np.array(shape) / page.ink.shape
    low, high = np.array([rows.min(), columns.min()]) * scale, np.array([rows.max(), columns.max()]) * scale
    side = max(float((high - low).max()) * (1 + 2 * PAPER), max(shape) / NEARER[1])
    if shown_share(side) < NEARER[0] * shown_share(max(shape)):
        return None
    start = np.clip((low + high - side) / 2, 0, np.maximum(np.array(shape) - side, 0)).astype(int)
    end = np.minimum(start + round(side), shape)
    return slice(start[0], end[0]), slice(start[1], end[1])


def shown_share(side: float) -> float:
    """Return the scale at which the network sees a picture with this longer side in pixels; at most 1."""
    return min(SIDES[1] / side, 1.0)


def _put_in(page: Reading, part: Reading, window: tuple[slice, slice], shape: tuple[int, int]) -> Reading:
    """Return the reading of a picture (H, W) with the reading of a crop pasted in, at the crop's scale."""
    start, end = np.array([[at.start, at.stop] for at in window]).T
    within = np.array(part.ink.shape)
    scale = within / (end - start)
    height, width = np.maximum(np.rint(shape * scale), within).astype(int)
    top, left = np.minimum(np.rint(start * scale), np.array([height, width]) - within).astype(int)
    inside = slice(top, top + within[0]), slice(left, left + within[1])
    ink, presence, x, y = (
        _enlarged(each, (height, width)) for each in (page.ink, page.presence, *page.middle)
    )
    ink[inside], presence[inside] = part.ink, part.presence
    y[inside], x[inside] = (
        (begin + middle * (stop - begin)) / side
        for begin, stop, middle, side in zip(start, end, part.middle[::-1], shape, strict=True)
    )
    return Reading(ink, presence, np.stack([x, y]))


def _run_network(colour: Floats) -> Reading:
    """Return the network's output for colours (H, W, 3)."""
    shape = colour.shape[0], colour.shape[1]
    side = min(max(*shape, SIDES[0]), SIDES[1])
    height, width = (max(round(each / STRIDE), 1) * STRIDE for each in fitted(shape, side))
    least = round(NARROWEST * max(height, width) / STRIDE) * STRIDE
    page = max(height, least), max(width, least)
    shown = reduced(colour, (height, width))
    top, left = (page[0] - height) // 2, (page[1] - width) // 2
    if page != (height, width):
        border = np.concatenate([colour[0], colour[-1], colour[:, 0], colour[:, -1]])
        bottom, right = page[0] - height - top, page[1] - width - left
        paper = np.median(border, axis=0).tolist()
        page_shown = cv2.copyMakeBorder(shown, top, bottom, left, right, cv2.BORDER_CONSTANT, value=paper)
        shown = np.asarray(page_shown, np.float32)
    blob = np.ascontiguousarray(shown[..., ::-1].transpose(2, 0, 1)[None], np.float32)
    found = np.asarray(_session().run(["read"], {"picture": blob})[0][0], np.float32)
    ink, presence = 1 / (1 + np.exp(-np.clip(found[:2], -30, 30)))
    within = slice(top, top + height), slice(left, left + width)
    middle = found[2:, *within] * max(page)
    x = (np.arange(width, dtype=np.float32) + middle[0]) / width
    y = (np.arange(height, dtype=np.float32)[:, None] + middle[1]) / height
    return Reading(_by_tone(ink, shown @ GREY)[within], presence[within], np.stack([x, y]))


def _by_tone(ink: Floats, grey: Floats) -> Floats:
    """Return ink (h, w) in which each ambiguous area of one tone is entirely ink or entirely paper.

    Dark paint that was partly ink would have edges inside it.

    Args:
        ink: (h, w) in [0, 1].
        grey: (h, w), brightness.
    """
    flat = np.asarray(_steps(grey) < ONE_TONE, np.uint8)
    count, found = cv2.connectedComponents(flat, connectivity=4)
    labels = np.asarray(found, np.int32)
    sizes = np.bincount(labels.ravel(), minlength=count)
    votes = np.bincount(labels.ravel(), weights=ink.ravel(), minlength=count) / np.maximum(sizes, 1)
    unsure = (votes > DOUBT) & (votes < 1 - DOUBT)
    unsure[0] = False
    return np.where(unsure[labels], votes[labels] > 0.5, ink).astype(np.float32)


def _mean(values: Floats) -> Floats:
    return np.asarray(cv2.blur(values, (WINDOW, WINDOW)), np.float32)


def _steps(grey: Floats) -> Floats:
    """Return the range (h, w) of the brightness in the 3 × 3 neighbourhood of each pixel."""
    return np.asarray(cv2.morphologyEx(grey, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)), np.float32)


def reduced(values: Floats, shape: tuple[int, int]) -> Floats:
    """Return a picture (H, W) or (H, W, C) resized to (h, w), the size of the network's input."""
    method = cv2.INTER_AREA if max(shape) < max(values.shape) else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(values, shape[::-1], interpolation=method), np.float32)


def _enlarged(values: Floats, shape: tuple[int, int]) -> Floats:
    return np.asarray(cv2.resize(values, shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)


def over_paper(picture: Picture) -> Floats:
    """Return colours (h, w, 3) composited over white, or over black if the opaque part has a light edge."""
    if picture.alpha is None:
        return picture.colour
    alpha = picture.alpha
    edge = alpha - cv2.erode(alpha, np.ones((3, 3), np.uint8))
    seen = float((picture.colour @ GREY * edge).sum() / max(float(edge.sum()), 1e-6))
    paper = 1.0 if seen < 0.6 else 0.0
    return np.asarray(picture.colour * alpha[..., None] + paper * (1 - alpha[..., None]), np.float32)


@cache
def _session() -> "InferenceSession":
    import onnxruntime  # takes a third of a second, and a given mask makes it unnecessary

    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4
    options.intra_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return onnxruntime.InferenceSession(READER_FILE.read_bytes(), options, providers=["CPUExecutionProvider"])
