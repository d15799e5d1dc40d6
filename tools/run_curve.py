"""Makes a picture of how a training went: tools/run_curve.py RUN PATH.

RUN is the folder of `normalgan fit`, with its event files; PATH the PNG. On the left the loss named angle,
in degrees: of single batches, and the mean of those logged last; on the right the errors on validation
after each epoch.
"""

import sys
from io import BytesIO
from math import degrees
from pathlib import Path

from matplotlib.figure import Figure
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator  # type: ignore[import-untyped]

from normalgan.files.writing import write_bytes

SMOOTHED = 25
"""Logged batches that a mean is taken over."""
VALIDATION = {"val/hints/angular_mean": "hints of training", "val/no_hints/angular_mean": "no hints"}

Curve = tuple[list[float], list[float]]
"""Minutes since the run began, and values."""


def curves(run: Path) -> dict[str, Curve]:
    """Return all figures that a run has logged, those of resumed parts one after the other."""
    events = EventAccumulator(str(run), size_guidance={"scalars": 0})
    events.Reload()
    found = {name: events.Scalars(name) for name in events.Tags()["scalars"]}
    if "train/angle" not in found:
        sys.exit(f"{run} holds no event files of a training with train/angle; give the folder of such a run.")
    began = min(points[0].wall_time for points in found.values())
    return {
        name: ([(point.wall_time - began) / 60 for point in points], [point.value for point in points])
        for name, points in found.items()
    }


def smoothed(values: list[float], count: int) -> list[float]:
    """Return the mean of each value and those before it, at most ``count`` in all.

    >>> smoothed([1.0, 3.0, 5.0], 2)
    [1.0, 2.0, 4.0]
    """
    windows = [values[max(end - count, 0) : end] for end in range(1, len(values) + 1)]
    return [sum(window) / len(window) for window in windows]


def picture(found: dict[str, Curve]) -> bytes:
    """Return a PNG of the two panels."""
    figure = Figure(figsize=(8, 3), dpi=100, layout="constrained")
    left, right = figure.subplots(1, 2)
    minutes, angles = found["train/angle"]
    left.plot(minutes, [degrees(angle) for angle in angles], ".", color="0.8", ms=3)
    left.plot(minutes, [degrees(angle) for angle in smoothed(angles, SMOOTHED)])
    left.set(xlabel="minutes", ylabel="training, °", title="with 0 to 200 hints, some turned")
    for name in filter(found.__contains__, VALIDATION):  # none before the first epoch is over
        right.plot(*found[name], "o-", ms=3, label=VALIDATION[name])
    right.set(xlabel="minutes", ylabel="validation, °", xlim=left.get_xlim())
    right.legend(frameon=False, fontsize=9)
    for panel in (left, right):
        panel.grid(color="0.9")
        panel.spines[["top", "right"]].set_visible(False)
    png = BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


if __name__ == "__main__":
    write_bytes(Path(sys.argv[2]), picture(curves(Path(sys.argv[1]))))
