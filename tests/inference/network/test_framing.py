import numpy as np
import pytest

from normalgan.inference.network.framing import Frame


def ellipse(h: int = 90, w: int = 200) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    y, x = np.mgrid[:h, :w]
    radius = np.hypot((x - 130) / 50, (y - 40) / 25)
    return np.asarray(np.abs(radius - 1) < 0.06, np.float32)


@pytest.mark.parametrize("size", [32, 64, 256])
def test_a_frame_holds_the_lines_with_its_margin(size: int) -> None:
    ink = ellipse()
    shown = Frame.around(ink, size).cut(ink)
    assert shown.shape == (size, size)
    columns = np.flatnonzero((shown > 0.1).any(0))
    assert columns[0] == pytest.approx(0.06 * size, abs=1.5)
    assert columns[-1] == pytest.approx(0.94 * size, abs=1.5)


def test_restoring_brings_everything_back_to_its_place() -> None:
    ink = ellipse()
    frame = Frame.around(ink, 128)
    back = frame.restore(frame.cut(ink)[..., None].repeat(3, -1))
    assert back.shape == (90, 200, 3)
    y, x = np.mgrid[:90, :200]
    for before, after in ((x, x), (y, y)):
        assert np.average(before, weights=ink) == pytest.approx(
            np.average(after, weights=back[..., 0]), abs=0.1
        )


def test_hints_move_with_the_frame() -> None:
    ink = ellipse()
    frame = Frame.around(ink, 64)
    points = np.array([[130.5, 40.5], [0.5, 0.5]])  # the second lies outside the frame and is left out
    hints = frame.cut_points(points, np.array([[0, 1, 0], [0, 0, 1]], np.float32))
    assert hints.shape == (4, 64, 64)
    assert hints[3].sum() == 1
    row, column = np.argwhere(hints[3])[0]
    assert abs(row - 32) <= 1
    assert abs(column - 32) <= 1
    assert hints[:3, row, column].tolist() == [0, 1, 0]


@pytest.mark.parametrize("size", [32, 64])
def test_paper_around_a_drawing_changes_nothing_in_its_frame(size: int) -> None:
    """The frame is larger than the drawing, or lies inside the larger paper."""
    ink = ellipse()[:70, 70:190]
    wide = np.pad(ink, 80)
    frames = Frame.around(ink, size), Frame.around(wide, size)
    outside, inside = (frame.top < 0 for frame in frames)
    assert outside
    assert not inside
    assert np.array_equal(frames[0].shrink(ink), frames[1].shrink(wide))
