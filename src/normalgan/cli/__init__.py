"""The command line: the commands, the parsing of their settings, and the error messages."""

__all__ = []
