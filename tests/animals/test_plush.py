import numpy as np
import pytest
from sound import coarse

from normalgan.animals.plush import SKULL, on_skull


def test_a_toy_that_sits_is_lower_and_longer_than_one_that_stands() -> None:
    sitting, standing = (np.ptp(coarse("teddy", 3, pose).vertices, axis=0) for pose in ("sit", "stand"))
    assert sitting[1] / sitting[0] < 0.85 * standing[1] / standing[0]


def test_the_face_of_a_toy_is_on_the_side_of_plus_x() -> None:
    trunk = coarse("plush_elephant", 2, "stand").vertices
    high = trunk[trunk[:, 1] > np.median(trunk[:, 1])]
    assert high[:, 0].max() > 1.4 * -high[:, 0].min()


def test_what_is_sewn_on_a_head_lies_on_its_ellipsoid() -> None:
    for aside, up in ((0, 0), (90, 0), (0, 90), (33, -20)):
        assert np.linalg.norm(on_skull(aside, up) / SKULL) == pytest.approx(1)
    np.testing.assert_allclose(on_skull(90, 0), [0, 0, SKULL[2]], atol=1e-12)
