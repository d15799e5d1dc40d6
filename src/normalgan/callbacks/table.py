"""The table of `normalgan test`, with one row per metric and one column per method."""

from collections.abc import Mapping, Sequence
from io import StringIO
from math import isnan

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from normalgan.metrics import MapMetric
from normalgan.metrics.base import unit_of

Results = Mapping[str, Mapping[str, float]]
"""Metrics by column and by name, such as ``results["hints"]["angular_mean"]``."""

HEADINGS = {
    "constant": "constant",
    "mean_map": "mean map",
    "no_hints": "no hints",
    "hints": "hints",
    "off_hints": "off hints",
}
FIGURES = {
    "angular_mean": "mean angular error",
    "angular_median": "median",
    "angular_rmse": "root mean square",
    "angular_mean_per_image": "mean over images",
    "below_5": "below 5°",
    "below_7_5": "below 7.5°",
    "below_11_25": "below 11.25°",
    "below_22_5": "below 22.5°",
    "below_30": "below 30°",
    "l1": "L1",
    "l2": "L2",
    "mask_iou": "mask IoU",
    "coverage": "coverage",
}
_NOTE = """\
Pixels on the object. constant: (0, 0, 1) everywhere; mean map: the mean of the
training split; neither sees the sketch. off hints: with the same hints, the
hinted pixels left out. mask IoU: of where an object is predicted (a vector
longer than 1/2) and where it is; coverage: the share of the object that is."""


def results_table(results: Results, title: str, more: Sequence[MapMetric] = ()) -> str:
    """Return the table of results as text of at most 80 columns.

    Args:
        results: columns by name, each with all metrics; missing columns are left out.
        title: title line above the table.
        more: extra metrics, listed after the built-in ones.

    >>> print(results_table({"hints": dict.fromkeys(FIGURES, 0.25)}, "Two samples").split("L1")[1].split()[0])
    0.250
    """
    table = Table(title=title, title_justify="left", title_style="", box=SIMPLE_HEAD, pad_edge=False)
    columns = [key for key in HEADINGS if key in results]
    table.add_column("")
    for key in columns:
        table.add_column(HEADINGS[key], justify="right")
    for figure, label in FIGURES.items():
        table.add_row(label, *(_written(results[key][figure], unit_of(figure)) for key in columns))
    for metric in more:
        values = [results[key][metric.figure] for key in columns]
        table.add_row(metric.label or metric.figure, *(_written(value, metric.unit) for value in values))
    text = StringIO()
    Console(file=text, width=80, color_system=None).print(table)
    return "\n".join(line.rstrip() for line in text.getvalue().strip("\n").splitlines()) + f"\n{_NOTE}"


def _written(value: float, unit: str) -> str:
    if isnan(value):  # nothing was measured, for example because every pixel is hinted
        return "–"
    if unit == "%":
        return f"{value:.1%}"
    return f"{value:.2f}{unit}" if unit else f"{value:.3f}"
