"""fit in a loop in one process, as sweeps run it."""

import subprocess
import sys
from pathlib import Path

import pytest
from command import CONF

CODE = """
import gc, sys
from pathlib import Path
import psutil
from command import run
config, meshes, folder = sys.argv[1:]
for number in range(5):
    given = ("--config", config, "--data.meshes", meshes, "--data.cache", Path(folder) / "cache")
    done = run("fit", *given, "--trainer.default_root_dir", Path(folder) / str(number))
    assert done.code == 0, done.err
    gc.collect()
    print(psutil.Process().memory_info().rss)
"""


@pytest.mark.timeout(900)  # five runs, where other tests run too
@pytest.mark.slow
def test_memory_stays_flat_over_five_runs(meshes: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(CONF / "tiny.yaml"), str(meshes), str(tmp_path)],
        cwd=CONF.parent / "cli",
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    used = [int(line) / 2**20 for line in done.stdout.splitlines()]
    assert len(used) == 5
    assert used[-1] - used[1] < 30, used  # MB; the first run imports, and fills pools that stay
