import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.timeout(900)  # a tool of minutes
@pytest.mark.slow  # builds wheels, makes an environment, trains
def test_a_strangers_package_works_from_a_wheel() -> None:
    done = subprocess.run(
        ["bash", ROOT / "tools" / "check_example.sh", sys.executable],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "== all as it should be" in done.stdout


def test_an_environment_that_is_not_there_is_one_sentence() -> None:
    done = subprocess.run(
        ["bash", ROOT / "tools" / "check_example.sh", "no/such/python"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "there is no Python no/such/python\n"
