"""Hand: draws the strokes of a style as a person would."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, Self, get_type_hints

import numpy as np

from normalgan.ranges import Range, Share, check_ranges
from normalgan.rendering.hand.distortion import follow, random_distortion
from normalgan.rendering.hand.effects import (
    STEP,
    cut,
    forget,
    in_order,
    inside,
    miss_ends,
    press,
    resample,
    round_off,
    second_pass,
    skip_parts,
    stray,
)
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["Hand"]

_HABITS = (0.3, 1.7)  # factor by which the effects of a drawing differ from the mean
_Length = Annotated[float, Range(0, 0.1)]  # as a fraction of the side
_Number = Annotated[float, Range(0, 20)]  # on the length of a side
_Factor = Annotated[float, Range(0, 2)]


@dataclass(frozen=True)
class Hand:
    """The errors that a person makes when drawing: which, how large, how often.

    Lengths are fractions of the frame's side, so that a drawing looks the same at every size; 0 turns an
    effect off. A drawing's strength scales all settings, and its habits scale each by a third to five
    thirds. Normals, depth and mask follow the distortion of the whole drawing. All other effects are errors
    of the hand and do not change the object.

    Args:
        strength: range from which the strength of a drawing is drawn; 0 is the exact drawing, 1 the
            settings below.
        distortion: distortion of the whole drawing (standard deviation).
        proportion: how wrong the ratio of height to width is, and the shear (standard deviation).
        cuts: how often the pen is lifted on the length of a side, at corners mostly.
        simplification: standard deviation of the rounding off of detail.
        missed: chance that a short stroke is left out; a long one inside seldom, of the outline hardly ever.
        missed_parts: how many parts are not drawn on the length of a side.
        repeats: share of strokes that are drawn a second time, next to the first.
        drift: displacement of whole strokes (standard deviation).
        wobble: how far it waves, by the arm (standard deviation).
        tremor: how far it trembles, by the fingers (standard deviation).
        overshoot: mean length of an overshoot at one end; it happens to one of two.
        gaps: mean length of a gap at the other.
        pressure: deviation of the logarithm of the width, along and among strokes.
        fade: deviation of the logarithm of the darkness, which never exceeds the style's.
        taper: share by which the width falls to where the pen is lifted.
        slowness: share by which lines are wider in tight turns.
        pen: range from which the factor of all widths is drawn: thin pens to thick markers.

    Raises:
        InputError: if a setting is out of range.
    """

    strength: Annotated[tuple[float, float], Range(0, 1)] = (0.0, 1.0)
    distortion: _Length = 0.02
    proportion: Annotated[float, Range(0, 0.3)] = 0.08
    cuts: _Number = 0.8
    simplification: _Length = 0.016
    missed: Share = 0.9
    missed_parts: _Number = 0.04
    repeats: Share = 0.1
    drift: _Length = 0.004
    wobble: _Length = 0.0025
    tremor: _Length = 0.0006
    overshoot: _Length = 0.007
    gaps: _Length = 0.004
    pressure: Share = 0.12
    fade: _Factor = 0.15
    taper: Annotated[float, Range(0, 0.95)] = 0.4
    slowness: _Factor = 0.2
    pen: Annotated[tuple[float, float], Range(0.1, 10)] = (0.9, 3.0)

    def __post_init__(self) -> None:
        """Check the ranges of all settings."""
        check_ranges(self)

    def draw(
        self, strokes: Sequence[Stroke], maps: Maps, rng: np.random.Generator
    ) -> tuple[list[Stroke], Maps]:
        """Return the strokes as a person would draw them, and the maps that match.

        Args:
            strokes: the exact drawing, in pixels of a frame as large as the maps.
            maps: (H, W) of the object; not changed.
            rng: source of randomness; each effect has its own stream, so that changing one effect does not
                affect the others.
        """
        own, bending, *streams = rng.spawn(9)
        strength = own.uniform(*self.strength)
        if strength == 0:
            return list(strokes), maps
        mine = self._of_one_drawing(strength, own)
        width, side = float(np.exp(strength * own.uniform(*np.log(self.pen)))), max(maps.mask.shape)
        drawing = [replace(stroke, points=stroke.points / side) for stroke in strokes]
        drawing = mine._draw_strokes(drawing, maps, streams)
        if mine.distortion or mine.proportion:
            distortion = random_distortion(mine.distortion, mine.proportion, maps, bending)
            counts = np.cumsum([len(stroke.points) for stroke in drawing])
            points = np.concatenate([np.zeros((0, 2)), *(stroke.points for stroke in drawing)])
            moved = np.split(distortion.move(points), counts[:-1])
            drawing = [replace(stroke, points=at) for stroke, at in zip(drawing, moved, strict=False)]
            maps = follow(maps, distortion)
        done = [replace(each, points=side * each.points, width=width * each.width) for each in drawing]
        return done, maps

    def _of_one_drawing(self, strength: float, rng: np.random.Generator) -> Self:
        """Return the settings scaled by the strength and the habits of one drawing."""
        names = [field.name for field in fields(self)[1:-1]]
        habits = rng.uniform(*_HABITS, len(names))
        hints = get_type_hints(Hand, include_extras=True)
        return replace(
            self,
            **{
                name: min(strength * habit * getattr(self, name), hints[name].__metadata__[0].most)
                for name, habit in zip(names, habits, strict=True)
            },
        )

    def _draw_strokes(
        self, strokes: Sequence[Stroke], maps: Maps, streams: Sequence[np.random.Generator]
    ) -> list[Stroke]:
        """Return the strokes with the errors of each, in fractions of the side; ``streams`` are seven."""
        if not strokes or not any(getattr(self, field.name) for field in fields(self)[3:-1]):
            return list(strokes)
        cutting, missing, skipping, repeating, ending, straying, pressing = streams
        drawing = [resample(stroke) for stroke in strokes]
        if self.cuts:
            drawing = [part for stroke in drawing for part in cut(stroke, self.cuts, cutting)]
        drawing, interior = in_order(drawing, inside(drawing, maps))
        if self.simplification:
            drawing = [round_off(stroke, self.simplification / STEP) for stroke in drawing]
        drawing = forget(drawing, interior, self.missed, missing)
        if self.missed_parts:
            drawing = [part for each in drawing for part in skip_parts(each, self.missed_parts, skipping)]
        if self.repeats:
            again = repeating.random(len(drawing)) < self.repeats
            drawing += [second_pass(drawing[index], repeating) for index in np.flatnonzero(again)]
        if self.overshoot or self.gaps:
            drawing = [miss_ends(stroke, self.overshoot, self.gaps, ending) for stroke in drawing]
        how = self.pressure, self.fade, self.taper, self.slowness
        if any(how):
            drawing = press(drawing, *how, pressing)
        amplitudes = self.drift, self.wobble, self.tremor
        return stray(drawing, amplitudes, straying) if any(amplitudes) else drawing
