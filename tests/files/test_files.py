"""Files are written whole or not at all."""

from pathlib import Path

import pytest

from normalgan.files.writing import write_bytes


def test_a_file_is_replaced_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    for content in (b"one", memoryview(b"two")):
        write_bytes(tmp_path / "a" / "b.bin", content)
        assert (tmp_path / "a" / "b.bin").read_bytes() == bytes(content)
    write_bytes(tmp_path / "a" / "b.bin", b"three", tmp_path / "partial" / "x", durable=False)
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["b.bin"]
    assert list((tmp_path / "partial").iterdir()) == []


def test_what_cannot_be_written_leaves_the_former_and_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.bin"
    write_bytes(path, b"one")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space left") as told:
        write_bytes(path, b"two")
    assert told.value.filename == str(path)
    assert path.read_bytes() == b"one"
    assert [each.name for each in tmp_path.iterdir()] == ["a.bin"]


def test_a_read_only_disk_names_the_file_and_not_the_temporary_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def read_only(*_: object, **__: object) -> None:
        raise OSError(30, "Read-only file system", "temporary")

    for method in ("open", "unlink"):  # Linux refuses to remove even a file that is not there
        monkeypatch.setattr(Path, method, read_only)
    with pytest.raises(OSError, match="Read-only") as told:
        write_bytes(tmp_path / "a.bin", b"one")
    assert told.value.filename == str(tmp_path / "a.bin")
