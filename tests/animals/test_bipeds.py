import numpy as np
import pytest
from sound import coarse

from normalgan.animals import GROUPS
from normalgan.animals.bipeds import STANCES, Measures, skeleton

BIPEDS = GROUPS["bipeds"]


def test_a_skeleton_keeps_its_lengths_in_every_pose() -> None:
    measures = Measures()
    for pose in STANCES.values():
        bones = skeleton(measures, pose(np.random.default_rng(0)))
        for limb, length in [*((leg, 0.47) for leg in bones.legs), *((arm, 0.33) for arm in bones.arms)]:
            spans = np.linalg.norm(np.diff(limb.points, axis=0), axis=1)
            assert spans.sum() == pytest.approx(length)


def test_a_standing_adult_faces_plus_x_on_two_feet() -> None:
    vertices = coarse("adult", 5, "stand").vertices
    heights = vertices[:, 1] - vertices[:, 1].min()
    feet = vertices[heights < 0.05]
    shins = vertices[(heights > 0.2) & (heights < 0.4)]
    for sign in (-1, 1):
        foot, shin = (part[part[:, 2] * sign > 0.02] for part in (feet, shins))
        assert foot[:, 0].mean() > shin[:, 0].mean()  # toes point ahead
    assert np.ptp(vertices[:, 1]) > 2 * np.ptp(vertices[:, 0])


def test_raised_arms_are_wider_than_hanging_ones() -> None:
    wide = [np.ptp(coarse("robot", 1, pose).vertices[:, 2]) for pose in ("stand", "arms_out")]
    assert wide[1] > 1.25 * wide[0]
