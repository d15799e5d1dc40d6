"""Version of the installed package, in its own module because looking it up is slow."""

from importlib.metadata import version

__version__ = version("normalgan")
