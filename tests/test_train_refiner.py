"""The tool that trains the refiner that ships, in small: from rendered samples to a refiner that paints."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
import zarr

from normalgan import Predictor, load
from normalgan.inference.network.upsampling import Refiner
from pens import blob, outline

TOOL = runpy.run_path(str(Path(__file__).parents[1] / "tools" / "train_refiner.py"))
SIDE, RADIUS = 640, 256


def write_samples(folder: Path) -> None:
    """Write discs with the normals of balls, as `normalgan render` writes samples."""
    group = zarr.open_group(folder / "samples.zarr", mode="w")
    filled = blob((SIDE, SIDE), (SIDE // 2, SIDE // 2), RADIUS)
    y, x = (np.mgrid[:SIDE, :SIDE] + 0.5 - SIDE / 2) / RADIUS
    truth = np.stack([x, -y, np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))], -1) * (filled > 0.5)[..., None]
    for split in ("train", "val"):
        for name, value in (
            ("sketch", np.rint(255 * outline(filled, 5.0)).astype(np.uint8)),
            ("normal", truth.astype(np.float16)),
            ("mask", filled > 0.5),
        ):
            group.create_array(f"{split}/{name}", data=np.repeat(value[None], 2, 0))


@pytest.mark.timeout(900)  # a tool of minutes
@pytest.mark.slow
def test_from_samples_to_a_refiner(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_samples(tmp_path / "samples")
    sets, out = tmp_path / "sets", tmp_path / "refiner.onnx"
    TOOL["main"](["paint", str(tmp_path / "samples"), str(sets), "--splits", "train", "val"])
    assert len(list(sets.glob("*/*.npz"))) == 4
    # What was painted is kept.
    before = {path: path.stat().st_mtime_ns for path in sets.glob("*/*.npz")}
    TOOL["main"](["paint", str(tmp_path / "samples"), str(sets), "--splits", "train", "val"])
    assert before == {path: path.stat().st_mtime_ns for path in sets.glob("*/*.npz")}
    TOOL["main"](["train", str(sets), str(out), "--minutes", "0.3", "--width", "8", "--blocks", "1"])
    figures = json.loads(out.with_suffix(".json").read_text())
    assert figures["steps"] > 10
    assert figures["mended"][0] < figures["enlarged"][0]
    sketch = 1 - outline(blob((SIDE, SIDE), (300, 300), 200), 5.0)
    predictor = Predictor(load().backend, Refiner(out))
    assert predictor(sketch).normal.shape == (SIDE, SIDE, 3)
