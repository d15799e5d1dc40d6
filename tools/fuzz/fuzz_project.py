"""Fuzz target: what the studio's page sends as JSON: a project to keep, a drawing with hints and areas."""

import harness
import numpy as np

with harness.instrumented():
    from normalgan.studio.documents import check_document
    from normalgan.studio.drawing import read_areas, take_drawing
    from normalgan.studio.fields import parse_fields

PICTURE = np.full((32, 32, 1), 255, np.uint8)


def read(data: bytes) -> None:
    """Look at a project, and at a request of the same bytes."""
    with harness.refusals():
        assert check_document(data)["width"] > 0
    with harness.refusals():
        drawing = take_drawing(parse_fields(data), PICTURE)
        drawing.digest()
        read_areas(drawing.areas)
        drawing.read_hints((32, 32))


if __name__ == "__main__":
    harness.run(read)
