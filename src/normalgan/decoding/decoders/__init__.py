"""Decoders: the code of the child process, from the bytes of a file to pixels.

The package imports nothing of `normalgan`, so that the child starts in a fraction of the time. The imports
are relative because the child knows it as `decoders`.
"""

__all__ = []
