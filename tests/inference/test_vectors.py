"""Vectors of large pictures, which are computed in strips, against what is said of one vector."""

import numpy as np

from normalgan.inference.vectors import lengths, unit


def many() -> np.ndarray:
    """Return vectors that take several strips, (H, W, 3), the last of which is shorter; some are zero."""
    vectors = np.random.default_rng(1).normal(size=(301, 257, 3)).astype(np.float32)
    vectors[::7, ::5] = 0
    return vectors


def test_lengths_of_all_strips_are_those_of_the_vectors() -> None:
    vectors = many()
    np.testing.assert_allclose(lengths(vectors), np.linalg.norm(vectors, axis=-1), rtol=1e-6)


def test_unit_vectors_of_all_strips_point_where_the_vectors_do() -> None:
    vectors = many()
    none = ~vectors.any(-1)
    found = unit(vectors, front=True)
    np.testing.assert_allclose(np.linalg.norm(found, axis=-1), 1, atol=1e-6)
    assert (found[none] == [0, 0, 1]).all()
    np.testing.assert_allclose((found * vectors).sum(-1)[~none], lengths(vectors)[~none], rtol=1e-5)
    assert not unit(vectors)[none].any()


def test_vectors_may_be_replaced_by_their_unit_vectors() -> None:
    vectors = many()
    wanted = unit(vectors)
    assert unit(vectors, out=vectors) is vectors
    assert (vectors == wanted).all()
