import numpy as np
import pytest
from scenes import bump_slope, bumps, cube, ink, sphere, view

from normalgan.rendering.lines import OccludingContours, SuggestiveContours


def test_a_wavy_dome_has_strokes_in_its_valleys_alone() -> None:
    scene = view(bumps(0.03))
    outline, sketch = ink(OccludingContours(), scene), ink(SuggestiveContours(), scene)
    grid = (np.arange(128) + 0.5) / 64 - 1
    r = np.sqrt(grid**2 + grid[:, None] ** 2)
    assert outline[r < 0.7].max() == 0
    assert sketch[r < 0.7].sum() > 50
    # Independently: n·v along a radius has its minima there, and the stroke lies on one of them.
    line = np.linspace(0.005, 0.7, 2000)
    slope = bump_slope(line, 0.03)
    f = 1 / np.sqrt(1 + slope**2)
    minima = line[1:-1][(f[1:-1] < f[:-2]) & (f[1:-1] < f[2:])]
    inked = r[(sketch > 0.5) & (r < 0.7)]
    assert np.abs(inked[:, None] - minima).min(axis=1).max() < 2 / 64


def test_a_smooth_ellipsoid_of_any_view_has_no_strokes() -> None:
    scene = view(sphere(0.1, 0.2, 0, 0.7), perspective=True)
    np.testing.assert_array_equal(ink(SuggestiveContours(), scene), ink(OccludingContours(), scene))


@pytest.mark.parametrize("perspective", [False, True])
def test_the_faces_of_a_cube_are_no_valleys(perspective: bool) -> None:
    scene = view(cube(0.45), perspective=perspective)
    np.testing.assert_array_equal(ink(SuggestiveContours(), scene), ink(OccludingContours(), scene))
