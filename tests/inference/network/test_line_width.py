"""Tests of how wide lines are: what is empty about a drawing makes no difference."""

import numpy as np
import pytest

from normalgan.inference.network.line_width import line_width


@pytest.mark.parametrize("width", [1, 2, 5, 8])
def test_the_width_of_lines_does_not_depend_on_the_paper_about_them(width: int) -> None:
    inked = np.zeros((60, 90), np.bool_)
    inked[20 : 20 + width] = inked[:, 40 : 40 + width] = True  # up to the edges of the picture
    tight = line_width(inked)
    assert abs(tight - width) <= 1
    inside = np.zeros((120, 150), np.bool_)
    inside[30:90, 30:120] = inked
    assert line_width(inside) == pytest.approx(tight, abs=0.5)
    assert line_width(np.pad(inside, ((50, 3), (0, 70)))) == line_width(inside)


def test_without_ink_there_is_no_width() -> None:
    assert line_width(np.zeros((8, 8), np.bool_)) == 0
