"""Files of any kind: written whole or not at all, read within limits, looked at before they are loaded."""

from normalgan.files.writing import write_bytes

__all__ = ["write_bytes"]
