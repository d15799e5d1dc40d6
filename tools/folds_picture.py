"""Draws the errors on each test mesh of all folds: tools/folds_picture.py RESULTS PATH.

RESULTS is the output of `tools/join_folds.py -o`, and PATH the PNG to write.
"""

import json
import sys
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from statistics import fmean
from typing import Any

from matplotlib import colormaps
from matplotlib.figure import Figure

from normalgan.files.writing import write_bytes

GIVEN = {"0": "no hints", "15": "15 uniform hints"}


def picture(results: Mapping[str, Any]) -> bytes:
    """Return a PNG with a panel for each number of hints: a dot per seed, and a line through their mean.

    Meshes are in the order of the first row's errors.

    Args:
        results: the joined results of the folds.
    """
    rows: dict[str, list[Any]] = {}
    for run in results["runs"]:
        rows.setdefault(run["label"], []).append(run)
    figure = Figure(figsize=(9, 5.6), dpi=100, layout="constrained")
    panels = figure.subplots(len(GIVEN), 1, sharex=True)
    first = next(iter(rows.values()))
    order = sorted(first[0]["meshes"]["0"], key=lambda mesh: mean(first, "0", mesh))
    for (given, title), panel in zip(GIVEN.items(), panels, strict=True):
        for (label, runs), colour in zip(rows.items(), colormaps["tab10"](range(10)), strict=False):
            for run in runs:
                panel.plot([run["meshes"][given][m]["angular_mean"] for m in order], "o", color=colour, ms=3)
            panel.plot([mean(runs, given, m) for m in order], color=colour, lw=1, label=label)
        panel.set(ylabel="mean error, °", ylim=(0, None))
        panel.set_title(title, loc="left", fontsize=10)
        panel.grid(color="0.9")
        panel.spines[["top", "right"]].set_visible(False)
    panels[0].legend(frameon=False, fontsize=9)
    panels[-1].set_xticks(range(len(order)), order, rotation=90)
    panels[-1].set_xlabel("test mesh, each in the fold in which nothing was trained on it")
    png = BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


def mean(runs: list[Any], given: str, mesh: str) -> float:
    """Return the error of a mesh, averaged over the seeds."""
    return fmean(run["meshes"][given][mesh]["angular_mean"] for run in runs)


if __name__ == "__main__":
    found = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    write_bytes(Path(sys.argv[2]), picture(found))
