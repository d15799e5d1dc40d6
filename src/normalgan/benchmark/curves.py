"""The curves of a benchmark: error against what was learnt from, and against the number of hints."""

from collections.abc import Iterable, Sequence
from io import BytesIO

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from normalgan.benchmark.plan import Plan
from normalgan.benchmark.table import Results
from normalgan.benchmark.training import Result

__all__ = ["VALIDATION", "draw_curves", "hint_curve", "learning_curve"]

VALIDATION = "val/hints/angular_mean"
_REFERENCE = "0.25"  # grey


def draw_curves(plan: Plan, results: Results, caption: str) -> bytes | None:
    """Return the curves as a PNG, a line of two panels for each group of rows; None if nothing is trained.

    Lines are means over the seeds, bands reach from the lowest seed to the highest. The reference of the
    plan is in every panel, dashed.

    Args:
        plan: in whose order the rows come.
        results: of the rows.
        caption: above them.
    """
    groups: dict[str, list[str]] = {}
    for row in plan.rows:
        if not row.classical and row.name in results:
            groups.setdefault(row.group, []).append(row.name)
    if not groups:
        return None
    figure = Figure(figsize=(11, 0.6 + 3.7 * len(groups)), dpi=100, layout="constrained")
    figure.suptitle(caption, fontsize=11)
    panels = figure.subplots(len(groups), 2, squeeze=False, sharey="row")
    for (group, names), (learning, hinted) in zip(groups.items(), panels, strict=True):
        palette = colormaps["tab10" if len(names) <= 10 else "tab20"]
        colours: dict[str, object] = {name: palette(i) for i, name in enumerate(names)}
        if plan.reference in results:
            colours[str(plan.reference)] = _REFERENCE
        for name, colour in colours.items():
            label, style = plan.row(name).label, "--" if colour == _REFERENCE else "-"
            _draw(learning, *learning_curve(results[name]), colour, style, label)
            _draw(hinted, *hint_curve(results[name], plan.counts), colour, style, label, marker="o")
        learning.set(xlabel="images the generator has learnt from", ylabel="mean error, °")
        learning.xaxis.set_major_formatter(lambda images, _: f"{images / 1000:g} k" if images else "0")
        # In two lines, as a long one would run into the other panel's.
        learning.set_title(f"{group}:\nvalidation, each with its own hints", loc="left", fontsize=10)
        hinted.set(xlabel="hints, uniform on the object", xticks=plan.counts)
        hinted.set_title("test", loc="left", fontsize=10)
        for panel in (learning, hinted):
            panel.grid(color="0.9")
            panel.spines[["top", "right"]].set_visible(False)
        hinted.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=9)
    png = BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


def learning_curve(runs: Iterable[Result]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return images (K,) and errors (seeds, K); runs of unequal length are read off at the longest's images.

    Under a budget of time no two runs are alike; where a run has ended, its line has too (nan).
    """
    curves = [
        np.array([(record["images"], record[VALIDATION]) for record in run["curve"]], float).T for run in runs
    ]
    longest = max(curves, key=lambda curve: curve[0, -1])[0]
    errors = [np.interp(longest, images, error, left=np.nan, right=np.nan) for images, error in curves]
    return longest, np.array(errors)


def hint_curve(
    runs: Iterable[Result], counts: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return numbers of hints (K,) and errors (seeds, K)."""
    errors = [[run["figures"][str(count)]["angular_mean"] for count in counts] for run in runs]
    return np.array(counts, float), np.array(errors, float)


def _draw(
    axes: Axes,
    x: NDArray[np.float64],
    errors: NDArray[np.float64],
    colour: object,
    style: str,
    label: str,
    marker: str | None = None,
) -> None:
    shown = np.isfinite(errors).any(axis=0)
    x, errors = x[shown], errors[:, shown]
    axes.plot(x, np.nanmean(errors, axis=0), style, color=colour, label=label, marker=marker, ms=3.5, lw=1.5)
    if len(errors) > 1:
        low, high = np.nanmin(errors, axis=0), np.nanmax(errors, axis=0)
        axes.fill_between(x, low, high, color=colour, alpha=0.15, lw=0)
