import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from normalgan.rendering.strokes import chain


def ray(angle: float, length: int = 8) -> np.ndarray:
    return np.arange(1, length + 1)[:, None] * [np.cos(angle), np.sin(angle)]


def star(*degrees: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points and links of lines that meet in point 0, as many points each."""
    rays = [ray(np.deg2rad(angle)) for angle in degrees]
    points = np.concatenate([np.zeros((1, 2)), *rays])
    links = [
        (0 if i == 0 else 8 * k + i, 8 * k + i + 1) for k in range(len(rays)) for i in range(len(rays[0]))
    ]
    return points, np.array(links)


def undirected(paths: list[np.ndarray]) -> list[tuple[int, int]]:
    return sorted(
        tuple(sorted(pair)) for path in paths for pair in zip(path.tolist(), path.tolist()[1:], strict=False)
    )


def test_the_straighter_two_of_three_go_on() -> None:
    points, links = star(0, 170, 80)
    long, short = sorted(chain(points, links), key=len, reverse=True)
    assert {long[0], long[-1]} == {8, 16}
    assert {short[0], short[-1]} == {0, 24}


def test_two_lines_that_cross_stay_two() -> None:
    points, links = star(0, 70, 180, 250)
    assert sorted(sorted((path[0], path[-1])) for path in chain(points, links)) == [[8, 24], [16, 32]]


def test_a_corner_too_sharp_ends_what_meets_there() -> None:
    assert len(chain(*star(0, 100, 110))) == 3


def test_directions_are_taken_some_way_off() -> None:
    # Three lines whose first steps mislead: each starts out along the grid.
    points, links = star(0, 180, 90)
    points[9], points[17] = [0, 1], [-1, 0]
    longest = max(chain(points, links), key=len)
    assert {longest[0], longest[-1]} == {8, 16}


def test_a_ring_is_closed_and_may_pass_through_a_junction() -> None:
    turn = np.arange(24) * np.pi / 12
    ring = 15 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    links = np.stack([np.arange(24), np.roll(np.arange(24), -1)], axis=1)
    (path,) = chain(ring, links)
    assert path[0] == path[-1]
    assert len(path) == 25
    points = np.concatenate([ring, [[16.0, 0.0], [17.0, 0.0]]])
    tail = np.array([[0, 24], [24, 25]])
    paths = chain(points, np.concatenate([links, tail]))
    assert sorted(len(path) for path in paths) == [3, 25]
    assert max(paths, key=len)[0] == max(paths, key=len)[-1]


def test_a_figure_of_eight_is_one_stroke() -> None:
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    eight = np.stack([np.sin(turn), np.sin(2 * turn)], axis=1) * 10  # passes through the origin at 0 and 30
    numbers = np.where(np.arange(60) == 30, 0, np.arange(60))
    links = np.stack([numbers, np.roll(numbers, -1)], axis=1)
    (path,) = chain(eight, links)
    assert path[0] == path[-1]
    assert len(path) == 61


def test_no_pieces_make_no_strokes() -> None:
    assert chain(np.zeros((0, 2)), np.zeros((0, 2), np.int64)) == []
    assert chain(np.zeros((3, 2)), np.zeros((0, 2), np.int64)) == []


@settings(max_examples=200, deadline=None)
@given(
    st.integers(2, 14).flatmap(
        lambda n: st.sets(
            st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)).filter(lambda pair: pair[0] < pair[1]),
            max_size=3 * n,
        ).map(lambda links: (n, sorted(links)))
    )
)
def test_every_link_is_drawn_once(graph: tuple[int, list[tuple[int, int]]]) -> None:
    count, links = graph
    points = np.random.default_rng(count).normal(size=(count, 2))
    paths = chain(points, np.array(links, np.int64).reshape(-1, 2))
    assert undirected(paths) == links
