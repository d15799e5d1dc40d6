"""How all commands parse: settings, configuration files, options that several share, and error messages."""

__all__ = []
