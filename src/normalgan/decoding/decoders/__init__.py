"""Decoders: the code of the child process, which converts the bytes of a file to pixels.

This package does not import `normalgan`, so that the child starts several times faster. Its imports are
relative because the child imports it as `decoders`.
"""

__all__ = []
