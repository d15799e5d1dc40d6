"""An output of another package: everything that lists outputs finds it."""

import re
import zipfile
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from studio_client import asking, serving

from normalgan.__main__ import main
from normalgan.inference.outputs import OUTPUTS
from normalgan.inference.outputs.base import Scaled
from normalgan.normals import encode_grey
from pens import blob, outline
from plugin_packages import install

EXAMPLE = Path(__file__).parents[3] / "examples" / "plugins" / "output.py"
TWO_FILES = '''
from dataclasses import dataclass
from normalgan.inference.outputs import Output
@dataclass(frozen=True)
class Words(Output):
    """Words about the map."""
    name = "words"
    label = "Words & more"
    @property
    def endings(self):
        return ("_words.txt", "_more.txt")
    def encode(self, preds):
        return dict.fromkeys(self.endings, b"a ball")
'''


@pytest.fixture(name="foreign")
def offer_outputs(site: Path) -> None:
    """Install two outputs of another package."""
    install(
        site,
        "foreign",
        {"slopes": EXAMPLE.read_text(encoding="utf-8"), "words_about": TWO_FILES},
        {"normalgan.outputs": {"Slope": "slopes:Slope", "Words": "words_about:Words"}},
    )


def test_generate_has_an_option_for_the_output_of_a_package(
    here: Path, foreign: None, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(np.rint(255 * (1 - outline(blob(radius=60)))).astype(np.uint8)).save("fox.png")
    model = ["--model", "model.onnx"]
    for steepest in ("90", "30"):
        asked = ["--slope", "--steepest", steepest, "--words", "-o", steepest]
        assert main(["generate", "fox.png", *model, *asked]) == 0
        left = sorted(path.name for path in Path(steepest).iterdir())
        assert left == ["fox_more.txt", "fox_normal.png", "fox_slope.png", "fox_words.txt"]
    gentle, steep = (cv2.imread(f"{each}/fox_slope.png", cv2.IMREAD_UNCHANGED) for each in ("90", "30"))
    assert gentle is not None
    assert steep is not None
    assert steep.astype(int).sum() > gentle.astype(int).sum() > 0
    # What is called so beside a drawing is none.
    capsys.readouterr()
    Path("90/fox.png").write_bytes(Path("fox.png").read_bytes())
    assert main(["generate", "90", *model, "-o", "again", "--dry-run"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1
    assert main(["generate", "fox.png", *model, "--steepest", "30"]) == 2
    assert "--steepest is a setting of the slope; add --slope, or leave it out." in capsys.readouterr().err
    assert main(["generate", "fox.png", *model, "--slope", "-o", "-"]) == 2


def test_the_studio_offers_and_exports_the_output_of_a_package(
    model: Path, tmp_path: Path, foreign: None
) -> None:
    OUTPUTS.load_entry_points()
    with serving(model, tmp_path) as client:
        page = client.get("/").text
        offered = dict(re.findall(r'<option value="(\w+)"[^>]*>([^<]*)</option>', page))
        assert offered["slope"] == "Slope"
        assert offered["words"] == "Words &amp; more"
        answer = client.post("/api/export", json=asking(name="fox", what="slope"))
        assert answer.headers["content-disposition"].endswith("fox_slope.png")
        assert np.asarray(Image.open(BytesIO(answer.content))).max() > 0
        answer = client.post("/api/export", json=asking(name="fox", number=2, what="words"))
    assert answer.headers["content-disposition"].endswith("fox_words.zip")
    with zipfile.ZipFile(BytesIO(answer.content)) as archive:
        assert archive.namelist() == ["fox_words.txt", "fox_more.txt"]


def test_an_option_that_is_taken_is_told(site: Path, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = TWO_FILES.replace('name = "words"', 'name = "size"')
    install(site, "foreign", {"sizes": source}, {"normalgan.outputs": {"Words": "sizes:Words"}})
    assert main(["generate", "fox.png", "--model", "model.onnx"]) == 2
    assert "the output Words has an option --size, and so has the command" in capsys.readouterr().err


def test_a_scale_is_changed_without_the_map() -> None:
    levels = np.linspace(0, 1, 64, dtype=np.float32).reshape(8, 8)
    own = Scaled(encode_grey(levels, ".png", 16), 5.0)
    assert own.at(5.0) == own
    half = cv2.imdecode(np.frombuffer(own.at(10.0), np.uint8), cv2.IMREAD_UNCHANGED)
    assert half is not None
    np.testing.assert_allclose(half / 65535, levels / 2, atol=1e-4)
