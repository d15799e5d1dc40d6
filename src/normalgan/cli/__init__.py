"""The command line: commands, parsing of settings, and error messages."""

__all__ = []
