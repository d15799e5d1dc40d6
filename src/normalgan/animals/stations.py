"""Stations: the cross sections of a long body, which is straight or bent sideways by a spine."""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike

from normalgan.animals.frames import Frame, about, pitch, yaw
from normalgan.animals.parts import in_space, tube
from normalgan.animals.shapes import Sweep
from normalgan.animals.tables import Column, Table
from normalgan.arrays import Doubles
from normalgan.errors import InputError


@dataclass(frozen=True, eq=False)
class Stations(Table):
    """Cross sections along a curve, with one value per column for each station.

    Args:
        x: (n,) forward coordinates of the centres; n ≥ 2.
        y: (n,) upward coordinates of the centres.
        radius: (n,) vertical radii.
        z: (n,) coordinates of the centres to the animal's right; None for the middle plane.
        half_width: (n,) horizontal radii; None for round sections.

    Raises:
        InputError: if the columns differ in length, or a section has no size.
    """

    x: Column
    y: Column
    radius: Column
    z: Column | None = None
    half_width: Column | None = None

    def __post_init__(self) -> None:
        """Check the columns."""
        _check_columns(self)
        if min(self.radius.min(), self.widths.min()) <= 0:
            raise InputError("radius and half_width are greater than 0.")

    @property
    def points(self) -> Doubles:
        """The centres, (n, 3)."""
        return np.column_stack([self.x, self.y, np.zeros(len(self.x)) if self.z is None else self.z])

    @property
    def widths(self) -> Doubles:
        """The horizontal radii, (n,)."""
        return self.radius if self.half_width is None else self.half_width


@dataclass(frozen=True, eq=False)
class Profile(Table):
    """Cross sections of a body along x, given by its outlines from the side and from above.

    Args:
        x: (n,) positions; n ≥ 2.
        top: (n,) heights of the upper edge.
        bottom: (n,) heights of the lower edge.
        half_width: (n,) half widths.

    Raises:
        InputError: if the columns differ in length, or a section has no size.
    """

    x: Column
    top: Column
    bottom: Column
    half_width: Column

    def __post_init__(self) -> None:
        """Check the columns."""
        _check_columns(self)
        if (self.top - self.bottom).min() <= 0 or self.half_width.min() <= 0:
            raise InputError("top is greater than bottom, and half_width than 0.")

    @property
    def stations(self) -> Stations:
        """The same sections, given by their centres."""
        middle, radius = (self.top + self.bottom) / 2, (self.top - self.bottom) / 2
        return Stations(self.x, middle, radius, half_width=self.half_width)

    def wider(self, factor: float) -> "Profile":
        """Return the profile with all widths multiplied by a factor."""
        return replace(self, half_width=self.half_width * factor)

    def at(self, x: float | Doubles) -> tuple[Doubles, Doubles, Doubles]:
        """Return top, bottom and half width, interpolated at a position or at (n,) positions."""
        columns = (self.top, self.bottom, self.half_width)
        top, bottom, half = (np.asarray(np.interp(x, self.x, column)) for column in columns)
        return top, bottom, half

    def sweep(self) -> Sweep:
        """Return the straight body."""
        stations = self.stations
        return tube(stations.points, stations.radius, stations.widths)

    def opened(self, degrees: float) -> Sweep:
        """Return the straight body, a lower jaw, rotated down about its first station."""
        hinge = (float(self.x[0]), float(self.top[0] + self.bottom[0]) / 2, 0.0)
        return self.sweep().placed(about(hinge, pitch(-degrees)))


class Spine:
    """A sideways bend, which maps points and frames of a straight body to the bent body.

    Args:
        xs: (n,) positions along the straight body.
        turns: (n,) rotations to the left at these positions, in degrees.
    """

    def __init__(self, xs: Doubles, turns: Doubles) -> None:
        self.xs, self.turns = xs, np.deg2rad(turns)
        steps = np.diff(xs)
        middle = (self.turns[1:] + self.turns[:-1]) / 2
        self.along = np.concatenate([[0.0], np.cumsum(steps * np.cos(middle))])
        self.aside = np.concatenate([[0.0], np.cumsum(-steps * np.sin(middle))])

    def frame(self, x: float) -> Frame:
        """Return the frame at position ``x``; the body continues straight beyond its ends."""
        at = float(np.clip(x, self.xs[0], self.xs[-1]))
        angle = float(np.interp(at, self.xs, self.turns))
        over = x - at
        along, aside = (np.interp(at, self.xs, column) for column in (self.along, self.aside))
        origin = np.array([along + over * np.cos(angle), 0.0, aside - over * np.sin(angle)])
        return Frame(origin, yaw(float(np.rad2deg(angle))))

    def place(self, points: ArrayLike) -> Doubles:
        """Map points (n, 3) or (n, 2) of the straight body to the bent one, (n, 3)."""
        return np.array([self.frame(float(x)).place([0.0, y, z]) for x, y, z in in_space(points)])

    def sweep(self, profile: Profile) -> Sweep:
        """Return the body of a profile, bent by the spine."""
        stations = profile.stations
        sides = np.array([self.frame(float(x)).rotation[:, 2] for x in stations.x])
        return Sweep(self.place(stations.points), stations.radius, stations.widths, sides)


def _check_columns(stations: Stations | Profile) -> None:
    columns = {each.name: getattr(stations, each.name) for each in fields(stations)}
    counts = {name: len(column) for name, column in columns.items() if column is not None}
    if len(set(counts.values())) > 1 or counts["x"] < 2:
        given = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise InputError(f"each column has one number a station, of two stations or more; {given}.")
