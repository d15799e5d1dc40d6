"""Commands that are killed while they write: each file is whole or not there, and no process is left."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
from PIL import Image

from onnx_models import write_model

DRAWINGS = 12


def draw(folder: Path) -> None:
    folder.mkdir()
    y, x = np.mgrid[:96, :96]
    for number in range(DRAWINGS):
        ring = np.abs(np.hypot(x - 48, y - 48) - 20 - number) < 1.5
        Image.fromarray(np.where(ring, 0, 255).astype(np.uint8)).save(folder / f"{number:02d}.png")


@pytest.mark.slow  # starts the command four times
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_generate_leaves_whole_files_and_no_process(tmp_path: Path, number: signal.Signals) -> None:
    model, out = write_model(tmp_path / "model.onnx"), tmp_path / "out"
    draw(tmp_path / "in")
    command = [sys.executable, "-m", "normalgan", "generate", str(tmp_path / "in"), "-o", str(out)]
    command += ["--model", str(model), "--height", "png"]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    while not [*out.glob("*_normal.png")]:
        assert process.poll() is None
        time.sleep(0.002)
    children = psutil.Process(process.pid).children()
    process.send_signal(number)
    assert process.wait(60) == -number
    assert psutil.wait_procs(children, 60)[1] == []
    for path in out.glob("[!.]*"):
        with Image.open(path) as image:
            image.load()
    subprocess.run([*command, "--skip-existing"], capture_output=True, env=environment, check=True)
    assert len([*out.glob("*_normal.png")]) == DRAWINGS
