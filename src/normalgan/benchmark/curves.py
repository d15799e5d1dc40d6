"""Curves of a benchmark: plot the error by training images and by hints, and the calibration."""

from collections.abc import Iterable, Sequence
from io import BytesIO

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from normalgan.arrays import Doubles
from normalgan.benchmark.plan import Plan
from normalgan.benchmark.training import Result, Results
from normalgan.metrics.calibration import BIN

VALIDATION = "val/hints/angular_mean"
_REFERENCE = "0.25"  # grey


def draw_curves(plan: Plan, results: Results, caption: str) -> bytes | None:
    """Return the curves as a PNG, two panels per group of rows; None if no row is trained.

    Lines are means over the seeds, and bands range from the lowest to the highest seed. The plan's reference
    is a dashed line in every panel.
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
            if not plan.row(name).classical:  # the reference may not be trained
                _draw(learning, *learning_curve(results[name]), colour, style, label)
            _draw(hinted, *hint_curve(results[name], plan.counts), colour, style, label, marker="o")
        learning.set(xlabel="images the generator has learnt from", ylabel="mean error, °")
        learning.xaxis.set_major_formatter(lambda images, _: f"{images / 1000:g} k" if images else "0")
        # In two lines, because a long line would reach into the other panel.
        learning.set_title(f"{group}:\nvalidation, each with its own hints", loc="left", fontsize=10)
        hinted.set(xlabel="hints, uniform on the object", xticks=plan.counts)
        hinted.set_title("test", loc="left", fontsize=10)
        for panel in (learning, hinted):
            panel.grid(color="0.9")
            panel.spines[["top", "right"]].set_visible(False)
        hinted.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=9)
    return _png(figure)


def draw_calibration(plan: Plan, results: Results, caption: str) -> bytes | None:
    """Return the calibration curves as a PNG: observed error by predicted error; None without confidences.

    There is one panel without hints and one with the hints of table 1, each with a line per row over all
    seeds and the fraction of pixels below. A model on the diagonal is calibrated; above it, it is
    overconfident. The legend lists the expected calibration errors.
    """
    sure = [row for row in plan.rows if any(_promises(run) for run in results.get(row.name, ()))]
    if not sure:
        return None
    figure = Figure(figsize=(11, 5.2), dpi=100, layout="constrained")
    figure.suptitle(caption, fontsize=11)
    panels = figure.subplots(2, 2, sharex=True, sharey="row", height_ratios=[3, 1])
    palette = colormaps["tab10" if len(sure) <= 10 else "tab20"]
    for column, count in enumerate((0, plan.hints)):
        above, below = panels[0, column], panels[1, column]
        above.plot([0, 90], [0, 90], color=_REFERENCE, lw=1, ls=":")
        for i, row in enumerate(sure):
            runs = [run for run in results[row.name] if _promises(run)]
            promised, observed, share = calibration_curve(runs, str(count))
            off = [run["figures"][str(count)].get("calibration_error") for run in runs]
            known = [value for value in off if value is not None]
            label = f"{row.label}: {sum(known) / len(known):.1f}° off" if known else row.label
            above.plot(promised, observed, color=palette(i), marker="o", ms=3, lw=1.5, label=label)
            below.plot(promised, 100 * share, color=palette(i), lw=1.5)
        title = "no hints" if count == 0 else f"{count} hints"
        above.set_title(title, loc="left", fontsize=10)
        above.set(ylabel="mean error observed, °", xlim=(0, 90), ylim=(0, 90))
        below.set(xlabel="error that the confidence promises, °", ylabel="% of pixels", ylim=(0, None))
        above.legend(loc="upper left", frameon=False, fontsize=8)
        for panel in (above, below):
            panel.grid(color="0.9")
            panel.spines[["top", "right"]].set_visible(False)
    return _png(figure)


def _png(figure: Figure) -> bytes:
    png = BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


def calibration_curve(runs: Iterable[Result], given: str) -> tuple[Doubles, Doubles, Doubles]:
    """Return predicted and observed error in degrees and the fraction of pixels, each (K,), over all runs."""
    bins: dict[int, Doubles] = {}
    for run in runs:
        for one in run["calibration"][given] or ():
            sums = one["pixels"] * np.array([1.0, one["predicted"], one["observed"]])
            place = int(one["predicted"] // BIN)
            bins[place] = bins.get(place, np.zeros(3)) + sums
    count, promised, observed = np.array([bins[place] for place in sorted(bins)]).T
    return promised / count, observed / count, count / count.sum()


def _promises(run: Result) -> bool:
    """Return whether the figures of a run have a calibration curve; older figures have none."""
    return any(run.get("calibration", {}).values())


def learning_curve(runs: Iterable[Result]) -> tuple[Doubles, Doubles]:
    """Return images (K,) and errors (seeds, K), interpolated at the images of the longest run.

    With a time budget, runs differ in length; shorter runs are padded with NaN.
    """
    curves = [
        np.array([(record["images"], record[VALIDATION]) for record in run["curve"]], float).T for run in runs
    ]
    longest = max(curves, key=lambda curve: curve[0, -1])[0]
    errors = [np.interp(longest, images, error, left=np.nan, right=np.nan) for images, error in curves]
    return longest, np.array(errors)


def hint_curve(runs: Iterable[Result], counts: Sequence[int]) -> tuple[Doubles, Doubles]:
    """Return the numbers of hints (K,) and the errors (seeds, K)."""
    errors = [[run["figures"][str(count)]["angular_mean"] for count in counts] for run in runs]
    return np.array(counts, float), np.array(errors, float)


def _draw(
    axes: Axes, x: Doubles, errors: Doubles, colour: object, style: str, label: str, marker: str | None = None
) -> None:
    shown = np.isfinite(errors).any(axis=0)
    x, errors = x[shown], errors[:, shown]
    axes.plot(x, np.nanmean(errors, axis=0), style, color=colour, label=label, marker=marker, ms=3.5, lw=1.5)
    if len(errors) > 1:
        low, high = np.nanmin(errors, axis=0), np.nanmax(errors, axis=0)
        axes.fill_between(x, low, high, color=colour, alpha=0.15, lw=0)
