import numpy as np

from normalgan.animals.stations import Profile, Spine, Stations

BODY = Profile(
    x=np.array([0.0, 1.0, 3.0]),
    top=np.array([1.0, 2.0, 1.0]),
    bottom=np.array([0.0, -1.0, 0.5]),
    half_width=np.array([0.5, 0.8, 0.2]),
)


def test_a_profile_has_its_sections_in_the_middle_of_top_and_bottom() -> None:
    np.testing.assert_allclose(BODY.stations.points, [[0, 0.5, 0], [1, 0.5, 0], [3, 0.75, 0]])
    np.testing.assert_allclose(BODY.stations.radius, [0.5, 1.5, 0.25])
    np.testing.assert_allclose(BODY.wider(2.0).sweep().widths, [1.0, 1.6, 0.4])
    np.testing.assert_array_equal(BODY.at(2.0), (1.5, -0.25, 0.5))


def test_what_is_not_given_is_in_the_middle_and_round() -> None:
    tail = Stations(np.array([0.0, 1.0]), np.array([2.0, 3.0]), np.array([0.2, 0.1]))
    np.testing.assert_allclose(tail.points, [[0, 2, 0], [1, 3, 0]])
    np.testing.assert_allclose(tail.widths, [0.2, 0.1])


def test_a_straight_spine_leaves_a_body_as_it_is_and_a_bent_one_turns_its_end() -> None:
    xs = np.linspace(0.0, 3.0, 31)
    straight, bent = (Spine(xs, turns).sweep(BODY) for turns in (0 * xs, 90 * np.clip(xs - 1, 0, 1)))
    np.testing.assert_allclose(straight.points, BODY.sweep().points, atol=1e-12)
    np.testing.assert_allclose(straight.sides, BODY.sweep().sides, atol=1e-12)
    np.testing.assert_allclose(bent.points[:2], straight.points[:2], atol=1e-12)
    assert bent.points[2, 2] < -1.0  # to its left
    np.testing.assert_allclose(bent.sides[2], [1, 0, 0], atol=1e-12)
