"""Animations: interpolation against scipy and against what is known."""

from pathlib import Path

import numpy as np
import pytest
from rig_files import QUARTER, bar, write_gltf
from scipy.interpolate import CubicHermiteSpline

from normalgan.arrays import Doubles
from normalgan.rendering.rigs.animations import track_at
from normalgan.rendering.rigs.reading import read_rig
from normalgan.rendering.rigs.rig import Track

RNG = np.random.default_rng(2)
TIMES = np.array([0.5, 1.0, 3.0])


def track(path: str, interpolation: str, values: Doubles, slopes: Doubles | None = None) -> Track:
    triples = np.zeros((len(TIMES), 3, values.shape[1]))
    triples[:, 1] = values
    if slopes is not None:
        triples[:, 0] = triples[:, 2] = slopes
    return Track(0, path, interpolation, TIMES, triples)


def test_places_run_straight_and_stop_at_the_ends() -> None:
    values = RNG.uniform(-1, 1, (3, 3))
    found = track_at(track("translation", "LINEAR", values), np.array([0.0, 0.75, 1.0, 2.5, 9.0]))
    expected = [values[0], values[:2].mean(axis=0), values[1], 0.25 * values[1] + 0.75 * values[2], values[2]]
    np.testing.assert_allclose(found, expected)


def test_steps_hold_until_the_next_one() -> None:
    values = RNG.uniform(-1, 1, (3, 3))
    found = track_at(track("scale", "STEP", values), np.array([0.0, 0.99, 1.0, 2.99, 3.0, 4.0]))
    np.testing.assert_array_equal(found, values[[0, 0, 1, 1, 2, 2]])


def test_splines_are_hermite_splines() -> None:
    values, slopes = RNG.uniform(-1, 1, (2, 3, 3))
    moments = np.linspace(0.5, 3, 31)
    found = track_at(track("translation", "CUBICSPLINE", values, slopes), moments)
    np.testing.assert_allclose(found, CubicHermiteSpline(TIMES, values, slopes)(moments))


def test_rotations_take_the_shorter_way_round() -> None:
    other = -QUARTER  # the same rotation
    values = np.array([[0, 0, 0, 1], other, other])
    found = track_at(track("rotation", "LINEAR", values), np.array([0.75]))[0]
    eighth = np.array([0, 0, np.sin(np.pi / 8), np.cos(np.pi / 8)])
    assert abs(found @ eighth) == pytest.approx(1)


def test_rotations_stay_of_length_one() -> None:
    values, slopes = RNG.uniform(-1, 1, (2, 3, 4))
    values /= np.linalg.norm(values, axis=1, keepdims=True)
    for interpolation in ("LINEAR", "STEP", "CUBICSPLINE"):
        found = track_at(track("rotation", interpolation, values, slopes), np.linspace(0, 4, 41))
        np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1)


def test_one_key_holds_for_ever() -> None:
    still = Track(0, "translation", "CUBICSPLINE", np.array([2.0]), np.arange(9.0).reshape(1, 3, 3))
    np.testing.assert_array_equal(track_at(still, np.array([0.0, 2.0, 5.0])), [[3.0, 4.0, 5.0]] * 3)


def test_a_spline_in_a_file_is_read_as_tangent_value_tangent(tmp_path: Path) -> None:
    gltf, _ = bar()
    values = np.arange(18, dtype=np.float32).reshape(6, 3)
    animation = gltf.tree["animations"][0]
    animation["samplers"].append(
        {
            "input": animation["samplers"][0]["input"],
            "output": gltf.accessor(values),
            "interpolation": "CUBICSPLINE",
        }
    )
    animation["channels"].append({"sampler": 1, "target": {"node": 0, "path": "translation"}})
    animation["channels"].append({"sampler": 1, "target": {"node": 2, "path": "weights"}})
    rotation, place = read_rig(write_gltf(tmp_path / "bar.gltf", gltf)).clips[0].tracks
    assert (rotation.interpolation, place.interpolation) == ("LINEAR", "CUBICSPLINE")
    np.testing.assert_array_equal(track_at(place, np.array([0.0, 1.0])), values[[1, 4]])
