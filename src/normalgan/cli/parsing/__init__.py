"""Parsing shared by all commands: settings, configuration files, common options and error messages."""

__all__ = []
