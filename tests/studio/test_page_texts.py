"""The page's words: each is used, and each that is used is there."""

import re
from pathlib import Path

from normalgan.studio.exports import with_export_menu

PAGE = Path(__file__).parents[2] / "src/normalgan/studio/page"


def test_no_words_are_left_over_and_none_are_missing() -> None:
    words = (PAGE / "text.js").read_text(encoding="utf-8")
    known = set(re.findall(r"^  (\w+):", words, re.M)) - {"viewerTexts"}
    others = "".join(path.read_text(encoding="utf-8") for path in PAGE.glob("*.js") if path.name != "text.js")
    markup = with_export_menu((PAGE / "index.html").read_text(encoding="utf-8"))
    named = set(re.findall(r'data-(?:text|label)="(\w+)"', markup))
    named |= {each for formats in re.findall(r'data-formats="([^"]+)"', markup) for each in formats.split()}
    named |= set(re.findall(r'(?:\btext\.|\bsay\(")(?!js\b)(\w+)', others)) - {"viewerTexts"}
    # The viewer is handed its own words.
    assert named - {"contextLost", "reliefNeedsWebgl", "webglFailed"} <= known
    quoted = set(re.findall(r'"(\w+)"', others))  # chosen by a condition, or listed with their keys
    assert sorted(known - named - quoted) == []
