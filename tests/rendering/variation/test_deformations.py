"""Deformations: their Jacobians against differences, and what they do where it is known."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
import trimesh

from normalgan.arrays import Doubles
from normalgan.rendering.variation.deformations import (
    Deformed,
    Middle,
    belly,
    bend,
    bump,
    free_form,
    in_turn,
    lengthen,
    scale,
    swell,
    taper,
    thicken,
    together,
    twist,
)

RNG = np.random.default_rng(5)
POINTS = RNG.uniform(-1, 1, (40, 3))
CENTRE, SHIFT = np.array([0.2, -0.1, 0.3]), np.array([0.1, 0.2, -0.05])
LOW, HIGH = np.full(3, -1.2), np.array([1.1, 1.3, 1.2])
PULLS = 0.2 * RNG.standard_normal((4, 4, 4, 3))
CLOUD = Middle(RNG.uniform(-1, 1, (300, 3)), RNG.uniform(0.5, 1.5, 300), 0.4)

DEFORMATIONS: dict[str, Callable[[Doubles], Deformed]] = {
    "scale": partial(scale, factors=np.array([1.2, 0.7, 1.1])),
    "taper": partial(taper, slope=0.3),
    "twist": partial(twist, rate=0.8),
    "bend up": partial(bend, curvature=0.4, across=1),
    "bend sideways": partial(bend, curvature=-0.3, across=2),
    "no bend": partial(bend, curvature=0.0, across=2),
    "free form": partial(free_form, low=LOW, high=HIGH, pulls=PULLS),
    "bump": partial(bump, centre=CENTRE, width=0.3, shift=SHIFT),
    "swell": partial(swell, centre=CENTRE, width=0.4, growth=-0.4),
    "lengthen": partial(lengthen, up=1, line=0.1, growth=0.5),
    "in turn": lambda points: in_turn(points, [partial(twist, rate=0.5), partial(taper, slope=0.3)]),
    "together": lambda points: together(points, [partial(twist, rate=0.5), partial(taper, slope=0.3)]),
}


@pytest.mark.parametrize("name", DEFORMATIONS)
def test_the_jacobian_is_the_derivative(name: str) -> None:
    deform, step = DEFORMATIONS[name], 1e-6
    _, jacobian = deform(POINTS)
    for axis in range(3):
        shift = np.eye(3)[axis] * step
        slope = (deform(POINTS + shift)[0] - deform(POINTS - shift)[0]) / (2 * step)
        np.testing.assert_allclose(jacobian[:, :, axis], slope, atol=1e-7)


def test_the_middle_moves_as_its_jacobian_says() -> None:
    # The mean leaves out what is beyond three standard deviations: 1 % of the weight at the rim.
    _, jacobian = CLOUD.at(POINTS)
    step = 1e-6
    for axis in range(3):
        shift = np.eye(3)[axis] * step
        slope = (CLOUD.at(POINTS + shift)[0] - CLOUD.at(POINTS - shift)[0]) / (2 * step)
        np.testing.assert_allclose(jacobian[:, :, axis], slope, atol=1e-6)


def test_a_bent_bar_is_an_arc_of_its_length() -> None:
    bar = np.column_stack([np.linspace(-1, 1, 101), np.zeros(101), np.zeros(101)])
    bent, _ = bend(bar, np.pi / 4, 1)  # a quarter of a circle over its length of 2
    radius = 4 / np.pi
    np.testing.assert_allclose(np.hypot(bent[:, 0], bent[:, 1] - radius), radius)
    assert np.linalg.norm(np.diff(bent, axis=0), axis=1).sum() == pytest.approx(2, rel=1e-4)
    directions = np.diff(bent[[0, 1, -2, -1]], axis=0)
    assert directions[0] @ directions[2] == pytest.approx(0, abs=1e-5)


def test_twist_turns_the_ends_against_each_other_and_keeps_volume() -> None:
    turned, jacobian = twist(np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]), np.pi / 4)
    np.testing.assert_allclose(turned[0], [1, np.sqrt(0.5), np.sqrt(0.5)])
    np.testing.assert_allclose(turned[1], [-1, np.sqrt(0.5), -np.sqrt(0.5)])
    np.testing.assert_allclose(np.linalg.det(jacobian), 1)


def test_a_lattice_pulled_as_a_whole_moves_everything_as_much() -> None:
    moved, jacobian = free_form(POINTS, LOW, HIGH, np.broadcast_to(SHIFT, (4, 4, 4, 3)))
    np.testing.assert_allclose(moved, POINTS + SHIFT)
    np.testing.assert_allclose(jacobian, np.broadcast_to(np.eye(3), (40, 3, 3)), atol=1e-12)
    # Bernstein polynomials reproduce straight lines: pulls that grow with the place stretch evenly.
    grid = np.stack(np.meshgrid(*[np.linspace(LOW[i], HIGH[i], 4) for i in range(3)], indexing="ij"), axis=-1)
    np.testing.assert_allclose(free_form(POINTS, LOW, HIGH, 0.5 * grid)[0], 1.5 * POINTS)


def table(legs: float) -> tuple[Doubles, np.ndarray]:
    """A slab one high on four legs, standing at 0."""
    parts = [trimesh.creation.box(bounds=[[-2, legs, -1], [2, legs + 1, 1]])]
    for x in (-1.8, 1.6):
        for z in (-0.9, 0.7):
            parts.append(trimesh.creation.box(bounds=[[x, 0, z], [x + 0.2, legs, z + 0.2]]))
    fine = [part.subdivide().subdivide().subdivide() for part in parts]
    vertices, faces = trimesh.util.append_faces(
        [part.vertices for part in fine], [part.faces for part in fine]
    )
    return vertices.astype(np.float64), faces


@pytest.mark.parametrize("legs", [0.5, 2.0, 3.0])
def test_the_belly_is_where_the_legs_end(legs: float) -> None:
    assert belly(*table(legs), up=1) == pytest.approx(legs, abs=0.06)


def test_longer_legs_leave_the_rest_as_it_is() -> None:
    points, faces = table(2.0)
    line = belly(points, faces, up=1)
    longer, _ = lengthen(points, 1, line, 0.5)
    above = points[:, 1] > line + 0.1
    np.testing.assert_array_equal(longer[above], points[above])
    assert longer[:, 1].min() == pytest.approx(points[:, 1].min() - 0.5 * line)
    np.testing.assert_array_equal(longer[:, [0, 2]], points[:, [0, 2]])


def test_thin_cylinders_get_thicker_by_the_growth_and_thick_ones_hardly() -> None:
    def radius(thickness: float) -> float:
        along, about = np.meshgrid(np.linspace(-1, 1, 41), np.arange(max(8, int(120 * thickness))))
        turn = about.ravel() * 2 * np.pi / len(about)
        points = np.column_stack([thickness * np.cos(turn), thickness * np.sin(turn), along.ravel()])
        moved, _ = thicken(points, Middle.of(points, np.ones(len(points)), 0.1), 0.3)
        waist = np.abs(points[:, 2]) < 0.5
        return float(np.hypot(moved[waist, 0], moved[waist, 1]).mean() / thickness)

    assert radius(0.03) == pytest.approx(1.3, abs=0.02)
    assert 1.0 < radius(1.0) < 1.01
