import math

import pytest

from normalgan.errors import InputError
from normalgan.line_widths import USUAL_WIDTHS, check_line_widths, line_widths_of


@pytest.mark.parametrize(
    "widths",
    [
        *([1.0], [1.0, 2.0, 3.0], [2.0, 3.0], [0.5, 1.0], [-1.0, 2.0], [0.5, math.inf], [math.nan, 2.0]),
        *("12", ["0.5", "5.0"], 3, None),
    ],
)
def test_anything_but_two_widths_is_refused_in_one_sentence(widths: object) -> None:
    with pytest.raises(InputError, match=r"^line_widths is .*; give two: .*\.$"):
        check_line_widths(widths)


def test_a_file_of_an_older_version_says_nothing_and_knows_the_usual_widths() -> None:
    assert line_widths_of({}) == USUAL_WIDTHS


@pytest.mark.parametrize("text", ["wide", "0.5", "0.5 nan", "5 0.5", ""])
def test_what_a_file_says_is_checked(text: str) -> None:
    with pytest.raises(InputError, match="line_widths is"):
        line_widths_of({"line_widths": text})
