"""Describes what a figure was measured on: the machine, the versions, the commit and the date."""

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from normalgan.commit import commit

ONE_THREAD = {
    **{f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMEXPR")},
    "OPENCV_FOR_THREADS_NUM": "1",
    "LP_NUM_THREADS": "0",  # Mesa's software driver
}
"""The environment that keeps a process to one core; it must be set before any import."""


def describe(*packages: str) -> dict[str, object]:
    """Return the machine, the versions of Python and these packages, the commit and the date."""
    cpus = [
        line.partition(":")[2].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    return {
        "cpu": cpus[0] if cpus else platform.processor(),
        "cores": os.cpu_count(),
        "load_before": round(os.getloadavg()[0], 2),
        "platform": platform.platform(),
        "python": platform.python_version(),
        "versions": {name: version(name) for name in packages},
        "commit": commit(),
        "date": datetime.now(UTC).date().isoformat(),
    }
