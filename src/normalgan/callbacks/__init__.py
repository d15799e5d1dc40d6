"""Callbacks: checkpoints, learning-rate schedules, averaged weights, logged pictures, the test report."""

from normalgan.callbacks.learning_curve import LearningCurve
from normalgan.callbacks.pictures import PictureLogger
from normalgan.callbacks.rate_schedules import StableSchedule, WallClockSchedule
from normalgan.callbacks.report import TestReport
from normalgan.callbacks.start_from import StartFrom
from normalgan.callbacks.stopped import StoppedCheckpoint
from normalgan.callbacks.warm_average import WarmAverage

__all__ = [
    "LearningCurve",
    "PictureLogger",
    "StableSchedule",
    "StartFrom",
    "StoppedCheckpoint",
    "TestReport",
    "WallClockSchedule",
    "WarmAverage",
]
