"""The JavaScript example paints in Chromium what ONNX Runtime paints in Python."""

import base64
import io
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import onnxruntime
import pytest
from onnx import TensorProto, helper, numpy_helper, save
from PIL import Image

from chromium import page as open_page
from needs import NPM
from web_folder import serve

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]  # downloads a package of npm

EXAMPLES = Path(__file__).parents[1] / "examples"
UNREACHABLE = ("ENOTFOUND", "EAI_AGAIN", "ECONNREFUSED", "ENETUNREACH", "ETIMEDOUT")
SIZE = 256


def write_network(path: Path) -> None:
    """Write a small random network: convolutions over ink and hints, in the shape that `export` gives."""
    rng = np.random.default_rng(4)
    shapes = {"first": (8, 5, 5, 5), "second": (3, 8, 3, 3)}
    weights = [
        numpy_helper.from_array((rng.normal(size=shape) / 4).astype(np.float32), name)
        for name, shape in shapes.items()
    ]
    nodes = [
        helper.make_node("Concat", ["sketch", "hints"], ["all"], axis=1),
        helper.make_node("Conv", ["all", "first"], ["drawn"], pads=[2] * 4),
        helper.make_node("LeakyRelu", ["drawn"], ["bent"], alpha=0.2),
        helper.make_node("Conv", ["bent", "second"], ["mixed"], pads=[1] * 4),
        helper.make_node("Tanh", ["mixed"], ["normal"]),
    ]
    sketch, hints, normal = (
        helper.make_tensor_value_info(name, TensorProto.FLOAT, ["N", channels, SIZE, SIZE])
        for name, channels in (("sketch", 1), ("hints", 4), ("normal", 3))
    )
    graph = helper.make_graph(nodes, "random", [sketch, hints], [normal], weights)
    save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8), path)


@pytest.fixture(scope="module")
def site(opened: "Browser", tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the examples as a reader has them after `npm ci`, with a model; none without Chromium."""
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip(NPM.reason("it is not installed"))
    folder = tmp_path_factory.mktemp("site")
    shutil.copytree(EXAMPLES / "sketches", folder / "sketches")
    web = folder / "onnx_web"
    shutil.copytree(EXAMPLES / "onnx_web", web, ignore=shutil.ignore_patterns("node_modules", "model.onnx"))
    command = [npm, "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--fetch-retries=1"]
    done = subprocess.run(command, cwd=web, capture_output=True, text=True, check=False)
    if any(word in done.stderr for word in UNREACHABLE):
        pytest.skip(NPM.reason("its registry cannot be reached"))
    assert done.returncode == 0, done.stderr[-2000:]
    write_network(web / "model.onnx")
    return folder


def status(page: "Page") -> str:
    page.wait_for_function("!document.querySelector('output').value.startsWith('Loading')")
    return str(page.evaluate("document.querySelector('output').value"))


FETCHED = """async () => {
    const { loadModel, readSketch, predict } = await import("./predict.js");
    const session = await loadModel("model.onnx");
    const sketch = await readSketch("../sketches/fox.png", session.size);
    const canvas = document.querySelectorAll("canvas")[1];
    const asAddress = (numbers) => new Promise((done) => {
        const reader = new FileReader();
        reader.onload = () => done(reader.result);
        reader.readAsDataURL(new Blob([numbers]));
    });
    return %s;
}"""


def fetched(page: "Page", expression: str) -> bytes:
    """Return the content of a data URL: Playwright takes seconds for lists of numbers."""
    return base64.b64decode(page.evaluate(FETCHED % expression).partition(",")[2])


def test_the_browser_paints_what_python_paints(site: Path, opened: "Browser") -> None:
    with serve(site) as address, open_page(opened) as page:
        page.goto(f"{address}/onnx_web/")
        assert status(page).startswith("Painted in ")
        shown = np.asarray(Image.open(io.BytesIO(fetched(page, "canvas.toDataURL()"))))
        sketch, normals = (
            np.frombuffer(fetched(page, f"await asAddress({name})"), np.float32)
            for name in ("sketch", "await predict(session, sketch)")
        )
    paper = np.asarray(Image.open(site / "sketches" / "fox.png").convert("L"), np.float32)
    wanted_sketch = 1 - paper / 255
    np.testing.assert_allclose(np.reshape(sketch, (SIZE, SIZE)), wanted_sketch, atol=1e-3)
    hints = np.zeros((1, 4, SIZE, SIZE), np.float32)
    hints[0, :, SIZE // 2, SIZE // 2] = 0, 0, 1, 1
    session = onnxruntime.InferenceSession(
        site / "onnx_web" / "model.onnx", providers=["CPUExecutionProvider"]
    )
    [wanted] = session.run(["normal"], {"sketch": wanted_sketch[None, None], "hints": hints})
    np.testing.assert_allclose(np.reshape(normals, wanted.shape), wanted, atol=1e-3)

    length = np.linalg.norm(wanted[0], axis=0)
    assert 0.05 < (length > 0.5).mean() < 0.95  # both kinds of pixels are there to compare
    unit = np.where(length > 0.5, wanted[0] / np.maximum(length, 1e-6), np.array([0, 0, 1])[:, None, None])
    colours = ((unit + 1) / 2 * 255).transpose(1, 2, 0)
    difference = np.abs(shown[..., :3] - colours)[np.abs(length - 0.5) > 1e-3]
    assert difference.max() <= 1


def test_what_is_missing_is_said_on_the_page(site: Path, opened: "Browser") -> None:
    tolerated = ("status of 404",)
    with serve(site) as address, open_page(opened, tolerate=tolerated) as page:
        page.goto(f"{address}/onnx_web/?model=none.onnx")
        assert status(page) == "There is no model at none.onnx."
        page.goto(f"{address}/onnx_web/?drawing=none.png")
        assert status(page) == "This is no picture that the browser can read."
