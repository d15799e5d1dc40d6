"""Network: backends, framing of the input, and upsampling of the output."""

__all__ = []
