"""The studio's page under fingers: one draws, two move and enlarge the paper, and beside a pen none draws."""

import pytest
from studio_page import SIDE, Hand, Point, Studio

# A server and a browser take seconds to start; every test begins with a circle, painted.
pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("ball")]
MIDDLE = SIDE / 2
LEFT, RIGHT = (MIDDLE - 80, MIDDLE), (MIDDLE + 80, MIDDLE)
"""Of the circle."""


def dark(studio: Studio, at: Point) -> bool:
    """Return whether there is ink at a point of the window, or a pixel beside it."""
    column, row = round(at[0]), round(at[1])
    near = studio.screen()[row - 1 : row + 2, column - 1 : column + 2]
    return bool(near.max(axis=2).min() < 128)


def test_one_finger_draws(studio: Studio) -> None:
    hand = Hand(studio)
    with studio.repainting():
        hand.put(studio.on_board(100, MIDDLE))
        for x in range(105, 160, 5):
            hand.move(studio.on_board(x, MIDDLE))
        hand.lift()
    assert studio.inked(130, MIDDLE)


@pytest.mark.parametrize("both", [True, False], ids=["two move", "one moves, one holds"])
def test_what_two_fingers_hold_stays_under_them(studio: Studio, *, both: bool) -> None:
    hand = Hand(studio)
    left, right = studio.on_board(*LEFT), studio.on_board(*RIGHT)
    hand.put(left)
    hand.put(left, right)
    for step in range(1, 9):  # apart
        held = (left[0] - 4 * step, left[1]) if both else left
        moved = right[0] + 8 * step, right[1]
        hand.move(held, moved)
    hand.lift()
    assert dark(studio, held)
    assert dark(studio, moved)
    assert not dark(studio, right)
    assert not dark(studio, ((held[0] + moved[0]) / 2, moved[1]))  # the first finger's stroke is dropped
    studio.page.locator("#zoom-fit").click()
    assert studio.inked(*LEFT)
    assert studio.inked(*RIGHT)


def test_two_fingers_move_the_paper_and_do_not_enlarge_it(studio: Studio) -> None:
    hand = Hand(studio)
    left, right = studio.on_board(*LEFT), studio.on_board(*RIGHT)
    hand.put(left)
    hand.put(left, right)
    for step in range(1, 9):
        held, moved = ((x + 5 * step, y - 3 * step) for x, y in (left, right))
        hand.move(held, moved)
    hand.lift()
    assert dark(studio, held)
    assert dark(studio, moved)


def test_once_there_is_a_pen_a_finger_only_moves_the_paper(studio: Studio) -> None:
    studio.page.evaluate(
        """() => {
            const common = {bubbles: true, pointerId: 77, pointerType: "pen", clientX: 300, clientY: 300};
            const board = document.getElementById("board");
            board.setPointerCapture = () => {};
            board.dispatchEvent(new PointerEvent("pointerdown", {...common, button: 0, pressure: 0.5}));
            board.dispatchEvent(new PointerEvent("pointerup", {...common, button: 0}));
            delete board.setPointerCapture;
        }"""
    )
    studio.page.locator("#undo").click()  # the pen's dot
    studio.page.wait_for_timeout(600)  # earlier, it would be the palm beside the pen
    hand = Hand(studio)
    right = studio.on_board(*RIGHT)
    hand.put(right)
    for step in range(1, 9):
        hand.move((right[0] - 5 * step, right[1] + 5 * step))
    hand.lift()
    assert dark(studio, (right[0] - 40, right[1] + 40))
    studio.page.locator("#zoom-fit").click()
    assert not studio.inked(MIDDLE + 60, MIDDLE + 20)  # where a stroke of the finger would be


def test_two_fingers_undo_and_three_redo(studio: Studio) -> None:
    hand = Hand(studio, pace=0.03)
    places = [studio.on_board(100 + 30 * i, 100) for i in range(3)]
    with studio.saying("Undone."):
        hand.put(places[0])
        hand.put(*places[:2])
        hand.lift()
    assert not studio.inked(*LEFT)
    with studio.saying("Redone."):
        hand.put(places[0])
        hand.put(*places[:2])
        hand.put(*places)
        hand.lift()
    assert studio.inked(*LEFT)


@pytest.mark.parametrize("tool", ["hint", "mask"])
def test_a_tap_of_two_fingers_undoes_what_a_tap_of_one_did_and_does_nothing_itself(
    ball: Studio, tool: str
) -> None:
    page, hand = ball.page, Hand(ball, pace=0.03)
    places = [ball.on_board(MIDDLE, MIDDLE), ball.on_board(MIDDLE - 40, MIDDLE - 30)]
    page.locator(f"#tool-{tool}").click()
    done = page.locator("#chips .chip" if tool == "hint" else "#mask-clear:enabled")
    hand.put(places[0])
    assert done.count() == 0  # it may be the first of two
    hand.lift()
    done.wait_for()
    if tool == "hint":
        box = page.locator("#point-done").bounding_box()
        assert box is not None
        hand.put((box["x"] + box["width"] / 2, box["y"] + box["height"] / 2))
        hand.lift()
    with ball.saying("Undone."):
        hand.put(places[0])
        hand.put(*places)
        hand.lift()
    assert done.count() == 0
