import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.reading.drawings import find_companion
from normalgan.inference.reading.hint_files import ENDINGS, load_hints


def test_painted_and_listed_hints_are_the_same(tmp_path: Path) -> None:
    image = Image.new("RGBA", (40, 30), (0, 0, 0, 0))
    image.putpixel((7, 20), (255, 128, 128, 255))
    image.save(tmp_path / "a.png")
    (tmp_path / "a.json").write_text(json.dumps([{"x": 7, "y": 20, "normal": [1, 0, 0]}]))
    painted, listed = (load_hints(tmp_path / name, (30, 40)) for name in ("a.png", "a.json"))
    assert painted.points.tolist() == listed.points.tolist() == [[7.5, 20.5]]
    assert np.allclose(painted.normals, listed.normals, atol=0.01)


def test_hints_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    for encoding in ("utf-8-sig", "utf-16"):
        (tmp_path / "a.json").write_text('[{"x": 7, "y": 20, "normal": [1, 0, 0]}]', encoding=encoding)
        assert load_hints(tmp_path / "a.json", (30, 40)).points.tolist() == [[7.5, 20.5]]


def test_no_hints_are_no_hints(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("[]")
    hints = load_hints(tmp_path / "a.json", (30, 40))
    assert hints.points.shape == (0, 2)
    assert hints.normals.shape == (0, 3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{}", "are not a list; they are like"),
        ("[1", "are not JSON: line 1"),
        ('[{"x": 1, "y": 2}]', r'hint 1 of .* is {"x": 1, "y": 2}; a hint has x, y and a normal'),
        ('[{"x": 1, "y": 2, "normal": [0, 1]}]', "and a normal of three numbers"),
        ('[{"x": 1, "y": true, "normal": [0, 0, 1]}]', "and a normal of three numbers"),
        ('[{"x": 1, "y": NaN, "normal": [0, 0, 1]}]', "and a normal of three numbers"),
        (
            '[{"x": 40, "y": 2, "normal": [0, 0, 1]}]',
            "hint 1 of .* lies at x 40, y 2, outside its drawing of 40 × 30",
        ),
        ('[{"x": -1, "y": 2, "normal": [0, 0, 1]}]', "outside its drawing"),
        (
            '[{"x": 1, "y": 2, "normal": [0, 3, 0]}]',
            r"\[0, 3, 0\] of hint 1 of .*, at x 1, y 2, has length 3;",
        ),
        (
            '[{"x": 1, "y": 2, "normal": [0.6, 0, -0.8]}]',
            r"\[0.6, 0, -0.8\] of hint 1 of .*, at x 1, y 2, looks away from the viewer; its z must be 0 o",
        ),
        ("\x80", "are not text"),
        ("[" * 100_000, "are not a list of hints"),
        ("[" + "9" * 5000 + "]", "are not a list of hints"),
        ('[{"x": 1' + "0" * 400 + ', "y": 2, "normal": [0, 0, 1]}]', "and a normal of three numbers"),
    ],
    ids=lambda each: str(each)[:40],
)
def test_bad_hints_are_named(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "a.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match=message):
        load_hints(tmp_path / "a.json", (30, 40))


def test_hints_are_found_by_name_and_a_drawing_is_not_its_own(tmp_path: Path) -> None:
    drawing = tmp_path / "fox.png"
    drawing.touch()
    assert find_companion(drawing, tmp_path, ENDINGS) is None
    (tmp_path / "fox.json").touch()
    assert find_companion(drawing, tmp_path, ENDINGS) == tmp_path / "fox.json"
    (tmp_path / "fox_hints.png").touch()
    assert find_companion(drawing, tmp_path, ENDINGS) == tmp_path / "fox_hints.png"
    assert find_companion(Path("other.png"), tmp_path / "fox.json", ENDINGS) == tmp_path / "fox.json"


def test_a_list_of_no_hints_size_is_not_read(tmp_path: Path) -> None:
    with (tmp_path / "a.json").open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(InputError, match=r"a\.json has more than 16777216 bytes; no file of its kind"):
        load_hints(tmp_path / "a.json", (30, 40))


def test_a_painted_hint_that_looks_away_is_named_and_one_that_is_rounded_is_taken(tmp_path: Path) -> None:
    image = Image.new("RGBA", (40, 30), (0, 0, 0, 0))
    image.putpixel((7, 20), (255, 128, 127, 255))  # z of 0 has no colour of 8 bits: 127 is -0.004
    image.save(tmp_path / "a.png")
    assert load_hints(tmp_path / "a.png", (30, 40)).normals[0, 2] == pytest.approx(0, abs=0.01)
    (tmp_path / "a.json").write_text('[{"x": 7, "y": 20, "normal": [1, 0, -0.004]}]')
    assert len(load_hints(tmp_path / "a.json", (30, 40)).points) == 1
    image.putpixel((9, 20), (128, 128, 0, 255))
    image.save(tmp_path / "a.png")
    named = r"the colour \[128, 128, 0\] at x 9, y 20 of .* looks away from the viewer: its z is -1\.00"
    with pytest.raises(InputError, match=named):
        load_hints(tmp_path / "a.png", (30, 40))
