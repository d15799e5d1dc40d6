import numpy as np

from normalgan.animals.plan import FunctionPlan, around, drawn_pose, proportions


def test_asking_for_a_pose_shifts_no_other_draw() -> None:
    one, other = np.random.default_rng(3), np.random.default_rng(3)
    assert drawn_pose(("stand", "walk"), "run", one) == "run"
    assert drawn_pose(("stand", "walk"), None, other) in {"stand", "walk"}
    assert one.uniform() == other.uniform()


def test_a_habit_named_twice_is_one_pose() -> None:
    assert FunctionPlan(("fly", "fly", "stand"), lambda pose, rng: []).poses == ("fly", "stand")


def test_proportions_are_drawn_from_their_ranges_and_the_young_are_otherwise() -> None:
    general = {"legs": (0.9, 1.1), "head": (1.0, 1.2)}
    own = {"head": (3.0, 4.0)}
    grown, young = (
        proportions(general, own, np.random.default_rng(5), factor) for factor in (None, {"head": 2.0})
    )
    assert 0.9 <= grown["legs"] <= 1.1
    assert 3.0 <= grown["head"] <= 4.0
    assert young == {"legs": grown["legs"], "head": 2.0 * grown["head"]}


def test_numbers_are_drawn_about_the_usual_ones_each_on_its_own() -> None:
    drawn = np.array([around(np.random.default_rng(seed), 0.1, 2.0, -0.5) for seed in range(200)])
    off = drawn / [2.0, -0.5] - 1
    assert np.abs(off).max() <= 0.1
    assert np.abs(off).max(axis=0).min() > 0.09
    assert abs(np.mean(off[:, 0] * off[:, 1])) < 0.3 * np.var(off)
