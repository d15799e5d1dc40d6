import numpy as np
import pytest

from normalgan.animals.insects import LegRow, legs, wing
from normalgan.animals.shapes import Plate, Sweep


def test_legs_reach_their_ground_and_lift_in_a_walk() -> None:
    rows = [LegRow(x, z=0.1, azimuth=90 - 225 * x, reach=0.4) for x in (0.2, 0.0, -0.2)]
    for pose, lifted in (("stand", 0), ("walk", 3)):
        part = legs(rows, pose, np.random.default_rng(0), 0.3, 0.03)
        toes = np.array([leg.points[-1, 1] for leg in part.shapes if isinstance(leg, Sweep)])
        assert len(toes) == 6
        assert np.sum(toes > -0.3 + 1e-9) == lifted
        np.testing.assert_allclose(toes.min(), -0.3)


def test_wings_are_mirrored_and_raised() -> None:
    round_ones = np.deg2rad(np.arange(0, 360, 30))
    outline = [(0.5 + 0.5 * np.cos(t), 0.5 * np.sin(t)) for t in round_ones]
    right, left = wing([0, 0, 0], outline, raised=60, back=0, thick=0.01)
    assert isinstance(right, Plate)
    assert isinstance(left, Plate)
    low, high = right.reach()
    assert high[1] == pytest.approx(np.sin(np.deg2rad(60)), rel=0.05)
    assert high[2] == pytest.approx(np.cos(np.deg2rad(60)), rel=0.05)
    np.testing.assert_allclose(left.reach()[0][2], -high[2])
    np.testing.assert_allclose(left.reach()[1][2], -low[2])
