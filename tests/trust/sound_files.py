"""Sound files of every kind that is read."""

import io
import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import trimesh
from attacked_meshes import rigged
from hostile import gltf
from PIL import Image

CONFIGURATION = Path(__file__).parents[1] / "conf" / "resume.yaml"

PLAN = """\
name: small
images: 100
seeds: [0, 1]
hints: 15
hint_counts: [0, 5, 50]
data: {data.size: 64, data.animals.count: 3}
rows:
  - {name: mean, label: mean normal, classical: mean}
  - {name: ours, label: ours, group: ours, configs: [configs/ours.yaml], settings: {model.n_critic: 1}}
reference: ours
"""


def sound() -> dict[str, dict[str, bytes]]:
    """Return the files by reader (see `readers.py`) and name."""
    ball = trimesh.creation.icosphere(1)
    meshes = {}
    for suffix in ("off", "obj", "ply", "stl", "glb"):
        content = ball.export(file_type=suffix)
        meshes[f"ball.{suffix}"] = content.encode() if isinstance(content, str) else content
    meshes["ascii.ply"] = ball.export(file_type="ply", encoding="ascii")
    meshes["ascii.stl"] = ball.export(file_type="stl_ascii").encode()
    meshes["beside.gltf"] = gltf().encode()
    grey = np.full((24, 24), 255, np.uint8)
    grey[6:18, 12] = 0
    drawings = {
        f"line.{kind}": _picture(grey, kind) for kind in ("png", "jpeg", "gif", "webp", "bmp", "tiff")
    }
    shape = b'<path d="M2 2L30 30" stroke="#000"/>'
    drawings["line.svg"] = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32">' + shape + b"</svg>"
    predicted = np.zeros((32, 32, 4), np.uint8)
    predicted[8, 8] = (128, 128, 255, 255)
    listed = json.dumps(
        [{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}, {"x": 1.5, "y": 0, "normal": [0, 0, 1]}]
    )
    turned = json.dumps({"ball": {"rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "inside_out": False}})
    return {
        "mesh": meshes,
        "rig": {"rig.gltf": rigged(lambda tree: None).encode()},
        "drawing": drawings,
        "hints": {"hints.png": _picture(predicted, "png"), "hints.json": listed.encode()},
        "configuration": {"resume.yaml": CONFIGURATION.read_bytes()},
        "orientation": {"turned.json": turned.encode()},
        "split": {"split.json": json.dumps({"train": ["a"], "val": ["b"], "test": ["c"]}).encode()},
        "plan": {"plan.yaml": PLAN.encode()},
        "model": {"ramp.onnx": _model()},
    }


def _model() -> bytes:
    from onnx_models import write_model  # its format's own library

    with TemporaryDirectory() as folder:
        return write_model(Path(folder) / "ramp.onnx", size=16).read_bytes()


def _picture(pixels: "np.ndarray[tuple[int, ...], np.dtype[np.uint8]]", kind: str) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, kind)
    return buffer.getvalue()
