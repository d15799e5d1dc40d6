"""The studio's page at a hand's pace: the map follows while the pen is down, and nothing is left standing."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest
from studio_page import SIDE, OnlyPage, Server, Studio, open_studio

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start


@pytest.fixture
def studio(only_page: OnlyPage) -> Iterator[Studio]:
    """An empty drawing, and what of it was sent: longer side of the map, base and bytes of each request.

    While ``holding``, answers to drafts wait in ``held``.
    """
    with only_page.renewed() as page:
        page.page.evaluate(
            """() => {
              window.sent = [];
              window.held = [];
              window.holding = false;
              const ask = window.fetch;
              window.fetch = async (path, options) => {
                if (path === "/api/predict") {
                  const length = new DataView(options.body.buffer).getUint32(0, true);
                  const fields = JSON.parse(new TextDecoder().decode(options.body.subarray(4, 4 + length)));
                  const bytes = options.body.length - 4 - length;
                  const [{ base }] = fields.layers;
                  const { longest, draft, number, changed_only: changedOnly } = fields;
                  const aborted = () => options.signal.aborted;
                  sent.push({ longest, draft, changedOnly, base, number, bytes, aborted });
                  const answer = await ask(path, options);
                  if (holding && draft) await new Promise((resolve) => held.push(resolve));
                  return answer;
                }
                return ask(path, options);
              };
            }"""
        )
        yield page


def test_the_map_follows_while_the_pen_is_down_and_is_refined_when_it_lifts(studio: Studio) -> None:
    studio.new(512, 512)
    page = studio.page
    angles = [math.tau * i / 60 for i in range(61)]
    points = [studio.on_board(256 + 150 * math.cos(a), 256 + 150 * math.sin(a)) for a in angles]
    page.mouse.move(*points[0])
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*point)
    page.wait_for_function("() => Number(document.getElementById('result').dataset.painted ?? 0) > 0")
    assert page.locator("#result").get_attribute("aria-busy") == "true"  # finer is to come
    assert page.evaluate("sent.at(-1).longest") == 256
    with studio.repainting(begun=True):
        page.mouse.up()
    assert page.evaluate("sent.at(-1).longest") is None


def test_no_request_is_broken_off_and_only_what_changed_is_sent(studio: Studio) -> None:
    studio.new()
    with studio.repainting():
        studio.circle()
    page = studio.page
    page.evaluate("() => { sent.length = 0; }")
    for i in range(12):  # faster than any server paints
        studio.line((100 + 3 * i, 120), (104 + 3 * i, 130))
    page.wait_for_function("() => document.getElementById('result').ariaBusy === 'false'")
    requests = page.evaluate("sent.map((each) => ({ ...each, aborted: each.aborted() }))")
    assert requests
    assert not any(each["aborted"] for each in requests)
    assert all(each["base"] is not None and each["bytes"] < SIDE * SIDE / 4 for each in requests)
    assert studio.predicted() >= 2


@pytest.mark.parametrize(("side", "coarse"), [(512, 256), (256, None)])
def test_the_end_of_a_stroke_waits_for_no_draft(studio: Studio, side: int, coarse: int | None) -> None:
    page = studio.page
    page.evaluate("() => { performance.now = () => 0; }")  # else it is not given up where the machine is slow
    studio.new(side, side)
    with studio.repainting():
        studio.circle()
    page.evaluate("() => { sent.length = 0; holding = true; }")
    page.mouse.move(*studio.on_board(100, 100))
    page.mouse.down()
    page.mouse.move(*studio.on_board(140, 130))
    page.wait_for_function("() => held.length === 1")
    with studio.repainting(begun=True):
        page.mouse.up()
    before = page.locator("#result").get_attribute("data-painted")
    asked = page.evaluate("sent.map(({ draft, longest }) => [draft, longest])")
    assert asked == [[True, coarse], [False, None]]
    # The draft's answer comes late, and is not shown.
    page.evaluate("() => { held[0](); }")
    page.wait_for_timeout(100)
    assert page.locator("#result").get_attribute("data-painted") == before
    assert page.evaluate("sent.length") == 2


def draw_slowly(studio: Studio, took: int) -> None:
    """Begin a drawing; on the page's clock, only whole maps take time: ``took`` milliseconds each."""
    page = studio.page
    page.evaluate("() => { window.time = 0; performance.now = () => time; }")
    studio.new(512, 512)
    page.evaluate(
        """(took) => {
          const ask = window.fetch;
          window.fetch = async (path, options) => {
            const asked = ask(path, options);
            // Asked now: the answer to a draft that was given up may come after the whole map was asked for.
            const whole = path === "/api/predict" && sent.at(-1).longest === null;
            const answer = await asked;
            if (whole) time += took;
            return answer;
          };
        }""",
        took,
    )


@pytest.mark.parametrize(
    ("took", "since", "waits"), [(0, 260, False), (0, 301, True), (200, 60, False), (200, 90, True)]
)
def test_a_draft_is_waited_for_where_a_hand_would_see_no_map_for_too_long(
    studio: Studio, took: int, since: int, waits: bool
) -> None:
    """The pen lifts ``since`` milliseconds after a map, while a draft is painted."""
    page = studio.page
    draw_slowly(studio, took)
    with studio.repainting():
        studio.circle()
    page.evaluate("() => { sent.length = 0; holding = true; }")
    page.mouse.move(*studio.on_board(100, 100))
    page.mouse.down()
    page.mouse.move(*studio.on_board(140, 130))
    page.wait_for_function("() => held.length === 1")
    page.evaluate("(since) => { time += since; holding = false; }", since)
    if waits:
        page.mouse.up()
        page.wait_for_timeout(50)
        assert page.evaluate("sent.length") == 1
    with studio.repainting(begun=True):
        if waits:
            page.evaluate("() => { held[0](); }")
        else:
            page.mouse.up()
    assert page.evaluate("sent.map(({ draft }) => draft)") == [True, False]


def test_where_a_map_takes_longer_than_a_stroke_one_of_half_its_size_comes_first(studio: Studio) -> None:
    page = studio.page
    draw_slowly(studio, 1100)
    with studio.repainting():
        studio.circle()
    page.evaluate("() => { sent.length = 0; holding = true; }")
    asked = "sent.map(({ draft, longest }) => [draft, longest])"
    studio.line((100, 100), (140, 130))
    for _ in range(2):  # a draft of the stroke may come first
        page.wait_for_function("() => held.length")
        if page.evaluate("sent.at(-1).longest") is None:
            break
        page.evaluate("() => held.pop()()")
    assert page.evaluate(asked)[-2:] == [[False, 256], [True, None]]
    # It is on show, and the fine one gives way to the next stroke.
    assert page.locator("#result").get_attribute("aria-busy") == "true"
    page.evaluate("() => { holding = false; window.fine = sent.at(-1); }")
    with studio.repainting(begun=True):
        studio.line((100, 140), (140, 150))
        page.evaluate("held.splice(0).forEach((each) => each())")
    assert page.evaluate("fine.aborted()")
    assert page.evaluate(asked)[-2:] == [[False, 256], [True, None]]


def test_what_a_stroke_changes_is_on_show_before_the_other_layers_follow(studio: Studio) -> None:
    studio.new()
    with studio.repainting():
        studio.circle()
    page = studio.page
    page.locator("#layers-toggle").click()
    page.locator("#layer-add").click()
    with studio.repainting():
        studio.circle(90, 90, 40)
    with studio.repainting():
        studio.line((80, 90), (100, 90))
    page.evaluate("() => { sent.length = 0; holding = true; }")
    before = studio.predicted()
    page.keyboard.press("Control+z")
    page.wait_for_function("() => held.length === 1")  # the other layer
    assert studio.predicted() == before + 1
    page.keyboard.press("Control+Shift+z")
    page.wait_for_function("() => held.length === 2")
    assert studio.predicted() == before + 2  # the newer change did not wait
    assert page.locator("#result").get_attribute("aria-busy") == "true"
    with studio.repainting(begun=True):
        page.evaluate("() => { for (const release of held) release(); }")
    assert studio.predicted() == before + 3
    shown = "({ draft, changedOnly, aborted }) => [draft, changedOnly, draft && aborted()]"
    asked = page.evaluate(f"sent.map({shown})")
    first, others = [False, True, False], [True, False]
    assert asked == [first, [*others, True], first, [*others, False]]


def test_the_map_goes_when_all_is_erased(studio: Studio) -> None:
    studio.new(64, 64)
    with studio.repainting():
        studio.line((10, 10), (50, 10), (50, 50), (10, 50), (10, 10))
    page = studio.page
    page.locator("#tool-hint").click()
    page.locator("#suggest").click()
    page.locator("#chips .offer").first.wait_for()
    page.keyboard.press("e")
    for _ in range(8):
        page.keyboard.press("]")
    studio.line((2, 12), (62, 12), (62, 48), (2, 48))
    studio.line((10, 10), (10, 54), (40, 10), (52, 30))
    page.locator("#empty-result").wait_for()
    assert page.locator("#warning").is_hidden()
    assert page.locator("#chips .offer").count() == 0


def test_a_sentence_about_an_early_line_does_not_stay(studio: Studio) -> None:
    studio.new()
    with studio.repainting():
        studio.circle()
    assert studio.page.locator("#warning").is_hidden()
    assert studio.page.locator("#problem").is_hidden(), studio.status()


def test_a_server_that_is_away_is_told_of_by_whatever_asks_it(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, tolerate=("Failed to load resource", "ERR_")) as studio:
        studio.new()
        with studio.repainting():
            studio.circle()
        page = studio.page
        page.route("**/api/**", lambda route: route.abort("connectionrefused"))
        with studio.saying("Can't reach the studio"):
            page.keyboard.press("Control+e")
            page.locator("#export-dialog button.strong").click()
        with studio.saying("Can't reach the studio"):
            page.keyboard.press("Control+s")
            page.locator("#name-field").fill("fox")
            page.locator("#save-dialog button.strong").click()


def test_an_export_has_the_projects_name_after_a_cancelled_one(studio: Studio) -> None:
    studio.new()
    with studio.repainting():
        studio.circle()
    page = studio.page
    page.keyboard.press("Control+e")
    page.locator("#export-name").fill("wrong")
    studio.dismiss("export")
    page.keyboard.press("Control+e")
    assert page.locator("#export-name").input_value() == ""
    studio.dismiss("export")


def test_the_balls_card_lets_clicks_through_and_can_be_moved(studio: Studio) -> None:
    studio.new()
    with studio.repainting():
        studio.circle()
    studio.pin(SIDE / 2, SIDE / 2)
    page = studio.page
    card, handle = page.locator("#point"), page.locator("#point-handle")
    before, grip = card.bounding_box(), handle.bounding_box()
    assert before is not None
    assert grip is not None
    start = grip["x"] + 30, grip["y"] + 10
    page.mouse.move(*start)
    page.mouse.down()
    middle = studio.on_board(SIDE / 2, SIDE / 2 - 30)
    page.mouse.move(middle[0] - 54, middle[1] - 10)
    page.mouse.up()
    after = card.bounding_box()
    assert after is not None
    assert abs(after["x"] - before["x"]) + abs(after["y"] - before["y"]) > 40
    # Beside the words of the card there is nothing of it: the click pins the next point.
    page.mouse.click(after["x"] + 6, after["y"] + after["height"] / 2)
    assert page.locator("#chips .chip").count() == 2
