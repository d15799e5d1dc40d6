"""The end of a run says what a machine lacks, what was not tested for that, and how to get it."""

import os
import subprocess
import sys
from pathlib import Path

from needs import CHROMIUM, NEEDS, NPM, not_tested

TESTS = Path(__file__).parent


def test_each_thing_that_is_missing_has_a_line_with_the_number_of_tests() -> None:
    reasons = [NPM.reason("it is not installed"), CHROMIUM.reason("there is none at x"), "root may write"]
    reasons.append(f"Skipped: {NPM.reason('its registry cannot be reached')}")
    first, second = not_tested(reasons)
    assert first.startswith("not tested, as Chromium is missing: pages in a browser (1 test); apt-get")
    assert second.startswith("not tested, as npm is missing: the JavaScript example (2 tests); apt-get")
    assert not_tested(["root may write"]) == []
    assert len({need.name for need in NEEDS}) == len(NEEDS)


def test_a_run_without_chromium_ends_with_its_line() -> None:
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:cacheprovider",
            "-p",
            "pytest_timeout",
            TESTS / "studio" / "test_viewer_relief.py",
        ],
        env={
            **os.environ,
            "NORMALGAN_CHROMIUM": "/no/such/chromium",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # they take long to import
        },
        cwd=TESTS.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("not tested")]
    assert line.startswith("not tested, as Chromium is missing: pages in a browser (")
    assert "install chromium" in line
