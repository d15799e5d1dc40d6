"""Version of the installed package, in its own module because looking it up is slow."""

from importlib.metadata import version

__all__ = ["__version__"]

__version__ = version("normalgan")
