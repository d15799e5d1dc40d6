import numpy as np
import pytest
from sound import coarse

from normalgan.animals import GROUPS, Animal, make_animals
from normalgan.animals.quadrupeds_poses import POSTURES
from normalgan.errors import InputError


def test_the_head_is_at_plus_x_and_the_feet_are_down() -> None:
    giraffe = coarse("giraffe", 0, "stand")
    assert giraffe.vertices[np.argmax(giraffe.vertices[:, 1]), 0] > 0.1
    low = giraffe.vertices[giraffe.vertices[:, 1] < giraffe.vertices[:, 1].min() + 0.02]
    # Four feet: before and behind, on either side.
    for sign_z in (-1, 1):
        side = low[low[:, 2] * sign_z > 0]
        assert np.ptp(side[:, 0]) > 0.3


def test_the_same_animal_is_the_same_to_the_byte() -> None:
    first, second = Animal("stag", 11).load(), Animal("stag", 11).load()
    assert first.vertices.tobytes() == second.vertices.tobytes()
    assert first.faces.tobytes() == second.faces.tobytes()
    assert first.normals.tobytes() == second.normals.tobytes()


def test_fingerprint_and_name_follow_species_seed_and_pose() -> None:
    animals = [Animal("horse", 7), Animal("horse", 8), Animal("cow", 7), Animal("horse", 7, "walk")]
    assert len({animal.fingerprint() for animal in animals}) == 4
    assert [animal.name for animal in animals] == ["horse-0007", "horse-0008", "cow-0007", "horse-0007-walk"]
    assert Animal("horse", 7).fingerprint() == animals[0].fingerprint()


def test_a_herd_rotates_through_the_species_and_never_repeats() -> None:
    animals = make_animals(40, seed=3)
    assert animals == make_animals(40, seed=3)
    assert animals[:17] == make_animals(17, seed=3)
    assert len(set(animals)) == 40
    assert [animal.species for animal in animals[:15]] == list(GROUPS["quadrupeds"])
    assert not set(animals) & set(make_animals(40, seed=4))


def test_a_share_of_a_herd_holds_postures() -> None:
    plain, all_of_them = (make_animals(30, seed=3, postures=share) for share in (0.0, 1.0))
    assert plain == make_animals(30, seed=3)
    assert [animal.seed for animal in all_of_them] == [animal.seed for animal in plain]
    assert {animal.pose for animal in all_of_them} == {"sit", *POSTURES}
    some = make_animals(300, seed=3, postures=0.5)
    assert 120 < sum(animal.pose is not None for animal in some) < 180
    fish = make_animals(8, species=["fish"], postures=1.0)
    assert {animal.pose for animal in fish} == {None}
    with pytest.raises(InputError, match=r"share of postures is 1\.5; give a number from 0 to 1"):
        make_animals(1, postures=1.5)


def test_a_herd_takes_species_and_groups_in_rotation_and_each_once() -> None:
    animals = make_animals(5, seed=2, species=["stag", "cat"])
    assert [animal.species for animal in animals] == ["stag", "cat", "stag", "cat", "stag"]
    assert [animal.seed for animal in animals] == [20_000, 20_000, 20_001, 20_001, 20_002]
    mixed = make_animals(15, species=["horse", "quadrupeds"])
    assert mixed[0].species == "horse"
    assert len({animal.species for animal in mixed}) == 15
    assert make_animals(15) == make_animals(15, species=["quadrupeds"])


def test_what_is_not_known_is_said_with_the_nearest_that_is() -> None:
    with pytest.raises(InputError, match=r"no species named 'girafe'\. Did you mean giraffe\? Known: bear, "):
        Animal("girafe", 0)
    with pytest.raises(InputError, match=r"no pose of horse named 'walking'\. Did you mean walk\?"):
        Animal("horse", 0, "walking")
    with pytest.raises(InputError, match="seed of Animal is -1"):
        Animal("horse", -1)
    with pytest.raises(InputError, match="number of animals is 0"):
        make_animals(0)
    with pytest.raises(
        InputError, match=r"no species or group named 'quadruped'\. Did you mean quadrupeds\?"
    ):
        make_animals(1, species=["quadruped"])
    with pytest.raises(InputError, match="no species was named; known groups: quadrupeds"):
        make_animals(1, species=[])
