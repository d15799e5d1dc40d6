"""Decoders: the code of the child process, from the bytes of a file to pixels.

The package does not import `normalgan`, so that the child starts several times faster. The imports
are relative because the child knows it as `decoders`.
"""

__all__ = []
