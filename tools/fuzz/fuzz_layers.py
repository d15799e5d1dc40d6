"""Fuzz target: layered files, PSD, KRA, ORA and Aseprite: what they show, their frames, their layers."""

import harness

with harness.instrumented("psd_tools", "layered_files"):
    import io
    import sys
    from contextlib import suppress
    from pathlib import Path

    import psd_tools  # noqa: F401

    from normalgan.decoding import worker

    # The child process finds it by this name, as it does not have the package on its path.
    sys.path.append(str(Path(worker.__file__).parent))
    __import__("layered_files")

LEAST, MOST = 8, 256


def read(data: bytes) -> None:
    """Decode a layered file in each of the three ways; what is sent is what the parent is told of."""
    if data[:4] not in {b"8BPS", b"PK\x03\x04"} and data[4:6] != b"\xe0\xa5":
        return
    with suppress(worker.RefusedError, MemoryError):
        image, full = worker.decode(data, LEAST, MOST, 64, 0, False)
        assert image.mode in worker.MODES
        assert image.size == full
    if data[4:6] == b"\xe0\xa5":
        with suppress(worker.RefusedError, MemoryError):
            worker.send_frames(data, LEAST, MOST, harness.SECONDS, io.BytesIO())
    sent = io.BytesIO()
    try:
        worker.send_layers(data, LEAST, MOST, harness.SECONDS, sent)
    except (worker.RefusedError, MemoryError):
        assert not sent.getvalue()  # a refusal in the midst of pixels would be taken for pixels
        return
    look_at(sent.getvalue())


def look_at(sent: bytes) -> None:
    """Raise `AssertionError` if layers that are sent lie beside the picture, or are not whole."""
    kind, width, height, frames, _, count = worker.REPLY.unpack_from(sent)
    assert kind == worker.PARTS
    at = worker.REPLY.size + frames * worker.DURATION.size
    for _ in range(count):
        kind, w, h, _, _, size = worker.REPLY.unpack_from(sent, at)
        assert kind == worker.MODES.index("RGBA")
        assert size == 4 * w * h
        at += worker.REPLY.size + size
        left, top, _, frame, _, length = worker.LAYER.unpack_from(sent, at)
        at += worker.LAYER.size + length
        assert 0 <= left <= width - w
        assert 0 <= top <= height - h
        assert frame < frames
    assert at == len(sent)


if __name__ == "__main__":
    harness.run(read)
