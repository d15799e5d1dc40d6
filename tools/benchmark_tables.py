"""Writes docs/benchmark_tables.md, the full tables of the benchmark, from the files in docs/results.

tools/benchmark_tables.py: writes the page, and the shipped weights' table in README.md and model_card.md
tools/benchmark_tables.py --show: prints the page instead
"""

import argparse
import json
import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

from normalgan.benchmark.cells import figure_cell, interval_cell, spread_of
from normalgan.benchmark.intervals import total_interval
from normalgan.benchmark.measure import OWN
from normalgan.files.writing import write_bytes

ROOT = Path(__file__).parents[1]
RESULTS, PAGE = ROOT / "docs" / "results", ROOT / "docs" / "benchmark_tables.md"
Runs = Sequence[Any]
"""The runs of one method, one per seed."""
Cell = Callable[[Runs], str]
INTRODUCTION = """# Benchmark: all tables

This page is the appendix of [the benchmark](benchmark.md). `python tools/benchmark_tables.py` writes it from
the files in `docs/results`, which also name the machine, the versions and the commit of each run.

- Errors are mean angular errors on the object, without the hinted pixels. The 15 or 50 hints are placed
  uniformly on the object; *own* hints come from the sampler that a method was trained with.
- ± is the standard deviation over the seeds, on the same meshes.
- Each difference is followed by its 95 % interval over meshes and seeds in brackets (Student's t, paired by
  both).
- To measure a section's figures again, run `tools/benchmark_runs.sh NAME` with the [FourLeg
  meshes](data.md#the-fourleg-meshes) in `meshes`.
"""


def read(name: str) -> Any:
    """Return the results with a name."""
    return json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8"))


def methods(results: Mapping[str, Any]) -> dict[str, list[Any]]:
    """Return each method's runs by the name of its row, in the order of the plan."""
    found: dict[str, list[Any]] = defaultdict(list)
    for run in results["runs"]:
        found[run["row"]].append(run)
    return found


def error(given: str, name: str = "angular_mean") -> Cell:
    """Return a cell that shows a figure of a method."""
    return figure_cell(given, name)


def beside(reference: Runs, given: str, other: str | None = None) -> Cell:
    """Return a cell that shows how much larger a method's error is than the reference's, with an interval.

    Args:
        reference: runs of the reference; if empty, the method itself is the reference.
        given: the hints of the method.
        other: the hints of the reference; None for the same hints.
    """

    def cell(runs: Runs) -> str:
        if runs is reference:
            return ""
        return interval_cell(total_interval(runs, reference or runs, given, "angular_mean", other), "+")

    return cell


def relief(reference: Runs, name: str) -> Cell:
    """Return a cell that shows how a method's relief or mask without hints differs from the reference's."""

    def cell(runs: Runs) -> str:
        found = total_interval(runs, reference, "0", name)
        return "" if found is None or runs is reference else "{:+.3f} [{:+.3f}, {:+.3f}]".format(*found)

    return cell


def pins(where: str, number: int) -> Cell:
    """Return a cell that shows the error after a number of pins, set one by one."""
    return lambda runs: f"{fmean(run['pins'][where][number] for run in runs):.2f}°"


def share(runs: Runs) -> str:
    """Return the smallest and the largest final share of the adversarial gradient."""
    found = [run["curve"][-1].get("train/adversarial_share") for run in runs]
    return "–" if None in found else f"{min(found):.2f} to {max(found):.2f}"


def table(rows: Mapping[str, Runs], columns: Mapping[str, Cell], first: str = "") -> list[str]:
    """Return the lines of a table.

    Args:
        rows: runs by the label of their row.
        columns: the function that formats each cell of a column, by the column's heading.
        first: heading of the labels.
    """
    lines = ["", f"| {first} | {' | '.join(columns)} |", f"| --- |{' ---: |' * len(columns)}"]
    return lines + [
        f"| {label} | {' | '.join(cell(runs) for cell in columns.values())} |" for label, runs in rows.items()
    ]


def labelled(rows: Mapping[str, Runs]) -> dict[str, Runs]:
    """Return the rows with labels as keys in place of names."""
    return {runs[0]["label"]: runs for runs in rows.values()}


def section(title: str, name: str, text: str, names: str | None = None) -> list[str]:
    """Return the beginning of a section: the heading, what was compared, and how to repeat it.

    Args:
        title: the heading.
        name: the name of the results that give the machine, the budget and the seeds.
        text: what was compared, in a sentence or two.
        names: the arguments of `tools/benchmark_runs.sh`; None for ``name``.
    """
    results = read(name)
    images = f"{results['images']:,}".replace(",", " ")
    seeds = len({run["seed"] for run in results["runs"]} - {None})
    where = f"Each method learns from {images} images of {results['size']} pixels, with {seeds} seeds and one"
    where += f" core per run ({results['machine']['processor']})."
    return ["", f"## {title}", "", text, f"{where} Repeat: `tools/benchmark_runs.sh {names or name}`."]


def comparison() -> list[str]:
    """Return the section on all methods at 64 pixels."""
    later = read("deepnormals_64")
    rows = ours_last(methods(read("benchmark_64")) | methods(later))
    lines = section("All methods", "benchmark_64", PUBLISHED)
    lines += [
        "The DeepNormals-like network was trained later, on as many of the same samples, on another processor"
    ]
    lines += [
        f"({later['machine']['processor']}; `tools/benchmark_runs.sh deepnormals_64`). There, the rows "
        "without training (`--rows constant,mean,inflation`) give the same figures, to 0.001°."
    ]
    return lines + table(labelled(rows), {**FIGURES, **less_the_paper(rows)}, "method")


def less_the_paper(rows: Mapping[str, Runs]) -> dict[str, Cell]:
    """Return the columns with the differences of trained methods from the paper's."""
    trained = [rows[name] for name in TRAINED if name in rows]
    return {
        f"{heading}, minus the paper": only(trained, cell)
        for heading, cell in differences(rows["paper"]).items()
    }


def only(methods: Sequence[Runs], cell: Cell) -> Cell:
    """Return a cell that is shown for these methods and empty for others."""
    return lambda runs: cell(runs) if any(runs is one for one in methods) else ""


def differences(reference: Runs) -> dict[str, Cell]:
    """Return the columns with the differences from a method: without hints, with 15, with its own hints."""
    return {
        "no hints": beside(reference, "0"),
        "15 hints": beside(reference, "15"),
        "own hints": beside(reference, OWN),
    }


def how_many(runs: Runs) -> str:
    """Return the number of hints per view that a method's own sampler gives."""
    return spread_of([runs[0]["figures"][OWN]["hints"]], 1)


FIGURES: dict[str, Cell] = {
    "no hints": error("0"),
    "15 hints": error("15"),
    "50 hints": error("50"),
    "median, 15": error("15", "angular_median"),
    "below 11.25°, 15": error("15", "below_11_25"),
    "own hints": error(OWN),
    "how many": how_many,
}
PUBLISHED = "The tests use the 5 test meshes of the published FourLeg split, with 40 views each."
TRAINED = ("pix2pix", "sketch2normal", "deepnormals-slim", "ours")
"""The methods other than the paper's, in the order of the tables."""
UNSEEN = {"foreign": "foreign meshes", "people": "bodies", "props": "things"}
"""The subjects other than FourLegs, by the ending of their plan's name."""
THREE = {"no hints": error("0"), "15 hints": error("15"), "50 hints": error("50")}


def larger() -> list[str]:
    """Return the section on 128 pixels: the test meshes, and subjects that no method has seen."""
    rows = ours_last(methods(read("benchmark_128")))
    lines = section("128 pixels", "benchmark_128", PUBLISHED)
    lines += table(labelled(rows), {**FIGURES, **less_the_paper(rows)}, "method")
    others = {kind: ours_last(methods(read(f"fourlegs_{kind}_128"))) for kind in UNSEEN}
    names = list(next(iter(others.values())))
    lines += [
        "",
        "The next table tests the same networks, which have seen nothing but FourLegs, on other subjects",
    ]
    lines += ["(`tools/benchmark_runs.sh fourlegs_foreign_128 fourlegs_people_128 fourlegs_props_128`):"]
    of = [(kind, given, heading) for kind in UNSEEN for given, heading in (("0", "no hints"), ("15", "15"))]
    columns = {f"{UNSEEN[kind]}, {heading}": across(others[kind], given) for kind, given, heading in of}
    lines += table({rows[name][0]["label"]: rows[name] for name in names}, columns, "method")
    trained = {name: rows[name] for name in TRAINED if name in rows}
    less = {f"{UNSEEN[kind]}, {heading}": across(others[kind], given, "paper") for kind, given, heading in of}
    return [
        *lines,
        "",
        "The same errors minus those of the paper's networks:",
        *table(labelled(trained), less, "method"),
    ]


def ours_last(rows: Mapping[str, Runs]) -> dict[str, Runs]:
    """Return runs by row with ours last, as in the plan, after rows that were added later."""
    return {name: rows[name] for name in sorted(rows, key=lambda name: name == "ours")}


def across(rows: Mapping[str, Runs], given: str, reference: str | None = None) -> Cell:
    """Return a cell that shows a method's error on other meshes, or its excess over the reference's."""
    cell = beside(rows[reference], given) if reference else error(given)
    return lambda runs: cell(rows[runs[0]["row"]])


def folds() -> list[str]:
    """Return the section on all 20 meshes."""
    rows = methods(read("folds_64"))
    text = "Each of the 20 FourLeg meshes is in the test split once."
    lines = section("All 20 meshes, five folds", "folds_64", text)
    figures = {heading: cell for heading, cell in FIGURES.items() if not heading.startswith("median")}
    lines += table(labelled(rows), {**figures, **less_the_paper(rows)}, "method")
    lines += ["", "Hints change the error by:"]
    gains = {f"{n} hints": beside((), str(n), "0") for n in (5, 10, 15, 20, 50)}
    lines += table(labelled(rows), gains, "method")
    by_mesh = f"On single meshes, ours leads by {lead(rows, '0')} without hints,"
    return [*lines, "", by_mesh, f"and by {lead(rows, '15')} with 15 hints."]


def lead(rows: Mapping[str, Runs], given: str) -> str:
    """Return the smallest and largest lead of ours over the paper by mesh, and in how many runs it leads."""
    pairs = [
        (ours["meshes"][given], paper["meshes"][given])
        for ours, paper in zip(rows["ours"], rows["paper"], strict=True)
    ]
    found = [[p[mesh]["angular_mean"] - o[mesh]["angular_mean"] for o, p in pairs] for mesh in pairs[0][0]]
    means, every = [fmean(one) for one in found], [each for one in found for each in one]
    ahead = sum(each > 0 for each in every)
    return f"{min(means):.1f} to {max(means):.1f}° ({ahead} of {len(every)} runs)"


def placement() -> list[str]:
    """Return the section on the placement and the number of hints."""
    rows = methods(read("placement_64"))
    names = {
        "uniform": "uniform",
        "curvature": "by curvature",
        "farthest": "far apart",
        "worst": "where the error is largest (oracle)",
    }
    text = (
        "The paper's networks were trained with exactly 3, 17 or 60 hints per view, and tested with other "
        "numbers of hints."
    )
    lines = section("Where hints lie, and how many", "placement_64", text)
    counts = {
        f"{n} {names[where]}": rows[f"paper-{where}-{n}"]
        for n in (3, 17, 60)
        for where in ("uniform", "curvature")
    }
    tested = {
        f"{n} {names[w]}": error(f"{w}-{n}") for w in ("uniform", "curvature") for n in (3, 10, 17, 30, 60)
    }
    lines += table(counts, {"no hints": error("0"), **tested}, "trained with")
    lines += [
        "",
        "The error of networks trained on hints by curvature, minus that of networks trained on as many "
        "uniform hints:",
    ]
    pairs = {str(n): rows[f"paper-curvature-{n}"] for n in (3, 17, 60)}
    uniform = {id(rows[f"paper-curvature-{n}"]): rows[f"paper-uniform-{n}"] for n in (3, 17, 60)}

    def beside_uniform(given: str) -> Cell:
        return lambda runs: beside(uniform[id(runs)], given)(runs)

    lines += table(
        pairs,
        {
            heading: beside_uniform(given)
            for heading, given in {"own hints": OWN, "15 uniform hints": "15", "no hints": "0"}.items()
        },
        "hints in training",
    )
    lines += [
        "",
        "The rows are four placements of 17 hints in training. The columns are the same placements in the "
        "test, and the differences from training on uniform hints:",
    ]
    matrix = {label: rows[f"paper-{where}-17"] for where, label in names.items()}
    tested = {label: error(f"{where}-17") for where, label in names.items()}
    less = differences(rows["paper-uniform-17"])
    tested |= {f"{heading}, minus uniform": cell for heading, cell in less.items()}
    lines += table(matrix, tested, "trained with")
    gains = [
        f"{n} hints: {beside((), f'uniform-{n}', '0')(rows['paper-uniform-17'])}" for n in (3, 10, 17, 30, 60)
    ]
    lines += ["", "Uniform hints change the error of the network that was trained with 17 of them by:"]
    return [*lines, "; ".join(gains) + "."]


def thresholds() -> list[str]:
    """Return the section on the curvature levels of training hints."""
    rows = methods(read("thresholds_64"))
    text = "The paper's networks were trained with exactly 17 hints per view on other curvature levels."
    lines = section("Thresholds of the curvature map", "thresholds_64", text)
    hints = {"no hints": "0", "17 uniform": "uniform-17", "own 17": OWN}
    columns = {heading: error(given) for heading, given in hints.items()}
    reference = rows["paper-curvature-17"]
    columns |= {f"{heading}, minus the paper's": beside(reference, given) for heading, given in hints.items()}
    labels = {"paper-uniform-17": "uniform", "paper-curvature-17": "127, 126: mild valleys, the paper's"}
    named = {labels.get(name, runs[0]["label"]): runs for name, runs in rows.items()}
    return lines + table(named, columns, "trained with hints on")


def critic() -> list[str]:
    """Return the section on the critic."""
    rows = methods(read("critic_64"))
    none = rows["none"]
    text = "The paper's networks are trained with several critic weights. The last checkpoint is measured."
    lines = section("The critic", "critic_64", text)
    columns = {
        "adversarial / reconstruction gradient": share,
        **THREE,
        "n_z, predicted − true": error("0", "nz_bias"),
        "change between pixels, predicted / true": error("0", "gradient_ratio"),
    }
    lines += table(labelled(rows), columns, "critic")
    lines += [
        "",
        "Differences from training without a discriminator. The last three columns are without hints:",
    ]
    others = {name: runs for name, runs in rows.items() if runs is not none}
    columns = {**differences(none), "n_z": relief(none, "nz_bias"), "change": relief(none, "gradient_ratio")}
    return lines + table(labelled(others), {**columns, "IoU": relief(none, "mask_iou")}, "critic")


def ablation() -> list[str]:
    """Return the section on the parts of our method."""
    rows = methods(read("ablation_64"))
    lines = section("Ours, one part changed", "ablation_64", "Each row changes one part of our method.")
    less = {f"{heading}, minus ours": cell for heading, cell in differences(rows["ours"]).items()}
    lines += table(labelled(rows), {**THREE, **less}, "method")
    lines += ["", "Our method with a patch critic, tested without hints:"]
    columns = {
        "adversarial / reconstruction gradient": share,
        "error": error("0"),
        "n_z, predicted − true": error("0", "nz_bias"),
        "change between pixels, predicted / true": error("0", "gradient_ratio"),
        "mask IoU": error("0", "mask_iou"),
        "confidence off by": error("0", "calibration_error"),
    }
    critics = {name: rows[name] for name in ("ours", "critic-tenth", "critic-1", "critic-10")}
    return lines + table(labelled(critics), columns, "method")


def drawings() -> list[str]:
    """Return the section on drawings that differ from the training drawings."""
    names = {
        "ablation_64": "suggestive contours, as in training",
        "lines_64": "ridges and valleys",
        "hand_25_64": "a hand of strength 0.25",
        "hand_50_64": "a hand of strength 0.5",
        "hand_100_64": "a hand of strength 1",
    }
    found = {label: methods(read(name)) for name, label in names.items()}
    trained = found["suggestive contours, as in training"]
    text = "The same trained networks were tested on other line styles and on an unsteady [hand](hand.md)."
    lines = section("Other drawings than in training", "lines_64", text, " ".join(list(names)[1:]))
    papers = {id(rows["ours"]): rows["paper"] for rows in found.values()}
    figures: dict[str, Cell] = {}
    for row, label in (("paper", "the paper"), ("ours", "ours")):
        for heading, cell in THREE.items():
            figures[f"{label}, {heading}"] = of_both(cell, row, papers)
    drawn = {label: rows["ours"] for label, rows in found.items()}
    lines += table(drawn, figures, "tested on")
    changes: dict[str, Cell] = {}
    for row, label in (("paper", "the paper"), ("ours", "ours")):
        for heading, given in (("no hints", "0"), ("15 hints", "15")):
            changes[f"{label}, {heading}"] = of_both(beside(trained[row], given), row, papers)
    less = {
        f"{heading}, ours minus the paper": lambda runs, given=given: beside(papers[id(runs)], given)(runs)
        for heading, given in {"no hints": "0", "15 hints": "15", "own hints": OWN}.items()
    }
    lines += ["", "The same errors minus those on drawings as in training, and our errors minus the paper's:"]
    return lines + table(drawn, {**changes, **less}, "tested on")


def of_both(cell: Cell, row: str, papers: Mapping[int, Runs]) -> Cell:
    """Return a cell of ours, or of the paper's runs tested on the same drawings."""
    return lambda runs: cell(papers[id(runs)] if row == "paper" else runs)


def people() -> list[str]:
    """Return the section on hints as people give them."""
    rows = methods(read("users_64"))
    text = "The networks of the first table get 15 hints, each turned by an angle or moved by pixels (of 64)."
    lines = section("Hints as people give them", "users_64", text)
    turned = {f"{n}°": error(f"degrees-{n}") for n in (5, 10, 15, 30)}
    moved = {f"{n} px": error(f"pixels-{n}") for n in (1, 2, 3, 6)}
    lines += table(
        labelled(rows), {"exact": error("15"), **turned, **moved, "no hints": error("0")}, "method"
    )
    lines += ["", "The same errors minus those with exact hints:"]
    less = {f"turned by {n}°": beside((), f"degrees-{n}", "15") for n in (15, 30)}
    less |= {f"moved by {n} px": beside((), f"pixels-{n}", "15") for n in (3, 6)}
    lines += table(labelled(rows), less, "method")
    lines += [
        "",
        "Here pins are set one by one, where the error is largest (an oracle) or where the studio suggests:",
    ]
    columns = {f"oracle: {n}": pins("worst", n) for n in (0, 1, 3, 10, 20)}
    columns |= {f"suggested: {n}": pins("suggested", n) for n in (0, 1, 3, 10, 20)}
    return lines + table(labelled(rows), columns, "method")


CARD = re.compile(r"^\| test set \|.*\n(?:\|.*\n)+", re.MULTILINE)
"""The table of the shipped weights on a page."""
CARDS = {"README.md": "foreign", "docs/model_card.md": ""}
"""The pages with such a table, and the beginning of its rows' labels."""
SHIPPED = {
    "foreign": "foreign: people and animals in all postures, statues, tools",
    "foreign_dressed": "foreign: clothed people",
    "foreign_things": "foreign: furniture, graveyard and space things",
    "fourlegs": "foreign: FourLeg test meshes",
    "animals": "same source: animals",
    "rigs": "same source: creatures and clothed people",
    "people": "same source: bodies",
    "props": "same source: props",
}
"""The test sets of the shipped weights by plan, first those from sources of no training mesh."""


def evaluations() -> dict[str, list[Any]]:
    """Return the results of the shipped weights by test set, for the sets measured so far."""
    known = {label: f"shipped_{plan}" for plan, label in SHIPPED.items()}
    return {label: [read(name)] for label, name in known.items() if (RESULTS / f"{name}.json").exists()}


def shipped() -> list[str]:
    """Return the section on the shipped weights."""
    found = evaluations()
    lines = [
        "",
        "## Shipped weights",
        "",
        "This table tests the [weights that come with the package](model_card.md) on meshes that they were",
        "not trained on. No training mesh comes from the sources of the *foreign* sets. The *same source*",
        "sets are by the artists of the training meshes. To measure a row again, run",
        "`tools/benchmark_runs.sh shipped_PLAN`. The",
        f"plans are {', '.join(SHIPPED)}.",
    ]
    counts = ("0", "5", "10", "15", "20", "50", "200")
    lines += table(found, {f"{n} hints" if n != "0" else "no hints": error(n) for n in counts}, "test set")
    columns = {
        "rim": error("0", "angular_rim"),
        "deep inside": error("0", "angular_deep"),
        "n_z, predicted − true": error("0", "nz_bias"),
        "mask IoU": error("0", "mask_iou"),
        "confidence off by": error("0", "calibration_error"),
        "median, 15 hints": error("15", "angular_median"),
        "below 11.25°, 15 hints": error("15", "below_11_25"),
    }
    return [
        *lines,
        "",
        "These figures are without hints, except in the last two columns:",
        *table(found, columns, "test set"),
    ]


def card(sets: str = "") -> list[str]:
    """Return the table for a page, with a row for each test set whose label begins with ``sets``."""
    columns = {"no hints": error("0"), "15 hints": error("15"), "mask IoU": error("0", "mask_iou")}
    shown = {label: runs for label, runs in evaluations().items() if label.startswith(sets)}
    return table(shown, columns, "test set")[1:]


def page() -> str:
    """Return the whole page."""
    parts: tuple[Callable[[], list[str]], ...] = (comparison, larger, folds, placement, thresholds)
    parts += (critic, ablation, drawings, people, shipped)
    return INTRODUCTION + "\n".join(line for part in parts for line in part()) + "\n"


def main() -> None:
    """Write or print the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("--show", action="store_true", help="print the page and write nothing")
    if parser.parse_args().show:
        print(page(), end="")
    else:
        write_bytes(PAGE, page().encode())
        for name, sets in CARDS.items():
            path = ROOT / name
            text = path.read_text(encoding="utf-8")
            write_bytes(path, CARD.sub("\n".join(card(sets)) + "\n", text, count=1).encode())


if __name__ == "__main__":
    main()
