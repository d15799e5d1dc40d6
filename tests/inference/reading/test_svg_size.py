"""SVG size: what the first element says, in CSS pixels."""

import pytest

from normalgan.inference.reading.svg_size import svg_size


@pytest.mark.parametrize(
    ("content", "size"),
    [
        (b'<svg width="200" height="100" viewBox="0 0 20 10"/>', (200, 100)),
        (b'\xef\xbb\xbf<?xml version="1.0"?>\n<svg width="25.4mm" height="1e1px"><path/>', (96, 10)),
        (b'<svg width="100%" height="100%" viewBox="0,0, 20 10">', (20, 10)),
        ('<?xml version="1.0" encoding="utf-16"?><svg width="3" height="4"/>'.encode("utf-16"), (3, 4)),
        (b"<svg/>", None),
        (b'<svg width="0" height="1"/>', None),
        (b"not XML", None),
        (b'<!DOCTYPE svg [<!ENTITY a "1">]><svg width="&a;" height="1"/>', None),
    ],
)
def test_the_size_is_that_of_the_first_element(content: bytes, size: tuple[float, float] | None) -> None:
    assert svg_size(content) == (None if size is None else pytest.approx(size))
