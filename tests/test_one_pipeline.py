"""One way from a drawing to its map: whichever door asks, the same network paints the same bytes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from studio_client import b64, serving

import normalgan
from normalgan.__main__ import main
from normalgan.cli.training.normal_map_writer import NormalMapWriter
from normalgan.data.settings import Prediction
from normalgan.inference.network.torch_backend import TorchBackend
from normalgan.inference.outputs import Normal
from normalgan.inference.outputs.output_set import Outputs
from normalgan.inference.predictor import Predictor
from pens import blob, outline
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET)

HINTS = [{"x": 100, "y": 70, "normal": [-0.6, 0.0, 0.8]}, {"x": 170, "y": 120, "normal": [0.0, 0.6, 0.8]}]


@pytest.fixture
def drawings(tmp_path: Path) -> Path:
    """A drawing in pen, a coloured one with opacity, one in thick lines; hints for one, a mask for one."""
    (tmp_path / "in").mkdir()
    filled = blob()
    grey = np.rint(255 * (1 - outline(filled))).astype(np.uint8)
    Image.fromarray(grey).save(tmp_path / "in" / "pen.png")
    thick = np.rint(200 * (1 - outline(filled, 9))).astype(np.uint8) + 30
    Image.fromarray(thick).save(tmp_path / "in" / "thick.png")
    colour = np.dstack([grey // 2, grey, grey // 3, np.where(filled > 0.5, 255, 0)]).astype(np.uint8)
    Image.fromarray(colour).save(tmp_path / "in" / "colour.png")
    (tmp_path / "pen_hints.json").write_text(json.dumps(HINTS))
    Image.fromarray(filled > 0.5).save(tmp_path / "thick_mask.png")
    return tmp_path / "in"


def given(drawing: Path) -> dict[str, Any]:
    """The hints and the mask of a drawing."""
    folder = drawing.parents[1]
    named = {"hints": folder / f"{drawing.stem}_hints.json", "mask": folder / f"{drawing.stem}_mask.png"}
    return {name: path if path.is_file() else None for name, path in named.items()}


def test_predict_and_python_paint_the_same_bytes_by_torch(drawings: Path, tmp_path: Path) -> None:
    model = gan()
    folder = str(tmp_path)
    module = data(drawings, tmp_path, prediction=Prediction(str(drawings), folder, folder), batch_size=3)
    run = trainer(tmp_path, callbacks=[NormalMapWriter(tmp_path / "out", Outputs(Normal(alpha=True)))])
    run.predict(model, module, return_predictions=False)
    predictor = Predictor(TorchBackend(model.generator, 32))
    for drawing in sorted(drawings.iterdir()):
        predictor(drawing, **given(drawing)).save(tmp_path / "python.png", alpha=True)
        written = (tmp_path / "out" / f"{drawing.stem}_normal.png").read_bytes()
        assert written == (tmp_path / "python.png").read_bytes(), drawing.stem


def test_generate_studio_and_python_paint_the_same_bytes_by_onnx(drawings: Path, tmp_path: Path) -> None:
    from normalgan.weights.shipped import SHIPPED

    out = tmp_path / "out"
    where = ("--hints", str(tmp_path), "--mask", str(tmp_path), "--bits", "16")
    assert main(["generate", str(drawings), "-o", str(out), *where]) == 0
    predictor = normalgan.load(SHIPPED)
    with serving(SHIPPED, tmp_path / "projects") as client:
        for drawing in sorted(drawings.iterdir()):
            files = given(drawing)
            predictor(drawing, **files).save(tmp_path / "python.png", bits=16)
            written = (out / f"{drawing.stem}_normal.png").read_bytes()
            assert (tmp_path / "python.png").read_bytes() == written, drawing.stem
            request = {
                **{"tab": "a", "number": 0, "format": "png16", "picture": b64(drawing.read_bytes())},
                "hints": [] if files["hints"] is None else HINTS,
                "mask": None if files["mask"] is None else b64(files["mask"].read_bytes()),
            }
            answer = client.post("/api/export", json=request)
            assert answer.status_code == 200, answer.text
            assert answer.content == written, drawing.stem
