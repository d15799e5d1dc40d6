"""Hand: draws the strokes of a line style like a person."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, Self, get_type_hints

import numpy as np

from normalgan.ranges import Range, UnitInterval, check_ranges
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

_HABITS = (0.3, 1.7)  # range of a drawing's factor for each effect
_Length = Annotated[float, Range(0, 0.1)]  # fraction of the side
_Number = Annotated[float, Range(0, 20)]  # per side length
_Factor = Annotated[float, Range(0, 2)]


@dataclass(frozen=True)
class Hand:
    """The kinds, sizes and frequencies of a person's drawing errors.

    Lengths are fractions of the frame's side, so that a drawing looks the same at every size. 0 turns an
    effect off. Each drawing has a random strength, which scales all settings, and random habits, which
    scale each of them by 0.3 to 1.7. The distortion of the whole drawing also applies to normals, depth
    and mask. All other effects are errors of the hand and do not change the object.

    Args:
        strength: range of a drawing's strength; 0 is the exact drawing, 1 uses the settings below.
        distortion: distortion of the whole drawing (standard deviation).
        proportion: error of the aspect ratio and of the shear (standard deviation).
        cuts: number of times that the pen is lifted per side length, mostly at corners.
        simplification: standard deviation of the Gaussian that smooths detail.
        missed: probability of leaving out a short stroke; long inner strokes and outline strokes are left
            out less often.
        missed_parts: number of gaps per side length.
        repeats: fraction of strokes that are drawn a second time, next to the first.
        drift: displacement of whole strokes (standard deviation).
        wobble: slow deviation of a stroke, from the arm (standard deviation).
        tremor: fast deviation of a stroke, from the fingers (standard deviation).
        overshoot: mean length of an overshoot, which occurs at half of the ends.
        gaps: mean length of a gap, which occurs at the other half of the ends.
        pressure: standard deviation of the logarithm of the width, along and between strokes.
        fade: standard deviation of the logarithm of the darkness, which never exceeds that of the style.
        taper: fraction by which the width decreases towards the end where the pen is lifted.
        slowness: fraction by which lines get wider in tight turns.
        pen: range of a random factor for all widths, from thin pens to thick markers.
    """

    strength: Annotated[tuple[float, float], Range(0, 1)] = (0.0, 1.0)
    distortion: _Length = 0.02
    proportion: Annotated[float, Range(0, 0.3)] = 0.08
    cuts: _Number = 0.8
    simplification: _Length = 0.016
    missed: UnitInterval = 0.9
    missed_parts: _Number = 0.04
    repeats: UnitInterval = 0.1
    drift: _Length = 0.004
    wobble: _Length = 0.0025
    tremor: _Length = 0.0006
    overshoot: _Length = 0.007
    gaps: _Length = 0.004
    pressure: UnitInterval = 0.12
    fade: _Factor = 0.15
    taper: Annotated[float, Range(0, 0.95)] = 0.4
    slowness: _Factor = 0.2
    pen: Annotated[tuple[float, float], Range(0.1, 10)] = (0.9, 3.0)

    def __post_init__(self) -> None:
        """Check that all settings are in range."""
        check_ranges(self)

    def draw(
        self, strokes: Sequence[Stroke], maps: Maps, rng: np.random.Generator
    ) -> tuple[list[Stroke], Maps]:
        """Return the strokes with a person's drawing errors, and the matching maps.

        Args:
            strokes: exact strokes, in pixels of a frame with the size of the maps.
            maps: (H, W) maps of the object, which are not modified.
            rng: source of randomness. Each effect has its own stream, so changing one effect does not
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
            drawing, maps = mine._distort(drawing, maps, bending)
        done = [replace(each, points=side * each.points, width=width * each.width) for each in drawing]
        return done, maps

    def _distort(
        self, drawing: Sequence[Stroke], maps: Maps, rng: np.random.Generator
    ) -> tuple[list[Stroke], Maps]:
        """Return the strokes, in fractions of the side, and the maps after a distortion of the picture."""
        distortion = random_distortion(self.distortion, self.proportion, maps, rng)
        counts = np.cumsum([len(stroke.points) for stroke in drawing])
        points = np.concatenate([np.zeros((0, 2)), *(stroke.points for stroke in drawing)])
        moved = np.split(distortion.move(points), counts[:-1])
        bent = [replace(stroke, points=at) for stroke, at in zip(drawing, moved, strict=False)]
        return bent, follow(maps, distortion)

    def _of_one_drawing(self, strength: float, rng: np.random.Generator) -> Self:
        """Return the settings scaled by the strength and the habits of a drawing."""
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
        """Return the strokes with their errors, in fractions of the side, given seven random ``streams``."""
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
