"""Cells of a benchmark's tables: format a method's figure as mean ± spread over its seeds."""

from collections.abc import Callable, Sequence
from math import isnan, nan
from statistics import mean, stdev

from normalgan.benchmark.intervals import Interval
from normalgan.benchmark.training import Result
from normalgan.gan import ADVERSARIAL_SHARE
from normalgan.metrics.base import unit_of

Cell = Callable[[Sequence[Result]], str]
"""A function that returns the text of a cell from the runs of a row, one per seed."""


def spread_of(values: Sequence[float | None], digits: int, unit: str = "", sign: str = "") -> str:
    """Return the mean of the values, with the sample standard deviation if there are several.

    Args:
        values: the values; if there are none, or one is None or NaN, a dash is returned.
        digits: digits after the point.
        unit: unit after the number.
        sign: ``+`` to mark positive means.

    >>> spread_of([1.0, 2.0, 3.0], 1, "°"), spread_of([0.25], 3, sign="+"), spread_of([None], 1)
    ('2.0 ± 1.0°', '+0.250', '–')
    """
    known = [nan if value is None else value for value in values]
    if not known or any(map(isnan, known)):
        return "–"
    deviation = f" ± {stdev(known):.{digits}f}" if len(known) > 1 else ""
    return f"{mean(known):{sign}.{digits}f}{deviation}{unit}"


def large(value: float) -> str:
    """Return a large number with three digits and a unit prefix.

    >>> [large(v) for v in (0, 950, 54414979, 18.2e9, 2e12)]
    ['–', '950', '54.4 M', '18.2 G', '2.00 T']
    """
    if value == 0:
        return "–"
    for unit, size in (("T", 1e12), ("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if value >= size:
            shown = value / size
            return f"{shown:.{2 if shown < 10 else 1 if shown < 100 else 0}f} {unit}"
    return f"{value:.0f}"


def interval_cell(interval: Interval | None, sign: str = "") -> str:
    """Return an interval in degrees as text.

    >>> interval_cell(Interval(16.7, 15.9, 17.4)), interval_cell(Interval(-1.5, -2.0, -1.0), "+")
    ('16.70° [15.90, 17.40]', '-1.50° [-2.00, -1.00]')
    >>> interval_cell(None)
    '–'
    """
    if interval is None:
        return "–"
    value, low, high = (f"{number:{sign}.2f}" for number in interval)
    return f"{value}° [{low}, {high}]"


def figure_cell(given: str, name: str, unit: str | None = None) -> Cell:
    """Return the cell of a figure.

    Args:
        given: hints that the method was given, such as ``15`` or ``own``.
        name: name of the figure, such as ``angular_mean``; angles are in degrees, fractions in per cent.
        unit: unit of a plug-in's metric, ``%`` for a fraction; None for built-in figures.
    """
    unit = unit_of(name) if unit is None else unit

    def cell(runs: Sequence[Result]) -> str:
        values = [run["figures"].get(given, {}).get(name) for run in runs]
        if unit == "%":
            return spread_of([None if value is None else 100 * value for value in values], 1, " %")
        return spread_of(values, 2 if unit else 3, unit, "+" if name.startswith("nz") else "")

    return cell


def distance_cell(given: str, low: float) -> Cell:
    """Return the cell of the mean error in the bin that starts ``low`` 170ths of the picture inside."""

    def cell(runs: Sequence[Result]) -> str:
        profiles = [run.get("distance", {}).get(given, {}).get("170ths", ()) for run in runs]
        return spread_of(
            [one["angular_mean"] for bins in profiles for one in bins if one["from"] == low], 1, "°"
        )

    return cell


def pin_cell(strategy: str, number: int) -> Cell:
    """Return the cell of the mean error after a strategy has placed a number of pins, one at a time."""
    return lambda runs: spread_of([run["pins"][strategy][number] for run in runs if "pins" in run], 2, "°")


def share_cell(index: int) -> Cell:
    """Return the cell of the adversarial fraction of the gradient at a point of the learning curve."""

    def cell(runs: Sequence[Result]) -> str:
        values = [run["curve"][index].get(ADVERSARIAL_SHARE) for run in runs if run["curve"]]
        return f"{mean(values):.1e}" if values and not any(v is None or isnan(v) for v in values) else "–"

    return cell


def cost_cells() -> dict[str, Cell]:
    """Return the cells of the cost of a method, by heading."""
    return {
        "parameters": lambda runs: large(runs[0]["cost"]["parameters"]),
        "FLOPs a map": lambda runs: large(runs[0]["cost"]["flops"]),
        "maps a second": _speed,
        "images learnt from": lambda runs: large(mean(run["images"] for run in runs)),
        "minutes of training": lambda runs: spread_of(
            [run["curve"][-1]["seconds"] / 60 for run in runs if run["curve"]], 1
        ),
    }


def _speed(runs: Sequence[Result]) -> str:
    speed = mean(run["cost"]["images_per_second"] for run in runs)
    return f"{speed:.1f}" if speed else "–"  # submissions have no speed
