import json
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from normalgan.benchmark.curves import (
    VALIDATION,
    calibration_curve,
    draw_calibration,
    draw_curves,
    hint_curve,
    learning_curve,
)
from normalgan.benchmark.evaluation import read_curve
from normalgan.benchmark.measure import OWN
from normalgan.benchmark.pictures import Line, draw_methods
from normalgan.benchmark.plan import Plan, Row
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.table import FIGURES, markdown, mesh_table
from normalgan.callbacks.gallery import Row as Sample
from normalgan.gan import ADVERSARIAL_SHARE

ROWS = [
    Row("mean", "the mean", group="Simple", classical="mean"),
    Row("paper", "the paper", group="Learnt", configs=["a.yaml"]),
    Row("ours", "ours", group="Learnt", configs=["b.yaml"]),
]
PLAN = Plan("A plan", 100, ROWS, hint_counts=[0, 5], hints=15, reference="paper")


def result(seed: int | None, error: float | None, **more: Any) -> dict[str, Any]:
    figures: dict[str, dict[str, float | None]] = {}
    for i, given in enumerate(("0", "5", "15", OWN)):
        figures[given] = {**dict.fromkeys(FIGURES, 0.25), "hints": 7.0}
        figures[given]["angular_mean"] = None if error is None else error - i
    cost = {"parameters": 1_234_567, "flops": 2_500_000_000, "images_per_second": 12.34}
    curve = [
        {"images": 50, "seconds": 30.0, VALIDATION: 40.0},
        {"images": 100, "seconds": 60.0, VALIDATION: 30.0},
    ]
    machine = {"cores": 2, "processor": "P", "threads": 1}
    base = {"seed": seed, "figures": figures, "cost": cost, "curve": curve, "images": 100, "machine": machine}
    return base | more


def line(text: str, heading: str, label: str) -> list[str]:
    """Return the cells of a row of the table under a heading."""
    (table,) = (part for part in text.split("\n## ") if part.startswith(heading))
    (found,) = (line for line in table.splitlines() if line.startswith(f"| {label} |"))
    return [cell.strip() for cell in found.strip("|").split("|")][1:]


def test_cells_are_mean_and_spread_over_the_seeds() -> None:
    results = {"paper": [result(0, 20.0), result(1, 22.0), result(2, 27.0)]}
    text = markdown(PLAN, Scale("cpu"), results)
    assert text.startswith("# A plan, scale cpu\n\n100 images a generator.\nSeeds: 0, 1, 2.")
    first = line(text, "Table 1: 15 hints", "the paper")
    assert first[0] == "21.00 ± 3.61°"  # 20, 22, 27 less 2: the third of what was given
    assert first[3] == "25.0 ± 0.0 %"
    assert first[-3] == "0.250 ± 0.000"
    assert line(text, "Table 1, without hints", "the paper")[0] == "23.00 ± 3.61°"
    assert line(text, "Table 2", "the paper")[:2] == ["7.0 ± 0.0", "20.00 ± 3.61°"]
    assert line(text, "Mean angular error", "the paper") == [
        "23.00 ± 3.61°",
        "22.00 ± 3.61°",
        "21.00 ± 3.61°",
    ]
    assert line(text, "What it costs", "the paper") == ["1.23 M", "2.50 G", "12.3", "100", "1.0 ± 0.0"]


def test_missing_rows_are_left_out_and_missing_figures_are_dashes() -> None:
    nothing = result(
        None, None, curve=[], images=0, cost={"parameters": 0, "flops": 0, "images_per_second": 5.0}
    )
    text = markdown(PLAN, Scale("gpu", given={"data": {"size": 64}}, seconds=480.0), {"mean": [nothing]})
    assert "480 seconds a run.\nWith data.size=64.\nSeeds: none." in text
    assert "the paper" not in text
    assert "*Learnt*" not in text
    assert line(text, "Table 1: 15 hints", "the mean")[0] == "–"
    assert line(text, "What it costs", "the mean") == ["–", "–", "5.0", "–", "–"]


def test_the_specification_stands_above_the_tables() -> None:
    specification: dict[str, str | int] = {"size": 64, "meshes": "d373b18e859b", "hints": "c83a6ceb5202"}
    text = markdown(PLAN, Scale("cpu"), {"paper": [result(0, 20.0)]}, specification)
    said = "(reports with the same are comparable): size 64, meshes d373b18e859b, hints c83a6ceb5202."
    assert said in text.partition("\n## ")[0]
    assert "comparable" not in markdown(PLAN, Scale("cpu"), {"paper": [result(0, 20.0)]})


def test_maps_of_another_program_have_no_speed() -> None:
    read = result(None, 30.0, cost={"parameters": 0, "flops": 0, "images_per_second": 0})
    text = markdown(PLAN, Scale("cpu"), {"mean": [read]})
    assert line(text, "What it costs", "the mean")[2] == "–"


def test_other_test_data_are_reported() -> None:
    results = {"mean": [result(None, 30.0)]}
    otherwise = replace(PLAN, test_data={"lines": {"class_path": "RidgesAndValleys"}})
    said = 'The test split has other data than the training split: lines={"class_path": "RidgesAndValleys"}.'
    assert said in markdown(otherwise, Scale("cpu"), results).splitlines()
    assert "other data" not in markdown(PLAN, Scale("cpu"), results)


def test_all_lines_of_a_table_have_the_same_number_of_cells() -> None:
    text = markdown(PLAN, Scale("cpu"), {row.name: [result(0, 20.0)] for row in ROWS})
    tables = [part for part in text.split("\n\n") if part.startswith("|")]
    assert len(tables) == 8
    for table in tables:
        assert len({line.count("|") for line in table.splitlines()}) == 1
        assert (
            table.index("*Simple*") < table.index("the mean") < table.index("*Learnt*") < table.index("ours")
        )


def confident(observed: float) -> dict[str, Any]:
    bins = [
        {"pixels": 300, "predicted": 10.0, "observed": observed},
        {"pixels": 100, "predicted": 31.0, "observed": 40.0},
    ]
    near: list[dict[str, float | None]] = [
        {"from": 0.0, "to": 1.0, "pixels": 9, "angular_mean": 30.0, "nz_bias": 0.1}
    ]
    near += [{"from": 24.0, "to": None, "pixels": 9, "angular_mean": observed, "nz_bias": 0.0}]
    return {
        "calibration": {"0": bins, "15": bins},
        "distance": {"0": {"170ths": near}, "15": {"170ths": near[:1]}},
    }


def test_calibration_is_read_over_all_seeds_and_drawn_if_there_is_one() -> None:
    runs = [result(0, 20.0, **confident(12.0)), result(1, 20.0, **confident(18.0))]
    promised, observed, share = calibration_curve(runs, "0")
    assert promised.tolist() == [10, 31]
    assert observed.tolist() == [15, 40]
    assert share.tolist() == [0.75, 0.25]
    without = result(0, 20.0, calibration={"0": None, "15": None})
    assert draw_calibration(PLAN, {"mean": [result(None, 30.0)], "paper": [without]}, "caption") is None
    drawn = draw_calibration(PLAN, {"ours": runs, "paper": [without]}, "caption")
    assert drawn is not None
    with Image.open(BytesIO(drawn)) as picture:
        assert picture.size == (1100, 520)


def test_errors_by_distance_have_a_table_where_they_were_measured() -> None:
    text = markdown(
        PLAN, Scale("cpu"), {"mean": [result(None, 30.0)], "paper": [result(0, 20.0, **confident(12.0))]}
    )
    bare, hinted = (
        next(
            part
            for part in text.split("\n## ")
            if part.startswith(f"By distance from the contour in 170ths of the picture: mean error, {given}")
        )
        for given in ("no hints", "15 hints")
    )
    assert "| method | 0 to 1 | from 24 |" in bare
    assert line(
        text, "By distance from the contour in 170ths of the picture: mean error, no", "the paper"
    ) == ["30.0°", "12.0°"]
    assert line(
        text, "By distance from the contour in 170ths of the picture: mean error, no", "the mean"
    ) == ["–", "–"]
    assert "| method | 0 to 1 |" in hinted


def test_curves_of_unequal_length_are_averaged_where_they_exist() -> None:
    short = result(1, 20.0, curve=[{"images": 50, VALIDATION: 20.0}, {"images": 75, VALIDATION: 10.0}])
    images, errors = learning_curve([result(0, 20.0), short])
    assert images.tolist() == [50, 100]
    assert np.array_equal(errors, np.array([[40, 30], [20, np.nan]]), equal_nan=True)
    counts, errors = hint_curve([result(0, 20.0), result(1, None)], [0, 5, 15])
    assert counts.tolist() == [0, 5, 15]
    assert np.array_equal(errors, np.array([[20, 19, 18], 3 * [np.nan]]), equal_nan=True)


def test_curves_are_drawn_if_something_is_learnt() -> None:
    results = {"mean": [result(None, 30.0, curve=[])], "paper": [result(0, 20.0), result(1, None)]}
    assert draw_curves(PLAN, {"mean": results["mean"]}, "caption") is None
    one = draw_curves(PLAN, results, "caption")
    assert one is not None
    untaught = replace(PLAN, reference="mean")
    assert draw_curves(untaught, results, "caption") not in (None, one)
    two = draw_curves(PLAN, {**results, "ours": [result(0, 9.0)]}, "caption")
    assert two != one
    with Image.open(BytesIO(one)) as picture:
        assert picture.size == (1100, 430)


@pytest.mark.parametrize("size", [32, 128])
def test_the_gallery_has_a_line_a_method(size: int) -> None:
    mask = np.zeros((size, size), bool)
    mask[size // 4 : -size // 4, size // 4 : -size // 4] = True
    target = np.zeros((3, size, size), np.float32)
    target[0, mask] = 1
    hints = np.zeros((4, size, size), np.float32)
    hints[3, size // 2, size // 2] = hints[0, size // 2, size // 2] = 1
    facing = np.zeros_like(target)
    facing[2] = 1
    heights = []
    for count in (1, 2):
        rows = [Sample("", mask.astype(np.float32), hints, preds, target, mask) for preds in (facing, target)]
        with Image.open(BytesIO(draw_methods(count * [Line("method", rows)], "caption"))) as picture:
            heights.append(picture.height)
            pixels = np.asarray(picture.convert("RGB"), int)
    assert heights[1] - heights[0] == 116
    # Error of 90° in the first sample's column of errors, of 0° in the second's: ends of the colour scale.
    y, x = 40 + 116 + 56, 190 + 116 + 56
    assert pixels[y, x].sum() > 600
    assert pixels[y, x + 2 * 116 + 12].sum() < 30


def test_a_long_curve_is_thinned_out(tmp_path: Path) -> None:
    records = [
        {
            "images": i,
            "epoch": i,
            "seconds": 0.5,
            VALIDATION: 30.0,
            "val/no_hints/angular_mean": None,
            "val/l1": 1.0,
        }
        for i in range(1000)
    ]
    (tmp_path / "curve.json").write_text(json.dumps(records))
    curve = read_curve(tmp_path)
    assert len(curve) == 60
    assert (curve[0]["images"], curve[-1]["images"]) == (0, 999)
    assert "val/l1" not in curve[0]
    assert len(read_curve(tmp_path, most=2000)) == 1000


def test_further_tests_of_a_plan_have_their_own_tables() -> None:
    plan = replace(
        PLAN,
        placements=["uniform", "worst"],
        placement_counts=[3, 17],
        noise_degrees=[0, 10],
        noise_pixels=[2],
        pins=3,
    )
    one = result(0, 20.0)
    for i, given in enumerate(("uniform-3", "worst-3", "uniform-17", "worst-17", "degrees-10", "pixels-2")):
        one["figures"][given] = {"angular_mean": 10.0 + i}
    one["pins"] = {"worst": [9.0, 8.0, 7.0, 6.0], "suggested": [9.0, 8.5, 8.25, 8.0]}
    one["curve"][0][ADVERSARIAL_SHARE], one["curve"][1][ADVERSARIAL_SHARE] = 2e-5, 3e-4
    text = markdown(plan, Scale("cpu"), {"ours": [one], "paper": [result(0, 20.0)]})
    assert line(text, "Where hints lie: mean error with 3 hints", "ours") == ["10.00°", "11.00°"]
    assert line(text, "Where hints lie: mean error with 17 hints", "ours") == ["12.00°", "13.00°"]
    assert line(text, "Where hints lie: mean error with 17 hints", "the paper") == ["–", "–"]
    assert line(text, "Inaccurate hints: mean error with 15 hints, turned", "ours") == ["18.00°", "14.00°"]
    assert line(text, "Inaccurate hints: mean error with 15 hints, moved", "ours") == ["18.00°", "15.00°"]
    suggested = "One pin after the other, where the studio suggests"
    assert line(text, suggested, "ours") == ["9.00°", "8.50°", "8.25°", "8.00°"]
    assert text.count("Pixels that have a pin in the end are left out") == 2
    assert line(text, "Adversarial gradient", "ours") == ["2.0e-05", "3.0e-04"]
    assert line(text, "Adversarial gradient", "the paper") == ["–", "–"]


def test_intervals_and_figures_by_mesh_stand_in_tables() -> None:
    def with_meshes(*errors: float) -> dict[str, Any]:
        meshes = {f"m{i}": {"angular_mean": e, "pixels": 10, "nz_bias": 0.05} for i, e in enumerate(errors)}
        return result(0, 20.0, meshes={"0": meshes, "15": meshes, OWN: meshes})

    text = markdown(PLAN, Scale("cpu"), {"paper": [with_meshes(20, 22)], "ours": [with_meshes(15, 18)]})
    cells = line(text, "Table 3", "ours")
    assert cells[:2] == ["16.50° [15.11, 17.89]", "-4.50° [-4.96, -4.04]"]
    assert line(text, "Table 3", "the paper")[1] == "+0.00° [+0.00, +0.00]"
    assert "Table 4" not in text  # one seed
    assert "The differences to quote, over the test meshes and the seeds, need two test meshes" in text
    alone = markdown(PLAN, Scale("cpu"), {"paper": [with_meshes(20)], "ours": [with_meshes(15)]})
    assert line(alone, "Table 3", "ours")[:2] == ["–", "–"]
    assert "An interval needs two test meshes." in alone
    both = {
        name: [{**with_meshes(a + d, b + d), "seed": seed} for seed, d in enumerate(seeds)]
        for name, a, b, seeds in (("paper", 20, 22, (0, 1)), ("ours", 15, 18, (0, 0.5)))
    }
    text = markdown(PLAN, Scale("cpu"), both)
    # variances 0.25 over meshes and 0.0625 over seeds, 1.47 degrees of freedom
    assert line(text, "Table 4", "ours")[0] == "-4.75° [-8.21, -1.29]"
    assert "| the paper |" not in text[text.index("## Table 4") : text.index("## Relief")]
    by_mesh = mesh_table(with_meshes(15, 18), 15).splitlines()
    assert by_mesh[-1] == "| m1 | 18.00° | +0.050 | – | – | – | 18.00° | +0.050 |"
