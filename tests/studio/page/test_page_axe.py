"""The studio holds to the rules of axe-core (WCAG 2 and best practices), in both themes and at four sizes."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

import pytest
from studio_page import Server, Studio, open_studio

from npm_package import read_from_package

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.slow  # a server and a browser, and a package of npm
CHECK = """async (part) => (await axe.run(part ?? document, { resultTypes: ["violations"] })).violations
  .map(({ id, nodes }) => [id, nodes.map((node) => node.target.join(" "))])"""


@pytest.fixture(scope="module")
def axe() -> str:
    """Return the script of axe-core (MPL 2.0)."""
    checksum = "FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ=="
    return read_from_package("axe-core", "4.14.1", checksum, "axe.min.js")


# Colours do not depend on the size: each theme is seen narrow, with its sheets, and wide.
@pytest.mark.parametrize(
    ("width", "height", "theme"),
    [(390, 844, "light"), (844, 390, "dark"), (1024, 768, "dark"), (2560, 1440, "light")],
)
def test_axe_finds_nothing(
    opened: "Browser", server: Server, axe: str, width: int, height: int, theme: Literal["light", "dark"]
) -> None:
    tolerate = ("400",)
    with open_studio(opened, server.url, width=width, height=height, tolerate=tolerate) as studio:
        page = studio.page
        page.emulate_media(color_scheme=theme, reduced_motion="reduce")  # no colour on its way to another
        page.wait_for_function(f"() => document.documentElement.dataset.theme === '{theme}'")
        page.evaluate(axe)

        def check(shown: str, part: str | None = None) -> None:
            # What opens over the page alone: the rest is looked at where it can be used.
            assert page.evaluate(CHECK, part) == [], shown

        check("an empty drawing")
        _draw(studio)
        check("a point")
        page.locator("#layout-both").click()
        for sheet in ("menu", "tools"):
            if page.locator(f"#{sheet}-toggle").is_visible():
                page.locator(f"#{sheet}-toggle").click()
                check(f"the sheet of {sheet}")
                page.keyboard.press("Escape")
        page.keyboard.press("m")
        page.set_input_files("#import-file", {"name": "a.txt", "mimeType": "text/plain", "buffer": b"a"})
        page.locator("#problem").wait_for()
        page.locator("#problem-close").focus()  # it stays, however long the check takes
        check("something went wrong")
        page.locator("#problem-close").click()
        page.evaluate("document.getElementById('view-lit').click()")
        check("mask tool and material")
        page.locator("#lamp-more").click()
        page.locator("#light-both").check()
        check("lights")
        if page.locator("#looks-toggle").is_visible():
            page.locator("#looks-toggle").click()
            check("the sheet of looks")
            page.keyboard.press("Escape")
        page.keyboard.press("r")
        page.keyboard.press("g")
        check("the form of a layer")
        page.locator("#form-choose").click()
        page.wait_for_function("() => document.querySelectorAll('#form-card canvas').length === 4")
        check("forms to choose from", "#form-card")
        page.keyboard.press("Escape")
        page.keyboard.press("Shift+W")
        page.locator("#structure-choose").click()
        check("structures to choose from", "#structure-card")
        page.keyboard.press("Escape")
        page.locator("#layers-toggle").click()
        check("layers", "#layers")
        page.locator("#layers-close").click()
        page.locator("#paper summary").click()
        check("paper", "#paper")
        page.keyboard.press("Escape")
        _check_dialogs(page, check)


def _check_dialogs(page: "Page", check: Callable[[str, str], None]) -> None:
    for keys, dialog in (
        ("Control+e", "export"),
        ("?", "help"),
        ("Control+o", "open"),
        ("Control+s", "save"),
    ):
        page.keyboard.press(keys)
        page.locator(f"#{dialog}-dialog").wait_for()
        check(dialog, f"#{dialog}-dialog")
        page.keyboard.press("Escape")
        page.locator(f"#{dialog}-dialog").wait_for(state="hidden")
    page.locator("#paper summary").click()
    page.locator("#paper-resize").click()
    page.locator("#paper-dialog").wait_for()
    check("paper", "#paper-dialog")
    page.keyboard.press("Escape")
    page.locator("#paper-dialog").wait_for(state="hidden")
    if page.locator("#menu-toggle").is_visible():
        page.locator("#menu-toggle").click()
    page.locator("#new").click()
    page.locator("#choose").wait_for()
    check("unsaved changes", "#choose")
    page.locator("#choose button[value=drop]").click()
    page.locator("#new-dialog").wait_for()
    check("new", "#new-dialog")


def _draw(studio: Studio) -> None:
    studio.new()
    with studio.repainting():
        studio.circle()
    with studio.repainting():
        studio.pin(128, 128)
