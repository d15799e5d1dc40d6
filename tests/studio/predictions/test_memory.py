"""Test memory that is kept from one map to the next."""

import os
import platform
import subprocess
import sys

import pytest

MAPS = """
import resource, sys, threading
import numpy as np
from normalgan.studio.predictions.memory import keep_memory

if sys.argv[1] == "kept":
    assert keep_memory()

def work():
    parts = [np.ones(2**22, np.float32) for _ in range(4)]
    return sum(float(part[0]) for part in parts)

def taken():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(8):
        work()
    print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)

for _ in range(2):  # the second thread gets the memory of the first
    thread = threading.Thread(target=taken)
    thread.start()
    thread.join()
"""


def pages(how: str) -> int:
    """Return how many pages of memory a thread gets from the system for the work of eight maps."""
    # NumPy asks for huge pages, each of which counts once for hundreds.
    command = [sys.executable, "-c", MAPS, how]
    ran = subprocess.run(
        command, capture_output=True, text=True, check=True, env={**os.environ, "NUMPY_MADVISE_HUGEPAGE": "0"}
    )
    return int(ran.stdout.split()[-1])


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="it is a setting of glibc")
def test_memory_of_one_map_is_kept_for_the_next() -> None:
    assert pages("kept") < 500 < pages("usual")
