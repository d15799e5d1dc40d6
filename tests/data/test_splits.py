import itertools
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from needs import SHARED_MESHES
from normalgan.data.splits import split_by_file, split_by_fractions
from normalgan.errors import InputError

NAMES = [f"m{i}" for i in range(20)]


@given(st.integers(3, 60), st.tuples(*[st.integers(0, 10)] * 3).filter(any), st.integers(0, 5))
def test_every_mesh_in_one_split_in_proportion(count: int, parts: tuple[int, int, int], seed: int) -> None:
    names = [f"m{i}" for i in range(count)]
    shares = (parts[0] / sum(parts), parts[1] / sum(parts), parts[2] / sum(parts))
    split = split_by_fractions(names, shares, seed)
    assert sorted(itertools.chain(*split.values())) == sorted(names)
    for share, part in zip(shares, split.values(), strict=True):
        assert (len(part) > 0) == (share > 0)
        assert abs(len(part) - share * count) <= 2
        assert part == [name for name in names if name in part]


def test_exact_proportions_are_met() -> None:
    split = split_by_fractions(NAMES, (0.7, 0.05, 0.25))
    assert [len(part) for part in split.values()] == [14, 1, 5]
    assert list(split) == ["train", "val", "test"]


def test_split_depends_on_the_seed_but_not_on_the_order() -> None:
    split = split_by_fractions(NAMES, (0.5, 0.2, 0.3), seed=1)
    turned = split_by_fractions(NAMES[::-1], (0.5, 0.2, 0.3), seed=1)
    assert {k: set(v) for k, v in split.items()} == {k: set(v) for k, v in turned.items()}
    assert split != split_by_fractions(NAMES, (0.5, 0.2, 0.3), seed=2)


@pytest.mark.parametrize("fractions", [(0.5, 0.5, 0.5), (1.2, -0.2, 0), (float("nan"), 0, 1), (0, 0, 0)])
def test_fractions_must_be_shares(fractions: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="three shares"):
        split_by_fractions(NAMES, fractions)


def test_too_few_meshes_and_twins_are_refused() -> None:
    with pytest.raises(InputError, match=r"2 meshes cannot be split in 3 parts"):
        split_by_fractions(["a", "b"], (0.8, 0.1, 0.1))
    with pytest.raises(InputError, match="two meshes are named a;"):
        split_by_fractions(["a", "b", "a"], (0.5, 0.5, 0))


def write(folder: Path, content: object) -> Path:
    path = folder / "split.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_file_decides_and_the_rest_is_left_out_with_a_warning(tmp_path: Path) -> None:
    path = write(tmp_path, {"train": ["b", "a"], "test": ["d"]})
    with pytest.warns(UserWarning, match="left out, because .*: c, e"):
        split = split_by_file(path, ["a", "b", "c", "d", "e"])
    assert split == {"train": ["b", "a"], "val": [], "test": ["d"]}


def test_bundled_file_is_read() -> None:
    path = Path(__file__).parents[2] / ".." / "shared" / "meshes" / "fourleg" / "split.json"
    if not path.exists():
        pytest.skip(SHARED_MESHES.reason("it is not there"))
    names = [str(i) for i in range(381, 401)]
    split = split_by_file(path, names)
    assert [len(part) for part in split.values()] == [14, 1, 5]
    assert sorted(itertools.chain(*split.values())) == names


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"train": ["a", "x"]}, "names x, but there is no such mesh among the 3 given"),
        ({"train": ["a"], "val": ["a"]}, "names a more than once; a mesh belongs to one split only"),
        ({"train": ["a"], "valid": ["b"]}, "does not map train, val and test to names"),
        ({"train": "abc"}, "'train' in the split file .* is not a list of names"),
        ({"train": [1]}, "'train' in the split file .* is not a list of names"),
        (["a"], "does not map train, val and test"),
        ("{", "is not JSON"),
    ],
)
def test_bad_file_is_explained(tmp_path: Path, content: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        split_by_file(write(tmp_path, content), ["a", "b", "c"])


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.json cannot be read: No such file"):
        split_by_file(tmp_path / "none.json", ["a"])
