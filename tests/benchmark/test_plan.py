from dataclasses import fields
from pathlib import Path
from typing import Any, get_args

import pytest
import yaml

from normalgan.benchmark.plan import Plan, is_plan, read_plan
from normalgan.errors import InputError

ROOT = Path(__file__).parents[2]
PLANS = ROOT / "configs" / "benchmark"


def plan(**settings: Any) -> dict[str, Any]:
    trained = {"name": "paper", "label": "the paper", "configs": ["configs/paper.yaml"]}
    classical = {"name": "mean", "label": "mean", "classical": "mean"}
    return {"name": "p", "images": 10, "rows": [classical, trained], **settings}


def written(folder: Path, content: Any) -> Path:
    path = folder / "plan.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


def test_a_plan_is_read(tmp_path: Path) -> None:
    changes = {"model.discriminator": None, "model.hint_sampler": {"class_path": "NoHints"}}
    rows = [{"name": "a", "label": "A", "configs": ["x.yaml"], "changes": changes, "takes": ["trainer"]}]
    read = read_plan(written(tmp_path, plan(rows=rows, seeds=[3, 4], hint_counts=[50, 5], reference="a")))
    assert read.rows[0].changes == changes
    assert read.rows[0].takes == ["trainer"]
    assert read.seeds == [3, 4]
    assert read.counts == [0, 5, 15, 50]
    assert read.row("a") is read.rows[0]


def test_a_class_named_by_its_path_keeps_the_settings_it_is_given_alone(tmp_path: Path) -> None:
    """With its defaults written down, `params` of an optimiser among them, no row could be put together."""
    changes = {"model.discriminator_optimizer": {"class_path": "torch.optim.Adam", "init_args": {"lr": 1e-4}}}
    rows = [{"name": "a", "label": "A", "configs": ["x.yaml"], "changes": changes}]
    assert read_plan(written(tmp_path, plan(rows=rows))).rows[0].changes == changes


def test_plans_are_told_from_overlays() -> None:
    assert is_plan(PLANS / "fourlegs.yaml")
    assert not is_plan(ROOT / "configs" / "cpu.yaml")


def test_a_plan_takes_what_it_does_not_say_from_its_base(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("data: {size: 32}")
    trained = {"name": "a", "label": "A", "configs": ["mine.yaml"]}
    written(tmp_path, plan(seeds=[3, 4], data={"animals": {"count": 3}, "size": 64}, reference="paper"))
    child = tmp_path / "child.yaml"
    child.write_text(
        yaml.safe_dump({"base": "plan.yaml", "name": "c", "data": {"size": 32}, "rows": [trained]})
    )
    read = read_plan(child)
    assert (read.name, read.seeds, read.reference) == ("c", [3, 4], "paper")
    assert read.data == {"size": 32}  # as a whole: it is other data
    assert [row.name for row in read.rows] == ["mean", "paper", "a"]
    assert Path(read.rows[2].configs[0]) == tmp_path / "mine.yaml"
    assert is_plan(child)
    (tmp_path / "bare.yaml").write_text("base: child.yaml\n")
    assert is_plan(tmp_path / "bare.yaml")
    assert [row.name for row in read_plan(tmp_path / "bare.yaml").rows] == ["mean", "paper", "a"]


def test_the_base_of_a_shipped_plan_is_found_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert read_plan("benchmark/people").rows == read_plan("benchmark/animals").rows


def test_the_two_plans_differ_in_their_data_alone() -> None:
    fourlegs, embedded = (read_plan(PLANS / f"{name}.yaml") for name in ("fourlegs", "embedded"))
    begun = fourlegs.rows.pop()  # on animals made up like those that the other plan tests on
    assert begun.name == "ours-tuned"
    differ = {
        each.name for each in fields(Plan) if getattr(fourlegs, each.name) != getattr(embedded, each.name)
    }
    assert differ == {"name", "data"}
    assert "meshes" not in embedded.data


@pytest.mark.parametrize(
    ("base", "sentence"),
    [
        ("plan.yaml", r"plan\.yaml is its own base; a base must be another plan\."),
        (3, r"the base of the plan .*plan\.yaml must be the name of a plan, not 3\."),
        ("none.yaml", r"there is no configuration file .*none\.yaml"),
    ],
)
def test_a_base_that_is_no_other_plan_is_told(tmp_path: Path, base: Any, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        read_plan(written(tmp_path, plan(base=base)))


@pytest.mark.parametrize("name", ["fourlegs", "embedded"])
def test_our_plans_have_every_row_of_the_comparison(name: str) -> None:
    read = read_plan(PLANS / f"{name}.yaml")
    names = {row.name for row in read.rows}
    assert {"constant", "mean", "inflation", "pix2pix", "sketch2normal", "paper", "ours"} <= names
    assert {"hints-random", "hints-none", "discriminator-patch", "discriminator-none"} <= names
    assert {"instance-clip", "instance-penalty", "cross-entropy", "hint-loss-none"} <= names
    assert read.counts == [0, 5, 10, 15, 20, 50]
    assert len(read.seeds) >= 3
    assert all((ROOT / config).is_file() for row in read.rows for config in row.configs)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (plan(images="many"), ["plan.yaml", 'images is "many"; it should be a valid integer']),
        (plan(sedes=[1]), ["sedes is not known", "Did you mean seeds?"]),
        (plan(seeds=[]), ["a plan needs seeds"]),
        (plan(seeds=[-1]), ["seeds[0] is -1; it should be 0 or more"]),
        (plan(checkpoint="first"), ["checkpoint", "first"]),
        (plan(reference="theirs"), ["the plan has no row theirs; it has mean, paper"]),
        (plan(rows=3), ["are not a list of settings"]),
        (plan(placements=["best"], placement_counts=[3]), ['placements[0] is "best"', "'curvature'"]),
        (plan(test_data={"size": 32}), ["medium, meshes, ", "test_views, not size"]),
        (plan(placements=["worst"]), ["placements if and only if it has placement_counts"]),
        (plan(rows=[]), ["a plan needs rows"]),
        (plan(rows=[{"name": "a", "label": "A"}]), ["row a", "must have either configs or classical"]),
        (plan(rows=[{"name": "a", "label": "A", "classical": "median"}]), ["row a", "classical", "median"]),
        (
            plan(rows=[{"name": "a", "lable": "A", "classical": "mean"}]),
            ["row a", "lable", "Did you mean label?"],
        ),
        (plan(rows=[{"name": "a", "classical": "mean"}]), ["row a", "label"]),
        (plan(rows=[{"name": "a b", "label": "A", "classical": "mean"}]), ["'a b'", "letters, digits"]),
        (
            plan(rows=[{"name": "a", "label": "A", "classical": "mean", "takes": []}]),
            ["cannot have settings"],
        ),
        (
            plan(rows=2 * [{"name": "a", "label": "A", "classical": "mean"}]),
            ["two rows of the plan are named a"],
        ),
    ],
)
def test_a_mistake_is_answered_by_a_sentence(tmp_path: Path, wrong: Any, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        read_plan(written(tmp_path, wrong))
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_the_names_of_placements_are_those_that_there_are() -> None:
    from normalgan.benchmark import hints, plan

    assert tuple(hints._SAMPLERS) == get_args(plan.Placement)


def test_the_matrix_trains_each_placement_at_each_count() -> None:
    read = read_plan(PLANS / "placement.yaml")
    assert read.seeds == [0, 1, 2]
    assert read.placement_counts == [3, 10, 17, 30, 60]
    counts = {row.name: row.changes.get("model.hint_sampler", {}) for row in read.rows if row.configs}
    for name in read.placements:
        for count in read.placement_counts:
            arguments = counts[f"paper-{name}-{count}"]["init_args"]
            assert set(arguments.values()) == {count}


def test_the_critics_are_as_wide_as_the_generators() -> None:
    read = read_plan(PLANS / "critic.yaml")
    weights: dict[str, set[float]] = {}
    for row in read.rows:
        if row.name.startswith(("clip", "penalty")):
            settings = {**row.changes, **row.settings}
            widths = {
                settings[f"model.{network}.init_args.width"] for network in ("generator", "discriminator")
            }
            assert len(widths) == 1
            assert settings["model.share_every"] > 0
            weights.setdefault(row.name.split("-")[0], set()).add(settings["model.adversarial_weight"])
    assert weights == {kind: {1.0, 10.0, 100.0, 1000.0} for kind in ("clip", "penalty")}


def test_a_missing_plan_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no configuration file .*none\.yaml"):
        read_plan(tmp_path / "none.yaml")


def test_configs_are_found_beside_the_plan_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "plans").mkdir()
    (tmp_path / "elsewhere").mkdir()
    for place in ("mine.yaml", "elsewhere/mine.yaml", "elsewhere/other.yaml"):
        (tmp_path / place).write_text("data: {size: 32}")
    monkeypatch.chdir(tmp_path / "elsewhere")
    row = {"name": "a", "label": "A", "configs": ["../mine.yaml", "other.yaml"]}
    read = read_plan(written(tmp_path / "plans", plan(rows=[row])))
    first, second = read.rows[0].configs
    assert Path(first).resolve() == tmp_path / "mine.yaml"
    assert second == "other.yaml"  # beside the plan there is none: that of the working directory
