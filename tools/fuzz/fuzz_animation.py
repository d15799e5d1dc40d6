"""Fuzz target: animations, GIF, WebP and PNG: whether they move, and their frames."""

import harness

with harness.instrumented("PIL"):
    import io
    from pathlib import Path

    import PIL.GifImagePlugin
    import PIL.PngImagePlugin
    import PIL.WebPImagePlugin  # noqa: F401

    from normalgan.decoding.worker import DURATION, MODES, PARTS, REPLY, RefusedError, send_frames
    from normalgan.inference.composites.animation import moving_kind

LEAST, MOST = 8, 256


def read(data: bytes) -> None:
    """Tell whether it moves, and decode its frames."""
    if not data.startswith((b"\x89PNG", b"GIF8", b"RIFF")):
        return
    with harness.refusals():
        moving_kind(Path("animation"), data)
    sent = io.BytesIO()
    try:
        send_frames(data, LEAST, MOST, harness.SECONDS, sent)
    except (RefusedError, MemoryError):
        return
    look_at(sent.getvalue())


def look_at(sent: bytes) -> None:
    """Raise `AssertionError` if frames that are sent are not whole."""
    kind, _, _, _, _, count = REPLY.unpack_from(sent)
    assert kind == PARTS
    at = REPLY.size
    for _ in range(count):
        kind, width, height, full_width, full_height, size = REPLY.unpack_from(sent, at)
        assert kind < len(MODES)
        assert LEAST <= min(width, height) <= max(width, height) <= MOST
        assert (width, height) == (full_width, full_height)
        at += REPLY.size + size + DURATION.size
    assert at == len(sent)


if __name__ == "__main__":
    harness.run(read)
