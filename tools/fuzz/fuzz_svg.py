"""Fuzz target: SVG, written anew without what leads out of it, and then drawn in a child as users' are."""

from pyexpat import ParserCreate

import harness

with harness.instrumented():
    from normalgan.decoding.worker import MOST_DEPTH, RefusedError, sanitize_svg
    from normalgan.errors import InputError
    from normalgan.inference.reading.drawings import read_drawing

MOST = 1024


def read(data: bytes) -> None:
    """Hold what is written anew to what is promised of it, and draw it.

    Raises:
        AssertionError: if it leads out of the file, is nested too deeply, or ends the child.
    """
    try:
        text = sanitize_svg(data, MOST)
    except (RefusedError, MemoryError):
        return
    look_at(text)
    assert sanitize_svg(text.encode(), MOST) == text
    try:
        read_drawing(harness.as_file(data, "drawing.svg"))
    except InputError as error:
        if "crashed" in str(error):
            raise AssertionError from error


def look_at(text: str) -> None:
    """Raise `AssertionError` if an SVG refers to a file, or is nested too deeply."""
    depth = 0

    def start(_: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        assert depth <= MOST_DEPTH
        for key, value in attributes.items():
            if key.rpartition(":")[2] == "href":
                assert value.strip().lower().startswith(("#", "data:image/")), value[:80]

    def end(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser = ParserCreate()
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.Parse(text.encode(), True)


if __name__ == "__main__":
    harness.run(read)
