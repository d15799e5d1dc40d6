"""Species as files: those of the package are all there and right; a bad one is told in one sentence."""

import json
import math
import random
import re
import tomllib
import zlib
from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from normalgan.animals import GROUPS, SPECIES, read_species, species
from normalgan.animals.meshing import to_mesh
from normalgan.animals.quadrupeds import Quadruped
from normalgan.animals.species import PLANS
from normalgan.animals.tables import FOLDER, SHARED
from normalgan.errors import InputError

HORSE = (FOLDER / "quadrupeds" / "horse.toml").read_text(encoding="utf-8")
EXTENTS = Path(__file__).with_name("extents.json")


def extents(species: str) -> list[float]:
    """Return the number of parts of one individual and the size of the box that holds what they add."""
    rng = np.random.default_rng([zlib.crc32(species.encode()), 0])
    parts = SPECIES[species].grow(None, rng)
    corners = [part.reach() for part in parts if not part.carve]
    low, high = np.stack([low for low, _ in corners]), np.stack([high for _, high in corners])
    return [len(parts), *(round(float(side), 4) for side in high.max(0) - low.min(0))]


def test_every_file_is_a_species_and_every_plan_has_one() -> None:
    files = {path for path in FOLDER.rglob("*.toml") if path != SHARED}
    named = {FOLDER / group / f"{name}.toml" for group, names in GROUPS.items() for name in names}
    assert files == {path for path in named if path.parent.is_dir()}
    assert len(files) == 53
    used = {re.search(r'plan = "(\w+)"', path.read_text(encoding="utf-8"))[1] for path in files}  # type: ignore[index]
    assert used == set(PLANS)


@pytest.mark.parametrize("species", SPECIES)
def test_a_species_and_a_seed_are_the_shape_they_were(species: str) -> None:
    # After a change that is meant to alter shapes: raise VERSION of animal.py, and store `extents` of all.
    stored = json.loads(EXTENTS.read_text(encoding="utf-8"))
    assert stored.keys() == SPECIES.keys()
    assert extents(species) == pytest.approx(stored[species], abs=2e-3)


def test_a_file_of_ones_own_grows_into_a_mesh(tmp_path: Path) -> None:
    path = tmp_path / "okapi.toml"
    path.write_text(HORSE.replace("length = 0.42", "length = 0.30"), encoding="utf-8")
    okapi, horse = read_species(path), SPECIES["horse"]
    assert isinstance(okapi, Quadruped)
    assert isinstance(horse, Quadruped)
    assert okapi.head.length == 0.30
    assert okapi.fore.template.joints == horse.fore.template.joints
    mesh = to_mesh("okapi", okapi.grow("walk", np.random.default_rng(1)), 3_000)
    assert len(mesh.faces) > 1_000


def test_what_individuals_share_cannot_be_changed_by_one() -> None:
    horse = SPECIES["horse"]
    assert isinstance(horse, Quadruped)
    with pytest.raises(ValueError, match="read-only"):
        horse.torso.x[0] = 1.0


@pytest.mark.parametrize(
    ("was", "now", "sentence"),
    [
        ('plan = "quadruped"', "", "plan is missing. Known: biped, bird, "),
        ('plan = "quadruped"', 'plan = "quadrupet"', "plan is quadrupet. Did you mean quadruped? Known: "),
        ('"trot"', '"trott"', "habits[2] is \"trott\"; it should be 'stand', 'walk', 'trot', "),
        ("habits = [", "habits = []\nunused = [", "unused is not known. Known: habits, torso, "),
        ("[tail]", "[tale]", "tale is not known. Did you mean tail? Known: "),
        (
            "neck_pitch = [-28.0, 10.0]",
            "neck_pitch = [10.0, -28.0]",
            "neck_pitch is [10.0, -28.0]; it should be two numbers, low then high, from",
        ),
        ("neck_pitch = [-28.0, 10.0]", "neck_pitch = [10.0]", "neck_pitch[1] is missing."),
        ("neck = [0.92, 1.08]", "nek = [0.92, 1.08]", "ranges.nek is \"nek\"; it should be 'length', "),
        ("foot = 0.088", "", "fore.foot is missing."),
        ("z = 0.115", "z = true", "fore.z is true; it should be a valid number."),
        ("z = 0.115", "z = nan", "fore.z is NaN; it should be from -10000 to 10000."),
        (
            'template = "hoofed_fore"',
            'template = "hoofed"',
            "fore.template: there is no 'hoofed'. Did you mean",
        ),
        ("z = 0.115", "z = -1e300", "fore.z is -1e+300; it should be from -10000 to 10000."),
        ('template = "hoofed_fore"', "template = 3", "fore.template is 3; it should be a table."),
        ('kind = "ears"', 'kind = "years"', "it should have as its kind one of tube, nostrils, ears."),
        ("[0.27,  0.39, ", "[0.27,  0.39, 0.4,", "neck: each column has one number a station"),
        ("[ 0.2, 0.165,", "[ 0.2, -0.165,", "neck: radius and half_width are greater than 0."),
        ("[ 0.91, 0.965,", "[ 0.51, 0.965,", "torso: top is greater than bottom, and"),
        ("eye = {", "eye = {y = 1.0, ", "head.eye: y is not known. Known: x, angle, radius."),
        ("[mane]", "mane = [", "is not a species file, which is TOML: "),
    ],
)
def test_a_bad_file_is_told_by_file_and_field(was: str, now: str, sentence: str, tmp_path: Path) -> None:
    assert was in HORSE
    path = tmp_path / "mine.toml"
    path.write_text(HORSE.replace(was, now, 1), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_species(path)
    assert str(caught.value).startswith(str(path))
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_whatever_a_field_holds_is_read_or_told_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(0)
    odd: list[Any] = [None, True, 3, -1e300, math.nan, 10**400, "x", "hoofed_fore", [], [1], [[1]], {}]
    odd += [{"a": 1}, {"kind": [1]}, {"kind": "ears"}, date(2026, 1, 1)]

    def places(holder: Any) -> Iterator[tuple[Any, Any]]:
        for key in holder if isinstance(holder, dict) else range(len(holder)):
            yield holder, key
            if isinstance(holder[key], dict | list):
                yield from places(holder[key])

    told: list[str] = []
    for _ in range(400):
        table = tomllib.loads(HORSE)
        holder, key = rng.choice([*places(table)])
        holder[key] = rng.choice(odd)
        monkeypatch.setattr(species, "read_toml", lambda _, table=table: table)
        try:
            read_species("mine.toml")
        except InputError as error:
            told.append(str(error))
    assert len(told) > 300
    assert [each for each in told if not re.fullmatch(r"mine\.toml: [^\n]{1,900}[.?]", each)] == []


def test_a_file_that_is_not_there_or_has_no_pose_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.toml cannot be read: No such file"):
        read_species(tmp_path / "none.toml")
    path = tmp_path / "still.toml"
    path.write_text('plan = "snake"\nhabits = []\nskull = "snake_skull"\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"still\.toml: habits name one pose or more\."):
        read_species(path)


def test_joints_feathers_points_and_sizes_are_checked(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    leg = "{joints = [0, 1, 1, 2], stations = {x = [0.0, 0.0], y = [1.0, 0.0], radius = [0.1, 0.1]}}"
    path.write_text(HORSE.replace('"hoofed_fore"', leg), encoding="utf-8")
    with pytest.raises(InputError, match=r"fore\.template: joints are stations, which go from 0 to 1\."):
        read_species(path)
    path.write_text(HORSE.replace("radius = 0.03\n", "radius = 0.0\n"), encoding="utf-8")
    with pytest.raises(
        InputError, match=r"head\.ornaments\[0\]\.nostrils: radius and half_width are greater"
    ):
        read_species(path)
    tuna = (FOLDER / "fish" / "tuna.toml").read_text(encoding="utf-8")
    path.write_text(re.sub("mouth = .*", "mouth = [[1.0, 0.0, 0.0]]", tuna), encoding="utf-8")
    with pytest.raises(InputError, match=r"mouth is a line of two points or more\."):
        read_species(path)
    child = (FOLDER / "bipeds" / "cartoon.toml").read_text(encoding="utf-8")
    path.write_text(re.sub("spread = .*", "spread = -1.0", child), encoding="utf-8")
    with pytest.raises(InputError, match=r"spread is -1\.0; it should be from 0 to 0\.5\."):
        read_species(path)
    hen = (FOLDER / "birds" / "hen.toml").read_text(encoding="utf-8")
    assert "feathers = 7" in hen
    path.write_text(hen.replace("feathers = 7", "feathers = 1"), encoding="utf-8")
    with pytest.raises(InputError, match=r"tail\.feathers is 1; it should be from 2 to 30\."):
        read_species(path)


@pytest.mark.parametrize(
    ("file", "was", "now", "sentence"),
    [
        (
            "birds/heron.toml",
            r"\[low\].*?\n\n",
            "[low]\nx = [0.0, 0.2]\ny = [0.0, 0.1]\nradius = [0.1, 0.1]\n\n",
            "low has as many stations as neck, 7, not 2.",
        ),
        ("birds/heron.toml", r"thigh = \S+", "thigh = 0.0", "leg.thigh is 0.0; it should be from 0.01"),
        ("bipeds/monkey.toml", r"leg = \S+", "leg = 0.0", "measures.leg is 0.0; it should be from 0.01"),
        (
            "fish/tuna.toml",
            r"outline = \[\[.*?\]\]",
            "outline = []",
            "fins[0].fin: outline has three corners or more, not 0.",
        ),
        (
            "fish/tuna.toml",
            r"outline = ",
            "chord = [0.0, 0.0, 0.0]\noutline = ",
            "tail: chord is a direction, and 0, 0, 0 is none.",
        ),
        (
            "dinosaurs/raptor.toml",
            r"(\[tail\].*?x +=) \[[^,]*,",
            r"\1 [0.0,",
            "tail begins behind the hip, at an x less than 0, not at 0.",
        ),
    ],
)
def test_what_could_not_grow_is_refused_when_it_is_read(
    file: str, was: str, now: str, sentence: str, tmp_path: Path
) -> None:
    text = (FOLDER / file).read_text(encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(re.sub(was, now, text, count=1, flags=re.DOTALL), encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(f"mine.toml: {sentence}")):
        read_species(path)
