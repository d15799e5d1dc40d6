"""The figures of benchmarks/line_figures.py, on drawings whose figures are known."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from normalgan.rendering.strokes import Stroke
from normalgan.rendering.strokes.raster import rasterise

PATH = Path(__file__).parents[3] / "benchmarks" / "line_figures.py"


@pytest.fixture(scope="module")
def figures() -> ModuleType:
    spec = importlib.util.spec_from_file_location("line_figures", PATH)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["line_figures"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def line(*points: tuple[float, float], width: float = 2.0) -> Stroke:
    return Stroke.even(np.array(points, dtype=float), width)


def circle(radius: float, width: float) -> Stroke:
    turn = np.linspace(0, 2 * np.pi, 200)
    points = 128 + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points[-1] = points[0]
    return Stroke.even(points, width)


@pytest.mark.parametrize("width", [1.5, 2.0, 4.0])
def test_a_circle(figures: ModuleType, width: float) -> None:
    found = figures.measure(rasterise([circle(80, width)], 256))
    unit = 160 + width
    assert found.ends == found.junctions == found.corners == 0
    assert found.length == pytest.approx(2 * np.pi * 80 / unit, rel=0.07)  # a chain of pixels is longer
    assert found.width == pytest.approx(1000 * width / unit, rel=0.12)
    assert found.turning == pytest.approx(unit / 80, rel=0.15)
    assert found.density == pytest.approx(2 * np.pi * 80 * width / unit**2, rel=0.1)


def test_a_cross_has_four_ends_and_one_junction(figures: ModuleType) -> None:
    found = figures.measure(rasterise([line((40, 60), (200, 180)), line((60, 200), (190, 50))], 256))
    assert (found.ends, found.junctions) == (4, 1)
    assert found.ends_per_length == pytest.approx(4 / (found.length), rel=1e-6)


def test_a_corner_is_counted_once(figures: ModuleType) -> None:
    found = figures.measure(rasterise([line((40, 40), (40, 200), (200, 200))], 256))
    assert found.corners * found.length == pytest.approx(1, rel=0.1)
    assert (found.ends, found.junctions) == (2, 0)


def test_a_marker_has_no_whiskers(figures: ModuleType) -> None:
    found = figures.measure(rasterise([line((40, 60), (200, 180), width=9.0)], 256))
    assert (found.ends, found.junctions) == (2, 0)


def test_paper_has_no_figures(figures: ModuleType) -> None:
    with pytest.raises(ValueError, match="without ink"):
        figures.measure(np.zeros((64, 64)))
