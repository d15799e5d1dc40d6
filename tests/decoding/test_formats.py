import re
from pathlib import Path

from normalgan.decoding.decoders.formats import ENDINGS, FORMATS, detect_format
from normalgan.inference.reading.drawings import SUFFIXES
from normalgan.studio.drawings.limits import with_limits
from normalgan.studio.page_files import PAGE

ROOT = Path(__file__).parents[2]


def test_a_format_is_told_by_its_first_bytes() -> None:
    for each in FORMATS:
        for start in each.starts:
            found = detect_format(start.ljust(64, b"\0"))
            assert found is not None
            assert found.starts == each.starts
    box = b"\0\0\0\x1cftyp%b\0\0\0\0mif1miaf%b"
    for brand, name in ((b"avif", "AVIF"), (b"heic", "HEIC"), (b"mp42", None)):
        found = detect_format(box.replace(b"mif1miaf", b"isomiso2") % (brand, brand))
        assert (found.name if found else None) == name
    assert detect_format(b"") is None


def test_endings_are_written_once() -> None:
    assert SUFFIXES == ENDINGS
    assert len(set(ENDINGS)) == len(ENDINGS)


def test_the_docs_name_every_format() -> None:
    words = set(re.findall(r"\w+", (ROOT / "docs/generate.md").read_text(encoding="utf-8")))
    for each in FORMATS:
        assert {ending[1:].upper() for ending in each.endings} & {word.upper() for word in words}


def test_dialogs_offer_every_format_that_is_read() -> None:
    page = with_limits((PAGE / "index.html").read_text(encoding="utf-8"))
    accepted = re.search(r'id="import-file" type="file" accept="image/\*,([^"]*)"', page)
    assert accepted is not None
    assert accepted[1].split(",") == list(ENDINGS)
    add_on = (ROOT / "integrations/blender/normalgan_blender/__init__.py").read_text(encoding="utf-8")
    shown = re.search(r'default=("\*\.png;[^,]*)', add_on)
    assert shown is not None
    endings = re.sub(r'"\s*"|^"|"$', "", shown[1]).split(";")
    assert {each.lstrip("*") for each in endings} == set(ENDINGS)
