"""What happens beside training: pictures for the logger, the test report, the maps on disk."""

from normalgan.callbacks.pictures import PictureLogger
from normalgan.callbacks.report import TestReport
from normalgan.callbacks.writer import NormalMapWriter

__all__ = ["NormalMapWriter", "PictureLogger", "TestReport"]
