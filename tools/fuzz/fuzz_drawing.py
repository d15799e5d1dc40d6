"""Fuzz target: drawings, decoded in this process and not in a child, so that branches of Pillow are seen."""

import harness

with harness.instrumented("PIL"):
    import PIL.BmpImagePlugin
    import PIL.GifImagePlugin
    import PIL.JpegImagePlugin
    import PIL.PngImagePlugin
    import PIL.TiffImagePlugin
    import PIL.WebPImagePlugin  # noqa: F401

    from normalgan.decoding.worker import MODES, RefusedError, decode, is_svg

LEAST, MOST = 8, 1024


def read(data: bytes) -> None:
    """Decode; an SVG has a target of its own."""
    if is_svg(data):
        return
    try:
        image, full = decode(data, LEAST, MOST, 64, 256, grey=bool(len(data) % 2))
    except (RefusedError, MemoryError):
        return
    assert image.mode in MODES
    assert all(LEAST <= side <= MOST for side in full)
    assert max(image.size) <= 256


if __name__ == "__main__":
    harness.run(read)
