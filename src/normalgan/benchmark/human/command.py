"""normalgan benchmark --human: measure a model on drawings by people of objects with known normals."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import torch

from normalgan.benchmark.cells import figure_cell, interval_cell, spread_of
from normalgan.benchmark.cost import describe_origin
from normalgan.benchmark.human.drawings import read_drawings
from normalgan.benchmark.human.evaluation import COUNTS, Measurement, measure_drawings
from normalgan.benchmark.intervals import mesh_interval
from normalgan.benchmark.pictures import Line, draw_methods
from normalgan.benchmark.table import markdown_table
from normalgan.benchmark.training import write_json
from normalgan.errors import InputError, did_you_mean
from normalgan.files.writing import write_bytes
from normalgan.inference.load import load

_GALLERY = 6
_SEED = 0
_NOTES = (
    "Mean angular error on the object; where nothing is painted it is 90°. Hints are the true normals at "
    "points uniform on the object; hinted pixels do not count. *Where both are* leaves out what is not "
    "painted."
)


def human(
    folder: Path, name: str, out: Path, groups: Sequence[str], say: Callable[[str], None]
) -> Measurement:
    """Measure a model on the drawings in a folder; write results.json, table.md and gallery.png to ``out``.

    See `read_drawings` for the folder. The model is a file or ``shipped``. Without ``groups``, all groups are
    measured.

    Raises:
        InputError: if the folder or the model is invalid.
    """
    listed, left_out = read_drawings(folder)
    known = Counter(drawing.group for drawing in listed)
    for group in groups:
        if group not in known:
            raise InputError(
                f"{folder} has no drawings {group!r}; it has {', '.join(sorted(known))}."
                f"{did_you_mean(group, known)}"
            )
    drawings = [drawing for drawing in listed if not groups or drawing.group in groups]
    say(f"{len(drawings)} drawings in {folder}")
    measured = measure_drawings(drawings, load(name), _SEED, _GALLERY, say)
    measured.left_out = [*left_out, *measured.left_out]
    if not measured.drawings:
        raise InputError(f"none of the drawings in {folder} can be measured; {measured.left_out[0]}")
    head = {"model": name, "hint_seed": _SEED, **describe_origin(torch.device("cpu"))}
    figures = {"groups": measured.groups, "drawings": measured.drawings, "left_out": measured.left_out}
    write_json(out / "results.json", {**head, **figures})
    text = tables(name, measured)
    write_bytes(out / "table.md", text.encode())
    bare, hinted = zip(*measured.shown, strict=True)
    lines = [Line("no hints", bare), Line(f"{COUNTS[-1]} hints", hinted)]
    write_bytes(out / "gallery.png", draw_methods(lines, f"drawings by people, {name}"))
    say(f"\n{text}")
    say(f"Report: {out.resolve()}")
    return measured


def tables(model: str, measured: Measurement) -> str:
    """Return the figures by group and by drawing, as Markdown."""
    most = str(COUNTS[-1])
    headings = ["drawings", "drawings", "objects", "no hints", "95 % over objects", f"{most} hints"]
    headings += ["95 % over objects", "median, no hints", "where both are, no hints", "mask IoU"]
    headings += ["calibration error"]
    lines = [f"# Drawings by people: {model}", "", _NOTES, ""]
    lines += markdown_table(headings, [_group_row(name, measured) for name in measured.groups])
    if left_out := measured.left_out:
        lines += ["", f"{len(left_out)} notes on what is left out, all in results.json; the first:", ""]
        lines += [f"- {sentence}" for sentence in left_out[:5]]
    lines += ["", "## By drawing", ""]
    headings = ["drawing", "group", "no hints", f"{most} hints", "where both are", "mask IoU"]
    lines += markdown_table(headings, map(_drawing_row, measured.drawings), names=2)
    return "\n".join(lines) + "\n"


def _group_row(name: str, measured: Measurement) -> list[str]:
    group = measured.groups[name]
    of_group = [one for one in measured.drawings if one["group"] == name]
    shared = [one["figures"]["0"]["angular_shared"] for one in of_group]
    known = [value for value in shared if value is not None]
    cells = [name, str(len(of_group)), str(len(group["meshes"]["0"]))]
    for given in ("0", str(COUNTS[-1])):
        interval = mesh_interval([group], given, "angular_mean")
        cells += [figure_cell(given, "angular_mean")([group]), interval_cell(interval)]
    cells += [figure_cell("0", "angular_median")([group]), spread_of(known and [fmean(known)], 2, "°")]
    return cells + [figure_cell("0", name)([group]) for name in ("mask_iou", "calibration_error")]


def _drawing_row(one: Mapping[str, Any]) -> list[str]:
    bare, hinted = one["figures"]["0"], one["figures"][str(COUNTS[-1])]
    errors = [bare["angular_mean"], hinted["angular_mean"], bare["angular_shared"]]
    return [one["name"], one["group"], *(spread_of([e], 2, "°") for e in errors), f"{bare['mask_iou']:.3f}"]
