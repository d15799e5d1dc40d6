from pathlib import Path

import pytest
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.jobs.folders import find_drawings


def test_drawings_are_found_in_folders_globs_and_lists(tmp_path: Path) -> None:
    for name in ("b.png", "a.png", "c.jpg"):
        Image.new("L", (32, 32)).save(tmp_path / name)
    (tmp_path / "notes.txt").write_text("")
    assert [p.name for p in find_drawings(str(tmp_path))] == ["a.png", "b.png", "c.jpg"]
    assert [p.name for p in find_drawings(str(tmp_path / "*.png"))] == ["a.png", "b.png"]
    assert [p.name for p in find_drawings([str(tmp_path / "c.jpg"), str(tmp_path / "a.png")])] == [
        "c.jpg",
        "a.png",
    ]


def test_a_drawing_matched_twice_is_taken_once(tmp_path: Path) -> None:
    Image.new("L", (32, 32)).save(tmp_path / "a.png")
    assert find_drawings([str(tmp_path / "*.png"), str(tmp_path)]) == [tmp_path / "a.png"]


def test_drawings_that_lie_only_in_subfolders_are_named(tmp_path: Path) -> None:
    (tmp_path / "deep" / "er").mkdir(parents=True)
    Image.new("L", (32, 32)).save(tmp_path / "deep" / "er" / "a.png")
    with pytest.raises(InputError, match=r"only in subfolders such as .*er; .* with --recursive"):
        find_drawings(str(tmp_path))


def test_finding_nothing_or_one_name_twice_is_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no sketch found"):
        find_drawings(str(tmp_path))
    with pytest.raises(InputError, match="no sketch found"):
        find_drawings(str(tmp_path / "missing.png"))
    for name in ("a.png", "a.jpg"):
        Image.new("L", (32, 32)).save(tmp_path / name)
    with pytest.raises(InputError, match=r"both be written as a_normal\.png"):
        find_drawings(str(tmp_path))
