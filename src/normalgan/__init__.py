"""normalgan: from a line sketch to a surface normal map.

Importing this package imports nothing heavy: ask for the part you need, such as
``normalgan.normals`` (numpy only), ``normalgan.rendering`` (no torch) or ``normalgan.gan``.
"""

from importlib.metadata import version

__version__ = version("normalgan")
