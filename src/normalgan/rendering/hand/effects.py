"""Effects of a hand on strokes: cuts, omissions, repeats, missed ends, pressure, wobble.

Points, and all lengths except line widths, are in fractions of the frame's side. The points of a stroke
are `STEP` apart.
"""

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
from scipy.ndimage import gaussian_filter1d

from normalgan.arrays import Doubles
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes.curves import lengths_along
from normalgan.rendering.strokes.stroke import Stroke

STEP = 1 / 320
"""Distance between points: a quarter of the tremor's wavelength, and less than a line's width."""


def resample(stroke: Stroke) -> Stroke:
    """Return the stroke resampled to at least three even points, at most `STEP` apart, with the same ends.

    >>> resample(Stroke.even(np.array([[0.0, 0.0], [0.0, 0.0125]]), 1.0)).points[:, 1]
    array([0.      , 0.003125, 0.00625 , 0.009375, 0.0125  ])
    """
    along = lengths_along(stroke.points)
    at = np.linspace(0, along[-1], max(3, int(np.ceil(along[-1] / STEP - 1e-9)) + 1))
    values = (*stroke.points.T, stroke.width, stroke.darkness)
    x, y, width, darkness = (np.interp(at, along, value) for value in values)
    return Stroke(np.stack([x, y], axis=1), width, darkness)


def _piece(stroke: Stroke, start: int, stop: int) -> Stroke:
    """Return the points from ``start`` up to ``stop`` (exclusive) as a stroke."""
    part = slice(start, stop)
    return Stroke(stroke.points[part], stroke.width[part], stroke.darkness[part])


def begin_at(stroke: Stroke, index: int) -> Stroke:
    """Return a closed stroke with another point as its start and end."""

    def turn(values: Doubles) -> Doubles:
        return np.concatenate([values[index:-1], values[: index + 1]])

    return Stroke(turn(stroke.points), turn(stroke.width), turn(stroke.darkness))


_TURN_REACH = round(0.012 / STEP)  # number of points on either side for measuring the turn at a point


def turning(points: Doubles, reach: int, closed: bool = False) -> Doubles:
    """Return the turning angle (radians) at each point of a curve, between points ``reach`` before and after.

    The angle is 0 at the ends of an open curve and where points coincide.

    >>> turning(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), 1).round(3)
    array([0.   , 1.571, 0.   ])
    """
    inner = points[:-1] if closed else points
    before, after = np.roll(inner, reach, axis=0), np.roll(inner, -reach, axis=0)
    (ax, ay), (bx, by) = (inner - before).T, (after - inner).T
    angle: Doubles = np.abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))
    if closed:
        return np.append(angle, angle[0])
    angle[:reach] = 0
    angle[max(len(angle) - reach, 0) :] = 0
    return angle


_KNOTS_APART = 4  # knots between strokes, so that they share none, because a cubic spans four
_NOISE_SPREAD = np.sqrt(0.479)  # root mean square of a cubic B-spline with standard normal coefficients


def _spline_weights(at: Doubles) -> Doubles:
    """Return the weights (N, 4) of a uniform cubic B-spline's coefficients at fractional positions in a cell.

    >>> _spline_weights(np.array([0.0])).round(3)
    array([[0.167, 0.667, 0.167, 0.   ]])
    """
    rest = 1 - at
    second = 2 / 3 - at * at * (1 - at / 2)
    third = 2 / 3 - rest * rest * (1 - rest / 2)
    return np.stack([rest**3 / 6, second, third, at**3 / 6], axis=-1)


def smooth_noise(
    counts: Sequence[int], wavelength: float, channels: int, rng: np.random.Generator
) -> Doubles:
    """Return noise of mean 0 and standard deviation 1 along concatenated strokes, (sum of counts, channels).

    The noise is a uniform cubic B-spline with normal coefficients, two per wavelength. Its second
    derivative is continuous, and strokes and channels are independent. ``counts`` holds the number of
    points of each stroke.
    """
    sizes = np.asarray(counts)
    rate = 2 * STEP / wavelength
    knots = np.floor((sizes - 1) * rate).astype(int) + _KNOTS_APART
    starts, firsts = np.cumsum(knots) - knots, np.cumsum(sizes) - sizes
    at = np.repeat(starts, sizes) + (np.arange(sizes.sum()) - np.repeat(firsts, sizes)) * rate
    cell = np.floor(at).astype(int)
    coefficients = rng.standard_normal((int(knots.sum()), channels)) / _NOISE_SPREAD
    weights = _spline_weights(at - cell)
    return np.asarray(sum(weights[:, k, None] * coefficients[cell + k] for k in range(4)))


_SHORTEST_PIECE = round(0.04 / STEP)  # minimum number of points between lifts of the pen
_STRAIGHT_WEIGHT = 0.02  # radians²; the pen is occasionally lifted from a straight piece too
_INNER_PRIORITY = 0.2  # an inner stroke is drawn together with outline strokes of a fifth of its length
_RIM = 0.012  # strokes within this distance of the silhouette belong to the outline


def cut(stroke: Stroke, cuts: float, rng: np.random.Generator) -> list[Stroke]:
    """Cut a stroke into pieces, mostly where it turns, with ``cuts`` expected cuts per side length."""
    count = len(stroke.points)
    weights = turning(stroke.points, _TURN_REACH, stroke.closed) ** 2 + _STRAIGHT_WEIGHT
    chance = weights / weights.sum()
    if stroke.closed:  # a closed stroke also begins at a corner
        stroke = begin_at(stroke, int(rng.choice(count, p=chance)) % (count - 1))
        chance = turning(stroke.points, _TURN_REACH) ** 2 + _STRAIGHT_WEIGHT
        chance /= chance.sum()
    wanted = rng.poisson(cuts * (count - 1) * STEP)
    chosen = np.sort(rng.choice(count, size=wanted, p=chance))
    edges = [0]
    for place in chosen:
        if edges[-1] + _SHORTEST_PIECE <= place <= count - 1 - _SHORTEST_PIECE:
            edges.append(int(place))
    edges.append(count - 1)
    return [_piece(stroke, start, stop + 1) for start, stop in pairwise(edges)]


def inside(strokes: Sequence[Stroke], maps: Maps) -> Doubles:
    """Return the fraction of each stroke that is inside the object, away from the silhouette."""
    height, width = maps.mask.shape
    deep = cv2.distanceTransform(maps.mask.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    deep = deep > max(1.5, _RIM * max(height, width))  # the outermost pixels belong to the outline
    shares = []
    for stroke in strokes:
        x, y = (max(height, width) * stroke.points).astype(int).T
        shares.append(deep[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)].mean())
    return np.array(shares)


def in_order(strokes: Sequence[Stroke], interior: Doubles) -> tuple[list[Stroke], Doubles]:
    """Return strokes and fractions in drawing order: outline before inner strokes, and long before short."""
    lengths = np.array([stroke.length for stroke in strokes])
    order = np.argsort(-lengths * np.where(interior > 0.5, _INNER_PRIORITY, 1), kind="stable")
    return [strokes[index] for index in order], interior[order]


_OUTLINE, _INSIDE = 0.05, 0.4  # strokes of this length are forgotten e times less often
_MEAN_GAP = 0.05  # mean length of a skipped part
_SHORTEST_PART = round(0.012 / STEP)  # minimum number of points of a drawn part


def forget(
    strokes: Sequence[Stroke], interior: Doubles, chance: float, rng: np.random.Generator
) -> list[Stroke]:
    """Return the strokes after dropping some, preferably inner and short ones.

    The longest stroke is always kept, so that no drawing is empty. ``chance`` is the probability of
    dropping a very short stroke, and ``interior`` is the fraction of each stroke that is away from the
    silhouette.
    """
    if not strokes:
        return []
    length = np.array([stroke.length for stroke in strokes])
    missed = chance * np.exp(-length / (_OUTLINE + (_INSIDE - _OUTLINE) * interior))
    kept = rng.random(len(strokes)) >= missed
    kept[length.argmax()] = True
    return [stroke for stroke, keep in zip(strokes, kept, strict=True) if keep]


def skip_parts(stroke: Stroke, parts: float, rng: np.random.Generator) -> list[Stroke]:
    """Return the drawn parts of a stroke, with ``parts`` expected gaps per side length."""
    count = len(stroke.points)
    missing = rng.poisson(parts * (count - 1) * STEP)
    drawn = np.ones(count, bool)
    for middle, length in zip(rng.random(missing), rng.exponential(_MEAN_GAP, missing), strict=True):
        half = min(length / STEP, 0.3 * count) / 2
        drawn[max(0, round(middle * count - half)) : round(middle * count + half)] = False
    if drawn.all():
        return [stroke]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], drawn, [False]]).astype(int))).reshape(-1, 2)
    longest = edges[np.argmax(edges[:, 1] - edges[:, 0])]
    left = [(start, stop) for start, stop in edges if stop - start >= _SHORTEST_PART]
    return [_piece(stroke, start, stop) for start, stop in left or [longest] if stop - start > 1] or [stroke]


_SHORTEST_REPEAT = 0.4  # minimum length of a second pass, as a fraction of the stroke
_OFFSET = 0.005  # offset from the first stroke (standard deviation)


def second_pass(stroke: Stroke, rng: np.random.Generator) -> Stroke:
    """Return a second stroke close to the first, over at least two fifths of it."""
    count = len(stroke.points)
    kept = min(max(3, round(rng.uniform(_SHORTEST_REPEAT, 1) * count)), count)
    start = int(rng.integers(count - kept + 1))
    part = _piece(stroke, start, start + kept)
    return Stroke(part.points + rng.normal(0, _OFFSET, 2), part.width, part.darkness)


_LARGEST_MISS = 0.25  # maximum error of an end, as a fraction of the stroke
_END_REACH = 6  # number of points for estimating the direction and the bend of an end
_LARGEST_BEND = np.deg2rad(40)  # maximum turn of an overshoot


def miss_ends(stroke: Stroke, overshoot: float, gap: float, rng: np.random.Generator) -> Stroke:
    """Return the stroke with each end randomly lengthened or shortened by an exponential random length.

    The mean lengths are ``overshoot`` and ``gap``.
    """
    most = _LARGEST_MISS * (len(stroke.points) - 1)
    for _ in range(2):  # the end, then, after reversal, the beginning
        beyond, lengths = rng.random() < 0.5, rng.exponential([overshoot, gap]) / STEP
        change = round(min(lengths[0 if beyond else 1], most))
        if beyond and change:
            stroke = _longer(stroke, change)
        elif change and len(stroke.points) - change > 2:
            stroke = _piece(stroke, 0, len(stroke.points) - change)
        stroke = Stroke(stroke.points[::-1], stroke.width[::-1], stroke.darkness[::-1])
    return stroke


def _longer(stroke: Stroke, count: int) -> Stroke:
    """Return the stroke with ``count`` more points at its end, which continue its direction and curvature."""
    look = min(_END_REACH, (len(stroke.points) - 1) // 2)
    near, middle, far = (stroke.points[-1 - k * look] for k in range(3))
    heading, earlier = _angle(near - middle), _angle(middle - far)
    bend = (heading - earlier + np.pi) % (2 * np.pi) - np.pi
    rate = np.clip(bend / look, -_LARGEST_BEND / count, _LARGEST_BEND / count)
    angles = heading + rate * (look / 2 + np.arange(1, count + 1))
    ahead = near + STEP * np.cumsum(np.stack([np.cos(angles), np.sin(angles)], axis=1), axis=0)
    return Stroke(
        np.concatenate([stroke.points, ahead]),
        np.concatenate([stroke.width, np.full(count, stroke.width[-1])]),
        np.concatenate([stroke.darkness, np.full(count, stroke.darkness[-1])]),
    )


def _angle(vector: Doubles) -> float:
    return float(np.arctan2(vector[1], vector[0]))


_WAVELENGTH = 0.35  # wavelength of the pressure
_TAPER = 0.07  # length over which a long stroke tapers at its ends
_START_TAPER = 0.5  # taper where the pen is set down, relative to that where it is lifted
_TIGHT_TURN = np.deg2rad(40)  # turning angle where the hand is slowest


def press(
    strokes: Sequence[Stroke],
    pressure: float,
    fade: float,
    taper: float,
    slowness: float,
    rng: np.random.Generator,
) -> list[Stroke]:
    """Return strokes with varying width and darkness.

    Args:
        strokes: strokes of the drawing.
        pressure: standard deviation of the logarithm of the width, along and between strokes.
        fade: standard deviation of the logarithm of the darkness where pressure is low; ink is never
            darker than 1.
        taper: fraction by which a line gets thinner towards the end where the pen is lifted.
        slowness: fraction by which a line gets wider in tight turns, where the hand is slow.
        rng: source of randomness.
    """
    counts = [len(stroke.points) for stroke in strokes]
    if not counts:
        return []
    along, own = rng.spawn(2)
    force = 0.92 * smooth_noise(counts, _WAVELENGTH, 1, along)[:, 0]
    force += 0.4 * np.repeat(own.standard_normal(len(counts)), counts)  # 0.92² + 0.4² = 1
    pressed = []
    for stroke, f in zip(strokes, np.split(force, np.cumsum(counts)[:-1]), strict=True):
        slow = np.clip(turning(stroke.points, _TURN_REACH) / _TIGHT_TURN, 0, 1)
        factor = np.exp(pressure * f) * (1 + slowness * slow) * _lifted(len(f), taper)
        darkness = np.minimum(stroke.darkness, stroke.darkness * np.exp(fade * f))
        pressed.append(Stroke(stroke.points, stroke.width * factor, darkness))
    return pressed


def _lifted(count: int, taper: float) -> Doubles:
    """Return the width factors of a stroke with ``count`` points, which decrease towards the ends."""
    reach = max(1.0, min(_TAPER / STEP, 0.4 * count))
    index = np.arange(count)
    start, end = (np.clip(distance / reach, 0, 1) for distance in (index, count - 1 - index))
    return (1 - _START_TAPER * taper * (1 - start) ** 2) * (1 - taper * (1 - end) ** 2)


_WAVELENGTHS = (0.6, 0.14, 0.025)  # wavelengths of drift (aim), wobble (arm) and tremor (fingers)


def stray(strokes: Sequence[Stroke], amplitudes: Sequence[float], rng: np.random.Generator) -> list[Stroke]:
    """Return the strokes with smooth displacements, independent for each stroke and not zero at its ends.

    The amplitudes are the standard deviations of drift, wobble and tremor along each axis.
    """
    counts = [len(stroke.points) for stroke in strokes]
    if not counts:
        return []
    shift = np.zeros((sum(counts), 2))
    for amplitude, wavelength, source in zip(amplitudes, _WAVELENGTHS, rng.spawn(3), strict=True):
        if amplitude:
            shift += amplitude * smooth_noise(counts, wavelength, 2, source)
    parts = np.split(shift, np.cumsum(counts)[:-1])
    return [
        Stroke(stroke.points + part, stroke.width, stroke.darkness)
        for stroke, part in zip(strokes, parts, strict=True)
    ]


def round_off(stroke: Stroke, deviation: float) -> Stroke:
    """Return the stroke with smoothed detail and hardly any shrinkage; open strokes keep their ends.

    The filter is 2 G − G * G for a Gaussian G, which hardly changes larger curves: the part removed by
    smoothing is smoothed and added back ("twicing", Tukey, Exploratory Data Analysis, 1977).

    Args:
        stroke: stroke with evenly spaced points.
        deviation: standard deviation of the Gaussian, in points.
    """
    points = stroke.points
    pad = min(int(8 * deviation) + 1, len(points) - 1)
    if stroke.closed:
        before, after = points[-1 - pad : -1], points[1 : 1 + pad]
    else:  # extended by its point reflection at each end, the curve is smooth and keeps its ends
        before, after = 2 * points[0] - points[pad:0:-1], 2 * points[-1] - points[-2 : -pad - 2 : -1]
    once: Doubles = gaussian_filter1d(np.concatenate([before, points, after]), deviation, axis=0)
    smooth = (2 * once - gaussian_filter1d(once, deviation, axis=0))[pad : pad + len(points)]
    smooth[-1] = smooth[0] if stroke.closed else points[-1]
    if not stroke.closed:
        smooth[0] = points[0]
    return Stroke(smooth, stroke.width, stroke.darkness)
