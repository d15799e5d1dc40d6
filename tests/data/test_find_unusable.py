from pathlib import Path

import pytest
from toys import Counted, Octahedron

from normalgan.data.render import find_unusable, leave_out
from normalgan.errors import InputError
from normalgan.rendering.mesh import Mesh

SOURCES = [Octahedron("a"), Octahedron("b", flaw="has no faces"), Octahedron("c", 0.3)]


def test_a_bad_mesh_is_told_apart_from_good_ones(tmp_path: Path) -> None:
    reasons = find_unusable(str(tmp_path), SOURCES)
    assert reasons == {"b": "b has no faces."}
    assert leave_out(SOURCES, reasons, "train", "mesh") == [SOURCES[0], SOURCES[2]]


class Legless(Octahedron):
    """Somebody else's, which raises what it likes."""

    def load(self) -> Mesh:
        raise KeyError("legs")


def test_a_source_that_raises_anything_leaves_out_that_mesh_alone(tmp_path: Path) -> None:
    assert find_unusable(str(tmp_path), [Legless("d"), *SOURCES[:1]]) == {"d": "KeyError: 'legs'."}


def test_each_mesh_is_loaded_once(tmp_path: Path) -> None:
    sources = [Counted("a"), Counted("b")]
    assert find_unusable(str(tmp_path), sources) == find_unusable(str(tmp_path), sources) == {}
    assert [source.loads for source in sources] == [["a"], ["b"]]
    (answer,) = (tmp_path / "meshes").glob("*.json")
    answer.write_text("{")
    assert find_unusable(str(tmp_path), sources) == {}
    assert [source.loads for source in sources] == [["a", "a"], ["b", "b"]]


def test_another_mesh_of_the_same_name_is_loaded(tmp_path: Path) -> None:
    assert find_unusable(str(tmp_path), [Octahedron("a", flaw="is torn")])
    assert not find_unusable(str(tmp_path), [Octahedron("a")])


def test_none_left_is_refused() -> None:
    with pytest.raises(InputError, match="the only mesh for train cannot be used: b is torn"):
        leave_out([Octahedron("b")], {"b": "b is torn."}, "train", "mesh")
    with pytest.raises(InputError, match="none of the 2 meshes for train can be used; the first: b is torn"):
        leave_out([Octahedron("b"), Octahedron("c")], {"b": "b is torn.", "c": "c is flat."}, "train", "mesh")
    with pytest.raises(InputError, match="there are no meshes for train"):
        leave_out([], {}, "train", "mesh")
