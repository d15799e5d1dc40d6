"""How much is read of a file, and what it takes."""

import tracemalloc
from pathlib import Path

import pytest

from normalgan.errors import InputError
from normalgan.files.limits import read_bounded


def test_a_small_file_takes_little_memory_whatever_may_be_read(tmp_path: Path) -> None:
    (tmp_path / "small").write_bytes(b"abc")
    tracemalloc.start()
    try:
        assert read_bounded(tmp_path / "small") == b"abc"
        assert tracemalloc.get_traced_memory()[1] < 1e6
    finally:
        tracemalloc.stop()
    assert read_bounded(tmp_path / "small", 3) == b"abc"
    with pytest.raises(InputError, match="has more than 2 bytes"):
        read_bounded(tmp_path / "small", 2)
