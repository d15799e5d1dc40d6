import numpy as np
import pytest
from sound import FULL_SIZE, check_closed, check_full_size, check_individuals, coarse

from normalgan.animals import GROUPS, Animal
from normalgan.animals.bipeds import STANCES, Measures, skeleton

BIPEDS = GROUPS["bipeds"]


@pytest.mark.parametrize("species", BIPEDS)
def test_every_biped_is_one_closed_body_of_its_seed(species: str) -> None:
    check_individuals(species)


@pytest.mark.parametrize("pose", STANCES)
def test_every_pose_keeps_the_limbs_on(pose: str) -> None:
    check_closed(coarse("adult", 3, pose))


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


@pytest.mark.slow
@pytest.mark.parametrize("species", BIPEDS)
def test_all_bipeds_are_sound_at_full_size(species: str) -> None:
    for seed in FULL_SIZE:
        check_full_size(Animal(species, seed))
