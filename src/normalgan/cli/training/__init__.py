"""The training commands: fit, validate, test, predict and render."""

__all__ = []
