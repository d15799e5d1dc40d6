"""Surface marks that do not depict form: filled areas, decals, hatching for shade.

All marks are drawn on single sketches with NumPy and OpenCV: ink (H, W) in [0, 1], ink 1; normals (H, W,
3), x right, y up, z to the viewer; a mask (H, W), True on the object. Lengths are in pixels of a 256-pixel
sketch.
"""

import string
from collections.abc import Callable

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from normalgan.arrays import BoolMask, Doubles, Floats

_Rng = np.random.Generator

_PAPER = 0.35
"""Pixels with less ink count as paper."""


def mark_surfaces(
    sketch: Tensor, normal: Tensor, mask: Tensor, seed: int, fills: float, decals: float, hatching: float
) -> Tensor:
    """Return sketches (N, 1, H, W) with filled areas, decals and hatching, each drawn with its probability.

    Args:
        sketch: (N, 1, H, W) in [0, 1], ink 1, on any device.
        normal: (N, 3, H, W), normals of the object.
        mask: (N, 1, H, W), 1 on the object.
        seed: seed of all randomness.
        fills: probability that areas are filled black.
        decals: probability of a decal.
        hatching: probability that the side away from a light is hatched.
    """
    marked = sketch.clone()
    for index in range(len(sketch)):
        rng = np.random.default_rng([seed, index])
        chosen = rng.random(3) < (decals, hatching, fills)
        if not chosen.any():
            continue
        ink = sketch[index, 0].detach().cpu().float().numpy()
        normals = np.ascontiguousarray(normal[index].detach().cpu().float().numpy().transpose(1, 2, 0))
        inside = mask[index, 0].cpu().numpy() > 0.5
        if inside.sum() < 64:
            continue  # the object is too small to draw on
        for draw, wanted in zip((_add_decal, _add_hatching, _fill_areas), chosen, strict=True):
            if wanted:
                ink = draw(ink, normals, inside, rng)
        marked[index, 0] = torch.from_numpy(ink).to(sketch)
    return marked


def _fill_areas(ink: Floats, normals: Floats, mask: BoolMask, rng: _Rng) -> Floats:
    """Return a sketch with some areas filled black, with white or hidden lines inside.

    Usually, one to four areas enclosed by lines are filled, like hair or a tyre. Sometimes a patch of the
    surface is filled, or the whole object, like a silhouette with white details.
    """
    kind = rng.random()
    if kind < 0.6:
        area = _enclosed(ink, mask, rng)
    elif kind < 0.85:
        area = _patch(mask, rng)
    else:
        area = mask
    # Include the anti-aliased rim of the lines around the area.
    if kind < 0.6:
        area = mask & (cv2.dilate(area.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0)
    white = rng.uniform(0.8, 1.0) if rng.random() < 0.7 else 0.0
    inner = cv2.erode(area.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
    return np.where(inner, 1.0 - white * ink, np.maximum(ink, area)).astype(np.float32)


def _enclosed(ink: Floats, mask: BoolMask, rng: _Rng) -> BoolMask:
    """Return the union of one to four enclosed areas of the object, with the lines between them."""
    paper = (mask & (ink < _PAPER)).astype(np.uint8)
    count, areas, stats, _ = cv2.connectedComponentsWithStats(paper, connectivity=4)
    sizes = stats[1:, cv2.CC_STAT_AREA]
    fit = 1 + np.flatnonzero((sizes > 0.003 * mask.sum()) & (sizes < 0.5 * mask.sum()))
    if not len(fit):
        return _patch(mask, rng)
    wanted = rng.choice(fit, min(int(rng.integers(1, 5)), len(fit)), replace=False)
    chosen = np.zeros(count, np.uint8)
    chosen[wanted] = 1
    side = _pixels(ink, 7) | 1
    closed = cv2.morphologyEx(chosen[areas], cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
    return (closed > 0) & mask


def _patch(mask: BoolMask, rng: _Rng) -> BoolMask:
    """Return a patch with a smooth outline that covers 1/20 to 1/2 of the object."""
    noise = _smooth(mask.shape, int(rng.integers(3, 8)), rng)
    return mask & (noise > np.quantile(noise[mask], 1 - rng.uniform(0.05, 0.5)))


def _add_hatching(ink: Floats, normals: Floats, mask: BoolMask, rng: _Rng) -> Floats:
    """Return a sketch with the unlit side hatched, and cross-hatched where it is darkest."""
    around, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.1, 0.8)
    flat = np.sqrt(1 - up * up)
    light = np.array([flat * np.cos(around), flat * np.sin(around), up], np.float32)
    shade = normals @ light + 0.12 * _smooth(mask.shape, 16, rng)
    level = np.quantile(shade[mask], rng.uniform(0.15, 0.5))
    angle, spacing = rng.uniform(0, np.pi), rng.uniform(3.5, 8.0)
    width, dark = rng.uniform(0.8, 1.6), rng.uniform(0.5, 1.0)
    follow = rng.uniform(0, 12) if rng.random() < 0.4 else 0.0  # strokes follow the form
    strokes = _stripes(normals, mask.shape, angle, spacing, width, follow, rng) * (mask & (shade < level))
    if rng.random() < 0.4:
        crossing = _stripes(normals, mask.shape, angle + rng.uniform(0.7, 1.6), spacing, width, follow, rng)
        darkest = mask & (shade < np.quantile(shade[mask], 0.5 * (shade[mask] < level).mean()))
        strokes = np.maximum(strokes, crossing * darkest)
    return np.asarray(np.maximum(ink, np.float32(dark) * strokes), dtype=np.float32)


def _add_decal(ink: Floats, normals: Floats, mask: BoolMask, rng: _Rng) -> Floats:
    """Return a sketch with text, a logo, windows, spots or stripes on the object."""
    if rng.random() < 0.3:
        return np.asarray(np.maximum(ink, _striped_coat(normals, mask, rng)), dtype=np.float32)
    # The position farthest from the outline out of eight, so that most of the decal fits.
    places = np.argwhere(mask)[rng.integers(mask.sum(), size=8)]
    inset = cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 3)
    row, column = (int(at) for at in max(places, key=lambda place: float(inset[tuple(place)])))
    facing = normals[row, column]
    if facing[2] < 0.3:
        return ink  # the surface is viewed at too shallow an angle
    size = float(np.sqrt(mask.sum())) * rng.uniform(0.3, 0.8)
    motif: Callable[[_Rng], Floats] = (_text, _logo, _windows, _spots)[rng.integers(4)]
    # Maps the motif (x right, y down, one unit wide) to the tangent plane of the surface at that position.
    right = np.array([facing[2], 0.0, -facing[0]]) / np.hypot(facing[0], facing[2])
    over = np.cross(facing, right)
    turn = rng.uniform(-0.5, 0.5) if rng.random() < 0.5 else 0.0
    right, over = np.cos(turn) * right + np.sin(turn) * over, np.cos(turn) * over - np.sin(turn) * right
    plane = size / _MOTIF * np.array([[right[0], -over[0]], [-right[1], over[1]]])
    place = np.array([column, row]) - plane @ np.full(2, _MOTIF / 2)
    # Blurred before downsampling, because lines thinner than a pixel would break into dots.
    shape = cv2.GaussianBlur(motif(rng), (0, 0), max(0.35 * _MOTIF / size, 0.5))
    drawn = cv2.warpAffine(shape, np.column_stack([plane, place]), mask.shape[::-1])
    drawn = np.clip(1.6 * drawn, 0, 1) * rng.uniform(0.7, 1.0)
    return np.asarray(np.maximum(ink, drawn * (mask & (normals @ facing > 0.6))), dtype=np.float32)


_MOTIF = 192
"""Side in pixels of text, logos, windows and spots before they are projected onto a surface."""


def _text(rng: _Rng) -> Floats:
    picture = np.zeros((_MOTIF, _MOTIF), np.uint8)
    font = int(rng.choice([cv2.FONT_HERSHEY_SIMPLEX, cv2.FONT_HERSHEY_DUPLEX, cv2.FONT_HERSHEY_TRIPLEX]))
    letters = np.array(list(string.ascii_uppercase + string.ascii_lowercase + string.digits))
    lines = int(rng.integers(1, 4))
    for number in range(lines):
        word = "".join(rng.choice(letters, int(rng.integers(1, 8))))
        bold = int(rng.integers(2, 8))
        (wide, high), _ = cv2.getTextSize(word, font, 1.0, bold)
        scale = min(0.9 * _MOTIF / wide, 0.8 * _MOTIF / lines / high)
        foot = (int((_MOTIF - scale * wide) / 2), int(_MOTIF * (number + 0.9) / lines))
        cv2.putText(picture, word, foot, font, scale, 255, bold, cv2.LINE_AA)
    return _ink(picture)


def _logo(rng: _Rng) -> Floats:
    """Return a star, polygon or disc, filled or not, usually in a ring or a frame."""
    picture = np.zeros((_MOTIF, _MOTIF), np.uint8)
    middle, bold = (_MOTIF // 2, _MOTIF // 2), int(rng.integers(3, 10))
    corners = int(rng.integers(3, 8))
    angles = np.arange(2 * corners) * np.pi / corners + rng.uniform(0, np.pi)
    radii = (
        np.where(np.arange(2 * corners) % 2, rng.uniform(0.25, 1.0), 1.0) * _MOTIF * rng.uniform(0.2, 0.33)
    )
    shape = np.stack([np.cos(angles), np.sin(angles)], 1) * radii[:, None] + _MOTIF / 2
    _outlined(picture, shape, bold, bool(rng.random() < 0.5))
    frame = rng.random()
    if frame < 0.4:
        cv2.circle(picture, middle, int(0.44 * _MOTIF), 255, bold, cv2.LINE_AA)
    elif frame < 0.7:
        edge = int(0.07 * _MOTIF)
        cv2.rectangle(picture, (edge, edge), (_MOTIF - edge, _MOTIF - edge), 255, bold, cv2.LINE_AA)
    return _ink(picture)


def _windows(rng: _Rng) -> Floats:
    """Return rows of window panes, some filled, as on a house or a bus."""
    picture = np.zeros((_MOTIF, _MOTIF), np.uint8)
    rows, columns = rng.integers(1, 5, 2)
    bold, filled, crossed = int(rng.integers(2, 6)), bool(rng.random() < 0.3), bool(rng.random() < 0.4)
    high, wide = _MOTIF / rows, _MOTIF / columns
    gap = rng.uniform(0.12, 0.3)
    for row in range(rows):
        for column in range(columns):
            top, left, bottom, right = (
                int(value)
                for value in (
                    (row + gap) * high,
                    (column + gap) * wide,
                    (row + 1 - gap) * high,
                    (column + 1 - gap) * wide,
                )
            )
            cv2.rectangle(picture, (left, top), (right, bottom), 255, -1 if filled else bold, cv2.LINE_AA)
            if crossed:
                colour = 0 if filled else 255
                middle = ((left + right) // 2, (top + bottom) // 2)
                cv2.line(picture, (left, middle[1]), (right, middle[1]), colour, bold, cv2.LINE_AA)
                cv2.line(picture, (middle[0], top), (middle[0], bottom), colour, bold, cv2.LINE_AA)
    return _ink(picture)


def _spots(rng: _Rng) -> Floats:
    """Return scattered ellipses, filled or not."""
    picture = np.zeros((_MOTIF, _MOTIF), np.uint8)
    bold = -1 if rng.random() < 0.5 else int(rng.integers(2, 6))
    for _ in range(int(rng.integers(2, 14))):
        x, y = rng.uniform(0.12, 0.88, 2) * _MOTIF
        axes = rng.uniform(0.02, 0.11, 2) * _MOTIF
        cv2.ellipse(
            picture,
            (int(x), int(y)),
            (int(axes[0]) + 1, int(axes[1]) + 1),
            float(rng.uniform(0, 180)),
            0,
            360,
            255,
            bold,
            cv2.LINE_AA,
        )
    return _ink(picture)


def _striped_coat(normals: Floats, mask: BoolMask, rng: _Rng) -> Floats:
    """Return a mask of wavy black stripes on an object or a patch of it, as on a zebra or a jersey."""
    spacing = rng.uniform(7, 24)
    black = spacing * rng.uniform(0.15, 0.6)
    where = mask if rng.random() < 0.4 else _patch(mask, rng)
    follow = rng.uniform(0, 25) if rng.random() < 0.6 else 0.0
    stripes = _stripes(normals, mask.shape, rng.uniform(0, np.pi), spacing, black, follow, rng)
    return stripes * where


def _stripes(
    normals: Floats,
    shape: tuple[int, ...],
    angle: float,
    spacing: float,
    width: float,
    follow: float,
    rng: _Rng,
) -> Floats:
    """Return parallel lines (H, W), slightly wavy.

    Args:
        normals: (H, W, 3), normals of the object.
        shape: H and W.
        angle: angle of the direction across the lines, in radians.
        spacing: distance between lines, in pixels of a 256-pixel sketch.
        width: width of a line in these pixels.
        follow: displacement by which lines follow the form, in these pixels.
        rng: random generator of the waves.
    """
    height, side = shape[:2]
    scale = side / 256
    across = np.arange(side, dtype=np.float32) * np.float32(np.cos(angle) / scale)
    down = np.arange(height, dtype=np.float32)[:, None] * np.float32(np.sin(angle) / scale)
    place = across + down + np.float32(rng.uniform(0.3, 1.5)) * _smooth(shape, 9, rng)
    if follow:
        place = place + np.float32(follow) * (
            normals[..., 0] * np.sin(angle) + normals[..., 1] * np.cos(angle)
        )
    from_line = np.abs(np.remainder(place, spacing) - spacing / 2)
    ink: Floats = np.clip((width / 2 - from_line) * scale + 0.5, 0, 1).astype(np.float32)
    return ink


def _smooth(shape: tuple[int, ...], points: int, rng: _Rng) -> Floats:
    """Return smooth noise (H, W) with a standard deviation of about 1 and ``points`` knots per side."""
    knots = rng.standard_normal((points, points)).astype(np.float32)
    return np.asarray(cv2.resize(knots, shape[1::-1], interpolation=cv2.INTER_CUBIC), dtype=np.float32)


def _outlined(picture: NDArray[np.uint8], shape: Doubles, bold: int, filled: bool) -> None:
    corners = np.rint(shape).astype(np.int32)[None]
    if filled:
        cv2.fillPoly(picture, list(corners), 255, cv2.LINE_AA)
    else:
        cv2.polylines(picture, list(corners), True, 255, bold, cv2.LINE_AA)


def _ink(picture: NDArray[np.uint8]) -> Floats:
    return np.asarray(picture / 255, dtype=np.float32)


def _pixels(ink: Floats, length: float) -> int:
    """Convert a length from pixels of a 256-pixel sketch to pixels of this one."""
    side: int = ink.shape[1]
    return max(round(length * side / 256), 1)
