"""Stopwatch: a profiler for Lightning's trainer that notes when training waits for data."""

import json
import time
from pathlib import Path

from lightning.pytorch.profilers import Profiler

_FETCH = "[_TrainingEpochLoop].train_dataloader_next"


class Stopwatch(Profiler):
    """Notes when each training batch was asked for and when it came.

    Args:
        path: JSON file that it is written to when training ends: ``{"asked": […], "came": […]}`` in seconds.
    """

    def __init__(self, path: str) -> None:
        super().__init__()
        self.path = Path(path)
        self.asked: list[float] = []
        self.came: list[float] = []

    def start(self, action_name: str) -> None:
        """Note that a batch is asked for; other actions do not matter."""
        if action_name == _FETCH:
            self.asked.append(time.perf_counter())

    def stop(self, action_name: str) -> None:
        """Note that it came."""
        if action_name == _FETCH:
            self.came.append(time.perf_counter())

    def teardown(self, stage: str | None) -> None:
        """Write the times down."""
        if stage == "fit":
            self.path.write_text(json.dumps({"asked": self.asked, "came": self.came}))
        super().teardown(stage)
