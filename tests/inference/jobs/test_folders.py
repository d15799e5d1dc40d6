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


def test_the_folder_of_a_glob_may_have_brackets_in_its_name(tmp_path: Path) -> None:
    (tmp_path / "[WIP] tree").mkdir()
    Image.new("L", (32, 32)).save(tmp_path / "[WIP] tree" / "a.png")
    assert find_drawings(str(tmp_path / "[WIP] tree" / "*.png")) == [tmp_path / "[WIP] tree" / "a.png"]


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
    with pytest.raises(
        InputError, match=r"a sketch has an empty name; name a file or a folder, such as '\.'"
    ):
        find_drawings("")  # not all drawings of the current folder
    for name in ("a.png", "a.jpg"):
        Image.new("L", (32, 32)).save(tmp_path / name)
    with pytest.raises(InputError, match=r"both be written as a_normal\.png"):
        find_drawings(str(tmp_path))
