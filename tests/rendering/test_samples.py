import dataclasses
import importlib
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from normalgan.files.source_hash import source_hash
from normalgan.rendering.cameras import Camera, Views
from normalgan.rendering.lines.base import LineDrawing
from normalgan.rendering.lines.contours import OccludingContours, Silhouette
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import Renderer
from normalgan.rendering.renderers.embree import EmbreeRenderer
from normalgan.rendering.samples import Recipe, sample_rng
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View


@dataclass(frozen=True)
class Slope(Renderer):
    """A plane across the frame whose normal is the camera's y axis."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        normal = np.broadcast_to(camera.rotation[1], (size, size, 3)).astype(np.float32)
        return Maps(normal, np.ones((size, size), np.float32), np.ones((size, size), bool))


@dataclass(frozen=True)
class Shade(LineDrawing):
    """A blot over all of the picture, whose darkness says how large the maps were, or a number drawn."""

    scale: int = 4
    random: bool = False

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        middle = np.array([[0.0, view.size / 2], [view.size, view.size / 2]])
        darkness = rng.random() if self.random else len(view.maps(self.scale).mask) / 100
        return [Stroke.even(middle, 2 * view.size, darkness)]


@dataclass(frozen=True)
class Shift:
    """Moves strokes and maps a pixel to the right, and darkens them by a number drawn."""

    def draw(self, strokes: list[Stroke], maps: Maps, rng: np.random.Generator) -> tuple[list[Stroke], Maps]:
        moved = [Stroke.even(stroke.points + np.array([1, 0]), 1.0, rng.random()) for stroke in strokes]
        normal, depth, mask = (
            np.roll(maps.normal, 1, axis=1),
            np.roll(maps.depth, 1),
            np.roll(maps.mask, 1, axis=1),
        )
        return moved, Maps(normal, depth, mask)


def ball(name: str = "ball") -> Mesh:
    golden = (1 + 5**0.5) / 2
    corners = [(0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    points = np.array([np.roll(c, k) for k in range(3) for c in corners]) / np.hypot(1, golden)
    near = np.linalg.norm(points[:, None] - points, axis=-1) < 1.1
    triples = [
        (i, j, k)
        for i in range(12)
        for j in range(i)
        for k in range(j)
        if near[i, j] & near[j, k] & near[k, i]
    ]
    faces = [t if np.linalg.det(points[list(t)]) > 0 else t[::-1] for t in triples]
    return Mesh(name, points.astype(np.float32), np.array(faces, np.int32), points.astype(np.float32))


def test_every_sample_can_be_made_alone_and_depends_on_seed_mesh_and_index() -> None:
    recipe = Recipe(Views(), Slope(), Shade(), 8)
    first = recipe.render(ball(), 5)
    for index in (1, 2, 3):
        recipe.render(ball(), index)
    np.testing.assert_array_equal(recipe.render(ball(), 5).normal, first.normal)
    for other in (
        recipe.render(ball(), 6),
        recipe.render(ball("globe"), 5),
        dataclasses.replace(recipe, seed=1).render(ball(), 5),
    ):
        assert (other.normal != first.normal).any()


@pytest.mark.slow
def test_the_seed_is_the_same_in_every_process() -> None:
    code = (
        "from normalgan.rendering.samples import sample_rng; "
        "print(sample_rng(7, 'élan', 3, 'lines').integers(10**9))"
    )
    drawn = [
        subprocess.check_output([sys.executable, "-c", code]) for _ in range(2)
    ]  # each with its own hash salt
    assert int(drawn[0]) == int(drawn[1]) == int(sample_rng(7, "élan", 3, "lines").integers(10**9))


def test_seeds_do_not_run_into_each_other() -> None:
    cases = [
        (1, "2", 3, "views"),
        (12, "", 3, "views"),
        (1, "23", 0, "views"),
        (0, "a", 11, "views"),
        (0, "a1", 1, "views"),
        (0, "a1", 1, "lines"),
    ]
    assert len({int(sample_rng(*case).integers(2**60)) for case in cases}) == len(cases)


def test_lines_come_from_larger_maps_and_normals_from_maps_of_their_own_size() -> None:
    sample = Recipe(Views(), Slope(), Shade(scale=4), 8).render(ball(), 0)
    assert sample.normal.shape == (8, 8, 3)
    assert sample.normal.dtype == np.float16
    assert sample.mask.dtype == np.bool_
    assert sample.sketch.dtype == np.uint8
    assert (sample.sketch == round(255 * 0.32)).all()


def test_a_hand_moves_strokes_and_maps_alike() -> None:
    plain = Recipe(Views(), EmbreeRenderer(), OccludingContours(resolution=64), 64)
    moving = dataclasses.replace(plain, hand=Shift())  # type: ignore[arg-type]
    exact, drawn = plain.render(ball(), 0), moving.render(ball(), 0)
    np.testing.assert_array_equal(drawn.mask, np.roll(exact.mask, 1, axis=1))
    np.testing.assert_array_equal(drawn.normal, np.roll(exact.normal, 1, axis=1))
    inked = np.roll(exact.sketch, 1, axis=1) > 128
    assert (drawn.sketch[inked] > 0).all()


def test_the_draws_of_a_step_do_not_shift_those_of_another() -> None:
    chooses = Recipe(Views(), Slope(), Shade(random=True), 8)
    plain = dataclasses.replace(chooses, lines=Shade())
    np.testing.assert_array_equal(chooses.render(ball(), 0).normal, plain.render(ball(), 0).normal)
    turned = dataclasses.replace(chooses, views=Views(azimuth=(0.0, 0.0)))
    np.testing.assert_array_equal(chooses.render(ball(), 0).sketch, turned.render(ball(), 0).sketch)
    assert (chooses.render(ball(), 0).sketch != chooses.render(ball(), 1).sketch).any()


def test_half_precision_turns_normals_by_less_than_a_twentieth_of_a_degree() -> None:
    recipe = Recipe(Views(), EmbreeRenderer(), OccludingContours(resolution=64), 64)
    sample = recipe.render(ball(), 0)
    exact = EmbreeRenderer().render(ball(), Views().camera(ball(), sample_rng(0, "ball", 0, "views")), 64)
    np.testing.assert_array_equal(sample.mask, exact.mask)
    p, t = sample.normal[exact.mask].astype(float), exact.normal[exact.mask].astype(float)
    error = np.rad2deg(np.arctan2(np.linalg.norm(np.cross(p, t), axis=1), (p * t).sum(1)))
    assert 0 < error.max() < 0.05
    assert (sample.normal[~exact.mask] == 0).all()
    assert exact.mask.mean() > 0.5
    assert 100 < (sample.sketch > 127).sum() < exact.mask.sum() / 2  # an outline, not a blot


def test_description_is_json_and_tells_every_setting_apart() -> None:
    base = Recipe(Views(), EmbreeRenderer(), OccludingContours(), 64, 3)
    described = base.describe()
    assert json.loads(json.dumps(described)) == described
    assert described["renderer"] == {"class": "EmbreeRenderer"}
    assert described["lines"]["crease"] is None
    others = [
        dataclasses.replace(base, size=65),
        dataclasses.replace(base, seed=4),
        dataclasses.replace(base, renderer=Slope()),
        dataclasses.replace(base, lines=OccludingContours(line_width=1.5)),
        dataclasses.replace(base, views=Views(roll=(0.0, 0.0))),
    ]
    assert len({json.dumps(r.describe()) for r in [base, *others]}) == 6


@pytest.mark.parametrize(
    ("module", "imports", "helper"),
    [
        ("thick_lines", "", "thick_lines.py"),
        ("thick_lines", "from thick_helper import OTHER", "thick_helper.py"),
        ("thick.lines", "from .inside import helper", "thick/inside/helper.py"),
        ("thick.lines", "def later():\n    import thick.helper", "thick/helper/__init__.py"),
    ],
    ids=["itself", "beside it", "from its package", "within a function"],
)
def test_an_edited_plug_in_gets_new_samples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, imports: str, helper: str
) -> None:
    file = tmp_path.joinpath(*module.split(".")).with_suffix(".py")
    for path in (file, tmp_path / helper):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    code = f"""
from dataclasses import dataclass
from normalgan.rendering.lines.contours import Silhouette
import numpy, os
{imports}

@dataclass(frozen=True)
class Thick(Silhouette):
    pass
"""
    monkeypatch.syspath_prepend(tmp_path)
    found = []
    for version in ("OTHER = 1\n", "OTHER = 2\n", "OTHER = 1\n"):
        file.write_text(code)
        edited = tmp_path / helper
        edited.write_text(version + (code if edited == file else ""))
        for name in [name for name in sys.modules if name.startswith("thick")]:
            sys.modules.pop(name)
        source_hash.cache_clear()
        importlib.invalidate_caches()
        style = importlib.import_module(module).Thick()
        found.append(Recipe(Views(), EmbreeRenderer(), style, 64).describe())
    assert found[0] == found[2] != found[1]
    assert "code" not in Recipe(Views(), EmbreeRenderer(), Silhouette(), 64).describe()["lines"]


def test_a_plug_in_that_cannot_be_described_is_refused() -> None:
    @dataclass(frozen=True)
    class Opaque(Slope):
        pixels: object = dataclasses.field(default_factory=object)

    with pytest.raises(TypeError, match="object is not a dataclass of plain values"):
        Recipe(Views(), Opaque(), Shade(), 8).describe()
