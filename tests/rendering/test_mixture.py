import json
import pickle
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from mesh_shapes import ellipsoid
from scenes import sphere, view

from normalgan.errors import InputError
from normalgan.rendering import EmbreeRenderer, Views
from normalgan.rendering.lines import Brush, Mixture, OccludingContours, Silhouette
from normalgan.rendering.samples import Recipe

THIN, THICK = Silhouette(line_width=1), Silhouette(line_width=3)


@pytest.mark.parametrize(("weights", "share"), [([1, 3], 0.75), ([0.5, 0.0], 0.0), (None, 0.5)])
def test_styles_are_drawn_by_weight(weights: list[float] | None, share: float) -> None:
    mixture, rng = Mixture([THIN, THICK], weights), np.random.default_rng(0)
    drawn = Counter(mixture.choose(rng).line_width for _ in range(2000))  # type: ignore[attr-defined]
    assert drawn[3] / 2000 == pytest.approx(share, abs=0.04)


def test_a_drawing_is_in_one_style_throughout() -> None:
    seen = view(sphere(0, 0, 0, 0.6))
    widths = {
        tuple(sorted({float(w) for stroke in strokes for w in stroke.width}))
        for strokes in (Mixture([THIN, THICK]).trace(seen, np.random.default_rng(seed)) for seed in range(8))
    }
    assert widths == {(1.0,), (3.0,)}


def test_mixtures_may_be_mixed() -> None:
    nested = Mixture([Mixture([THIN]), Mixture([THICK])], [0, 1])
    (stroke,) = nested.trace(view(sphere(0, 0, 0, 0.6)), np.random.default_rng(0))
    assert stroke.width[0] == 3


def test_a_recipe_repeats_what_it_drew_and_differs_from_view_to_view() -> None:
    mesh = ellipsoid(1, 0.7, 0.5, subdivisions=3)
    recipe = Recipe(Views(), EmbreeRenderer(), Mixture([THIN, THICK, Brush()]), size=32)
    again = pickle.loads(pickle.dumps(recipe))  # as worker processes get it
    first = [recipe.render(mesh, index).sketch for index in range(6)]
    for index in (5, 0, 3):
        np.testing.assert_array_equal(again.render(mesh, index).sketch, first[index])
    amounts = sorted(sketch.sum() / (sketch > 0).sum() for sketch in first)
    assert max(b / a for a, b in pairwise(amounts)) > 1.2  # thin ones and thick ones


def test_the_key_of_samples_tells_styles_and_weights() -> None:
    def key(mixture: Mixture) -> str:
        return json.dumps(Recipe(Views(), EmbreeRenderer(), mixture).describe())

    one = key(Mixture([THIN, THICK], [1, 2]))
    assert one == key(Mixture([THIN, THICK], [1, 2]))
    assert one != key(Mixture([THIN, THICK], [2, 1]))
    assert one != key(Mixture([THIN, OccludingContours()], [1, 2]))


def test_weights_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InputError, match="empty list; name at least one line style"):
        Mixture([])
    with pytest.raises(InputError, match="3 weights for 2 styles; give one weight per style"):
        Mixture([THIN, THICK], [1, 2, 3])
    for weights in ([0.0, 0.0], [1.0, -1.0], [1.0, float("nan")], [float("inf"), 1.0]):
        with pytest.raises(InputError, match="must be numbers of 0 or more, at least one above 0"):
            Mixture([THIN, THICK], weights)
