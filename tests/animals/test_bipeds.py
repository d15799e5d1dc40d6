import numpy as np
import pytest

from normalgan.animals.bipeds import STANCES, Measures, skeleton


def test_a_skeleton_keeps_its_lengths_in_every_pose() -> None:
    measures = Measures()
    for pose in STANCES.values():
        bones = skeleton(measures, pose(np.random.default_rng(0)))
        for limb, length in [*((leg, 0.47) for leg in bones.legs), *((arm, 0.33) for arm in bones.arms)]:
            spans = np.linalg.norm(np.diff(limb.points, axis=0), axis=1)
            assert spans.sum() == pytest.approx(length)
