from dataclasses import replace
from typing import Any

import pytest

from normalgan.benchmark.plan import Plan, Row
from normalgan.benchmark.runs import check_shared, shared_settings, timed
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.settings import differences, digest, nest, part, without
from normalgan.errors import InputError


def settings(**model: Any) -> dict[str, Any]:
    schedule = {"class_path": "torch.optim.lr_scheduler.CosineAnnealingLR", "init_args": {"T_max": 3}}
    return {
        "trainer": {"max_epochs": 3, "callbacks": None, "max_time": "00:01:00:00"},
        "data": {"batch_size": 8, "size": 64},
        "model": {"n_critic": 1, "discriminator": {"class_path": "D"}, "lr_scheduler": schedule, **model},
    }


def test_bad_settings_of_the_test_split_are_refused_before_training() -> None:
    misspelt = {"lines": {"class_path": "RidgesAndValeys"}}
    plan = Plan("A plan", 100, [Row("mean", "the mean map", classical="mean")], test_data=misspelt)
    with pytest.raises(InputError, match=r"test_data of the plan cannot be used: .*RidgesAndValleys"):
        shared_settings(plan, Scale("tiny"))


@pytest.mark.parametrize("dotted", [{"a": 1, "a.b": 2}, {"a.b": 2, "a": 1}, {"a.b": {"c": 1}, "a.b.c": 2}])
def test_a_setting_has_one_value(dotted: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="the setting a"):
        nest(dotted)


def test_parts_are_whole_names() -> None:
    given = {"data": {"size": 1, "size_of_it": 2}, "model": {"size": 3}}
    assert part(given, ["data.size"]) == {"data": {"size": 1}}
    assert part(given, None) == given
    assert without(given, ["data.size"]) == {"data": {"size_of_it": 2}, "model": {"size": 3}}


def test_an_equal_number_of_images_whatever_the_batch_and_the_critic() -> None:
    one = settings()
    assert timed(one, 8000, 1000, None)["trainer"]["max_epochs"] == 8
    assert timed(settings(n_critic=5), 8000, 1000, None)["trainer"]["max_epochs"] == 40
    assert timed(settings(n_critic=5, discriminator=None), 8000, 1000, None)["trainer"]["max_epochs"] == 8
    one["data"]["batch_size"] = 600  # of 1000 samples, 400 are left out in an epoch
    assert timed(one, 8000, 1000, None)["trainer"]["max_epochs"] == 13
    assert timed(one, 1, 1000, None)["trainer"]["max_epochs"] == 1
    one["data"]["batch_size"] = 4000  # a single batch, not full
    assert timed(one, 8000, 1000, None)["trainer"]["max_epochs"] == 8


def test_a_cosine_ends_with_the_run() -> None:
    result = timed(settings(), 8000, 1000, None)
    assert result["model"]["lr_scheduler"]["init_args"] == {"T_max": 8}
    one_cycle = {"class_path": "OneCycleLR", "init_args": {"max_lr": 0.1, "total_steps": 3}}
    cycle = timed(settings(lr_scheduler=one_cycle), 8000, 1000, None)["model"]["lr_scheduler"]
    assert cycle["init_args"] == {"max_lr": 0.1, "total_steps": 8}
    assert result["trainer"]["max_time"] is None
    assert timed(settings(lr_scheduler=None), 8000, 1000, None)["model"]["lr_scheduler"] is None


def test_under_a_budget_of_time_the_clock_decides() -> None:
    own = {"class_path": "Own"}
    given = settings()
    given["trainer"]["callbacks"] = [own]
    result = timed(given, 8000, 1000, 480.0)
    assert result["trainer"]["max_epochs"] == -1
    assert result["model"]["lr_scheduler"] is None
    clock = {"class_path": "normalgan.callbacks.WallClockSchedule", "init_args": {"seconds": 480.0}}
    curve = {"class_path": "normalgan.callbacks.LearningCurve"}
    assert result["trainer"]["callbacks"] == [own, curve, clock]
    assert given["trainer"]["callbacks"] == [own]  # the argument stays as it is


def test_rows_share_their_data_but_for_what_is_their_own() -> None:
    row = Row("a", "A", configs=["a.yaml"])
    shared = settings()
    other = settings()
    other["data"] = {**shared["data"], "batch_size": 1, "augmentation": {"class_path": "A"}, "workers": 4}
    other["data"]["prediction"] = {"sketches": "drawings"}  # as in quickstart.yaml
    check_shared(row, other, shared)
    other["data"]["size"] = 32
    with pytest.raises(InputError, match=r"the row a sets data\.size, which all rows .* the plan's data\.$"):
        check_shared(row, other, shared)
    with pytest.raises(InputError, match=r"the plan's data, or name it in takes, if an overlay sets it"):
        check_shared(replace(row, takes=["trainer"]), other, shared)


def test_a_digest_tells_settings_apart() -> None:
    assert differences({"a": {"b": 1}}, {"a": {"b": 1, "c": None}}) == ["a.c"]
    assert digest({"a": {"b": 1}}) != digest({"a": {"b": 1, "c": None}})
