"""The pages that the reader is trained on: pictures with what is true of them."""

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

TOOLS = Path(__file__).parents[1] / "tools" / "reader"
sys.path.insert(0, str(TOOLS))  # its files import one another
PAGES = runpy.run_path(str(TOOLS / "pages.py"))
SHAPES = runpy.run_path(str(TOOLS / "shapes.py"))
sys.path.remove(str(TOOLS))
DOODLES = ("figure", "animal", "blob", "thing", "stick", "ring", "snow")


@pytest.mark.parametrize("kind", PAGES["KINDS"])
def test_a_page_of_each_kind_has_an_object_with_lines(kind: str) -> None:
    for seed in range(6):
        page = PAGES["page"](np.random.default_rng(seed), [], (128, 160), kind)
        assert page.picture.shape == (128, 160, 3)
        assert page.ink.shape == page.presence.shape == page.weight.shape == (128, 160)
        assert 0 <= page.presence.min() <= page.presence.max() <= 1
        assert page.presence.max() > 0.5
        assert page.ink.max() > 0.3
        again = PAGES["page"](np.random.default_rng(seed), [], (128, 160), kind)
        assert np.array_equal(again.picture, page.picture)


@pytest.mark.parametrize("kind", DOODLES)
def test_doodles_are_contours_and_strokes_of_points(kind: str) -> None:
    for seed in range(8):
        shape = SHAPES["_Doodle"](np.random.default_rng(seed)).draw(kind)
        assert shape.contours[0]
        for points in [*shape.contours[0], *shape.strokes, *shape.bare]:
            assert points.ndim == 2
            assert points.shape[1] == 2
            assert np.isfinite(points).all()


def test_a_ring_has_a_hole() -> None:
    pierced = [SHAPES["_Doodle"](np.random.default_rng(seed)).draw("ring").pierced for seed in range(8)]
    assert sum(pierced) >= 6
