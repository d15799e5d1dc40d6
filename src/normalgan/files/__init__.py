"""Files: atomic writing, reading within limits, checks before loading."""

from normalgan.files.writing import write_bytes

__all__ = ["write_bytes"]
