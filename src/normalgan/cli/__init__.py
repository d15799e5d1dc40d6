"""The command line: the commands, how their settings are parsed, and what is said of mistakes in them."""

__all__ = []
