"""The page's words: each is used, each that is used is there, and each language has all of them."""

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from studio_page import Server, Studio

from chromium import page as open_page

if TYPE_CHECKING:
    from playwright.sync_api import Browser

from normalgan.studio.page_files import PAGE
from normalgan.studio.predictions.exports import with_export_menu

TEXTS = PAGE / "text"
STATIC = Path(__file__).parents[3] / "tools" / "static_studio"
CUT_OFF = """() => [...document.querySelectorAll(".options > .quiet, #outcome > .bar")]
  .filter((each) => each.checkVisibility({ opacityProperty: true }))
  .filter((each) => each.scrollHeight > each.clientHeight + 1 || each.scrollWidth > each.clientWidth)
  .map((each) => each.textContent)"""
"""What of help and of the bar of views is not all to be seen."""


def test_no_words_are_left_over_and_none_are_missing() -> None:
    words = (TEXTS / "text.js").read_text(encoding="utf-8")
    known = set(re.findall(r"^  (\w+):", words, re.M)) - {"viewerTexts"}
    scripts = [path for path in PAGE.rglob("*.js") if path.parent != TEXTS]
    scripts += STATIC.glob("*.js")  # of the page without a server
    others = "".join(path.read_text(encoding="utf-8") for path in scripts)
    markup = with_export_menu((PAGE / "index.html").read_text(encoding="utf-8"))
    markup += (STATIC.parent / "site" / "static_studio.py").read_text(encoding="utf-8")
    named = set(re.findall(r'data-(?:text|label)="(\w+)"', markup))
    named |= {each for formats in re.findall(r'data-formats="([^"]+)"', markup) for each in formats.split()}
    named |= set(re.findall(r'(?:\btext\.|\bsay\(")(?!js\b)(\w+)', others)) - {"viewerTexts"}
    # The viewer is handed its own words.
    assert named - {"contextLost", "reliefNeedsWebgl", "webglFailed"} <= known
    quoted = set(re.findall(r'"(\w+)"', others))  # chosen by a condition, or listed with their keys
    assert sorted(known - named - quoted) == []


SAME = {
    "title",
    "at",
    "pixels",
    "matcap",
    "unity",
    "unreal",
    "godot",
    "godot3",
    "blender",
    "png",
    "glb",
    "obj",
}
"""Names and figures, which are the same in all languages."""
LANGUAGES = sorted(path.stem.removeprefix("text_") for path in TEXTS.glob("text_*.js"))


def words_of(name: str) -> dict[str, str]:
    """Return the words in a file by their keys."""
    return dict(re.findall(r'^ +(\w+): "(.*)",$', (TEXTS / name).read_text(encoding="utf-8"), re.M))


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_words_are_missing_in_a_language(language: str) -> None:
    english, other = words_of("text.js"), words_of(f"text_{language}.js")
    assert sorted(set(english) - SAME - set(other)) == []
    assert sorted(set(other) - set(english)) == []
    assert [key for key, words in other.items() if not words.strip()] == []
    blanks = re.compile(r"\{\w+\}")
    differ = [
        key for key in other if sorted(blanks.findall(other[key])) != sorted(blanks.findall(english[key]))
    ]
    assert differ == []
    assert "Machine-drafted" in (TEXTS / f"text_{language}.js").read_text(encoding="utf-8").splitlines()[0]


def test_every_language_is_listed() -> None:
    listed = re.search(r"LANGUAGES = \[(.*)\]", (TEXTS / "text.js").read_text(encoding="utf-8"))
    assert listed is not None
    assert re.findall(r'"(\w+)"', listed[1]) == LANGUAGES


@pytest.mark.slow  # a server and a browser, which take seconds to start
@pytest.mark.parametrize("locale", ["en-US", "de-DE", "es-ES", "fr-FR", "ja-JP", "zh-CN"])
def test_no_words_beside_the_tools_and_views_are_cut_off(
    opened: "Browser", server: Server, locale: str
) -> None:
    with open_page(opened, width=1280, height=800, locale=locale) as page:
        studio = Studio(page, server.url)
        for width in (1024, 1280, 1920):
            page.set_viewport_size({"width": width, "height": 800})
            for tool in "peshrdmlv":
                page.keyboard.press(tool)
                studio.wait_for_frame()
                assert page.evaluate(CUT_OFF) == [], (width, tool)
                help_ = page.locator("#select-help")
                helped = help_.evaluate("e => e.checkVisibility() && !e.matches('.cut')")
                assert helped == (tool == "s" and width > 1024)


@pytest.mark.slow  # a server and a browser, which take seconds to start
@pytest.mark.parametrize(
    ("locale", "language", "words"), [("de-AT", "de", "Exportieren"), ("it-IT", "en", "Export")]
)
def test_the_browsers_language_is_chosen(
    opened: "Browser", server: Server, locale: str, language: str, words: str
) -> None:
    with open_page(opened, width=1200, height=700, locale=locale) as page:
        Studio(page, server.url)
        assert page.locator("#export").inner_text() == words
        assert page.evaluate("document.documentElement.lang") == language
        # Longer words fit, and so does a page that is read from right to left.
        for direction in ("ltr", "rtl"):
            page.evaluate("way => { document.documentElement.dir = way; }", direction)
            for width in (1200, 1280, 1440):
                page.set_viewport_size({"width": width, "height": 700})
                assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (direction, width)
            page.set_viewport_size({"width": 1200, "height": 700})
            tools, drawing = (page.locator(each).bounding_box() for each in ("#tools", "#drawing"))
            assert tools is not None
            assert drawing is not None
            assert (tools["x"] < drawing["x"]) == (direction == "ltr")
            doubt = page.locator("#doubt").bounding_box()
            assert doubt is not None
            assert 0 <= doubt["x"] <= 1200 - doubt["width"]
