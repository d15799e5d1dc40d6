"""Version: of the installed package; looking it up takes as long as the rest of ``--help``."""

from importlib.metadata import version

__all__ = ["__version__"]

__version__ = version("normalgan")
