"""Composition: parts hide what is behind them, and blend along their edges."""

import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.inference.composites.composition import compose
from normalgan.inference.findings import Finding
from normalgan.inference.normal_map import NormalMap

RIGHT, LEFT, UP = (0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8)


def part(
    normal: tuple[float, float, float], alpha: Floats, confidence: float | None = None, warning: str = ""
) -> NormalMap:
    """A part with one normal everywhere."""
    normals = np.broadcast_to(np.array(normal, np.float32), (*alpha.shape, 3)).copy()
    sure = None if confidence is None else np.full(alpha.shape, confidence, np.float32)
    said = (Finding("note", words=warning),) if warning else ()
    return NormalMap(normals, alpha >= 0.5, alpha, np.zeros((4, 4), np.float32), sure, said)


def box(left: int, right: int) -> Floats:
    """Opacity of a part that goes from one column of twelve to another."""
    alpha = np.zeros((4, 12), np.float32)
    alpha[:, left:right] = 1
    return alpha


def test_one_alone_is_returned_as_it_is() -> None:
    alone = part(RIGHT, box(2, 6))
    assert compose([alone]) is alone


def test_the_front_hides_what_is_behind_it() -> None:
    back, front = part(RIGHT, box(1, 7), 3.0), part(LEFT, box(5, 10), 9.0)
    found = compose([back, front])
    np.testing.assert_array_equal(found.mask[0], (box(1, 10) > 0)[0])
    np.testing.assert_array_equal(found.alpha, box(1, 10))
    np.testing.assert_allclose(found.normal[0, 1:5], [RIGHT] * 4, atol=1e-6)
    np.testing.assert_allclose(found.normal[0, 5:10], [LEFT] * 5, atol=1e-6)
    assert found.confidence is not None
    np.testing.assert_array_equal(found.confidence[0, 1:10], [3, 3, 3, 3, 9, 9, 9, 9, 9])
    np.testing.assert_allclose(compose([front, back]).normal[0, 1:7], [RIGHT] * 6, atol=1e-6)
    np.testing.assert_array_equal(
        back.extended[0, 8], np.array(RIGHT, np.float32)
    )  # what was given is as it was


def test_a_soft_edge_blends_with_what_is_behind_it_and_with_nothing_else() -> None:
    alpha = box(5, 10)
    alpha[:, 5], alpha[:, 9] = 0.25, 0.25
    found = compose([part(RIGHT, box(1, 7)), part(UP, alpha)])
    mixed = 0.75 * np.array(RIGHT) + 0.25 * np.array(UP)
    np.testing.assert_allclose(found.normal[0, 5], mixed / np.linalg.norm(mixed), atol=1e-6)
    np.testing.assert_allclose(found.extended[0, 9], UP, atol=1e-6)  # nothing lies behind there
    np.testing.assert_allclose(found.alpha[0, [5, 9]], [1, 0.25])


def test_of_three_the_hindmost_shows_through_both() -> None:
    half = np.full((4, 12), 0.5, np.float32)
    found = compose([part(RIGHT, np.ones_like(half)), part(LEFT, half), part(UP, half)])
    mixed = 0.5 * np.array([0, 0, 1]) + 0.5 * np.array(UP)  # left and right make what faces the viewer
    np.testing.assert_allclose(
        found.normal, np.broadcast_to(mixed / np.linalg.norm(mixed), (4, 12, 3)), atol=1e-6
    )


def test_off_all_parts_the_nearest_goes_on() -> None:
    found = compose([part(RIGHT, box(1, 3)), part(LEFT, box(8, 10))])
    np.testing.assert_allclose(found.extended[0, [0, 4, 7, 11]], [RIGHT, RIGHT, LEFT, LEFT], atol=1e-6)
    assert not found.mask[0, [0, 4, 7, 11]].any()


def test_warnings_are_all_said_and_confidence_needs_all() -> None:
    found = compose(
        [
            part(UP, box(1, 3), 2.0, "a gap"),
            part(UP, box(4, 6), None, "a hole"),
            part(UP, box(7, 8), 1.0, "a gap"),
        ]
    )
    assert found.warning == "a gap; a hole"
    assert found.confidence is None
    assert found.seen.shape == (8, 8)


def test_maps_of_two_sizes_are_refused() -> None:
    with pytest.raises(ValueError, match="same size"):
        compose([part(UP, box(1, 3)), part(UP, np.ones((5, 5), np.float32))])
    with pytest.raises(ValueError, match="same size"):
        compose([])
