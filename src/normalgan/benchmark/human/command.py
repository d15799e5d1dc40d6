"""normalgan benchmark --human: measures a model on drawings by people of objects whose normals are known."""

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import torch

from normalgan.benchmark.cost import describe_machine, describe_versions
from normalgan.benchmark.human.drawings import read_drawings
from normalgan.benchmark.human.evaluation import COUNTS, Measurement, measure_drawings
from normalgan.benchmark.intervals import mesh_interval
from normalgan.benchmark.pictures import Line, draw_methods
from normalgan.benchmark.table import figure_cell, interval_cell
from normalgan.benchmark.training import write_json
from normalgan.commit import commit
from normalgan.errors import InputError, did_you_mean
from normalgan.files.writing import write_bytes
from normalgan.inference.load import load

__all__ = ["human", "tables"]

_GALLERY = 6
_SEED = 0


def human(
    folder: Path, name: str, out: Path, groups: Sequence[str], say: Callable[[str], None]
) -> Measurement:
    """Measure a model on the drawings in a folder, and write results.json, table.md and gallery.png.

    Args:
        folder: folder with a ``drawings.json``; see `read_drawings`.
        name: name of the model's file, or ``shipped``.
        out: where the files go.
        groups: the groups of drawings to measure; empty for all.
        say: tells the user.

    Raises:
        InputError: if the folder or the model cannot be used.
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
    head: dict[str, Any] = {"model": name, "hint_seed": _SEED}
    head |= {"machine": describe_machine(torch.device("cpu")), "versions": describe_versions()}
    content = {**head, "commit": commit(), "groups": measured.groups}
    content |= {"drawings": measured.drawings, "left_out": measured.left_out}
    write_json(out / "results.json", content)
    text = tables(name, measured)
    write_bytes(out / "table.md", text.encode())
    bare, hinted = zip(*measured.shown, strict=True)
    lines = [Line("no hints", bare), Line(f"{COUNTS[-1]} hints", hinted)]
    write_bytes(out / "gallery.png", draw_methods(lines, f"drawings by people, {name}"))
    say(f"\n{text}")
    say(f"Report: {out.resolve()}")
    return measured


def tables(model: str, measured: Measurement) -> str:
    """Return the figures as Markdown: by group, and by drawing."""
    most = str(COUNTS[-1])
    headings = ["drawings", "drawings", "objects", "no hints", "95 % over objects", f"{most} hints"]
    headings += ["95 % over objects", "median, no hints", "where both are, no hints", "mask IoU"]
    headings += ["calibration error"]
    lines = [f"# Drawings by people: {model}", ""]
    lines += [
        "Mean angular error on the object; where nothing is painted it is 90°. Hints are the true normals at "
        "points uniform on the object; hinted pixels do not count. *Where both are* leaves out what is not "
        "painted.",
        "",
        f"| {' | '.join(headings)} |",
        f"| --- |{' ---: |' * (len(headings) - 1)}",
    ]
    for name, group in measured.groups.items():
        of_group = [one for one in measured.drawings if one["group"] == name]
        shared = [one["figures"]["0"]["angular_shared"] for one in of_group]
        known = [value for value in shared if value is not None]
        cells = [name, str(len(of_group)), str(len(group["meshes"]["0"]))]
        for given in ("0", most):
            interval = mesh_interval([group], given, "angular_mean")
            cells += [figure_cell(given, "angular_mean")([group]), interval_cell(interval)]
        cells += [figure_cell("0", "angular_median")([group])]
        cells += [f"{sum(known) / len(known):.2f}°" if known else "–", figure_cell("0", "mask_iou")([group])]
        cells += [figure_cell("0", "calibration_error")([group])]
        lines.append(f"| {' | '.join(cells)} |")
    if measured.left_out:
        lines += [
            "",
            f"{len(measured.left_out)} notes on what is left out, all in results.json; the first:",
            "",
        ]
        lines += [f"- {sentence}" for sentence in measured.left_out[:5]]
    lines += ["", "## By drawing", ""]
    lines += [f"| drawing | group | no hints | {most} hints | where both are | mask IoU |"]
    lines += ["| --- | --- | ---: | ---: | ---: | ---: |"]
    for one in measured.drawings:
        bare, hinted = one["figures"]["0"], one["figures"][most]
        shown = [_degrees(bare["angular_mean"]), _degrees(hinted["angular_mean"])]
        shown += [_degrees(bare["angular_shared"]), f"{bare['mask_iou']:.3f}"]
        lines.append(f"| {one['name']} | {one['group']} | {' | '.join(shown)} |")
    return "\n".join(lines) + "\n"


def _degrees(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}°"
