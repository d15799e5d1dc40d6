from pathlib import Path

import cv2
import numpy as np
import pytest
import torch
from PIL import Image, ImageDraw
from torch import Tensor

from normal_pngs import read_png
from normalgan.cli.training.normal_map_writer import NormalMapWriter
from normalgan.data.settings import Prediction
from normalgan.errors import InputError, RunError
from normalgan.gan import NormalGAN
from normalgan.inference.outputs import Height, ModelInput, Normal
from normalgan.inference.outputs.output_set import Outputs
from normalgan.models import UNetGenerator
from normalgan.normals import Bits, encode
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET)

TILTED = torch.tensor([0.6, 0.0, 0.8])


class Half(UNetGenerator):
    """Paints the upper half tilted and the lower half empty, at a length that is not one; pastes hints."""

    def forward(self, condition: Tensor) -> Tensor:
        predicted = condition.new_zeros(len(condition), 3, *condition.shape[2:])
        predicted[:, :, : condition.shape[2] // 2] = 0.7 * TILTED.view(3, 1, 1)
        where = condition[:, 3:] > 0.5
        return torch.where(where, condition[:, :3], predicted + 0.1 * TILTED.view(3, 1, 1))


class Failing(Half):
    """Fails at the third drawing."""

    calls = 0

    def forward(self, condition: Tensor) -> Tensor:
        self.calls += 1
        if self.calls > 2:
            raise MemoryError
        return super().forward(condition)


def draw(folder: Path, **sizes: tuple[int, int]) -> Path:
    """Draw a rectangle a little inside the sheet for each (width, height)."""
    folder.mkdir()
    for name, (width, height) in sizes.items():
        image = Image.new("L", (width, height), 255)
        ImageDraw.Draw(image).rectangle((6, 6, width - 7, height - 7), outline=0, width=2)
        image.save(folder / f"{name}.png")
    return folder


def predict(
    sketches: Path,
    out: Path,
    bits: Bits = 8,
    model: NormalGAN | None = None,
    batch_size: int = 2,
    mask: str = "model",
    hints: str | None = None,
) -> list[str]:
    run = trainer(out.parent, callbacks=[NormalMapWriter(out, Outputs(Normal(bits=bits)))])
    asked = Prediction(str(sketches), hints, mask)
    module = data(sketches, sketches, prediction=asked, batch_size=batch_size)
    run.predict(model or gan(generator=Half(size=32, width=4)), module, return_predictions=False)
    return sorted(path.name for path in out.iterdir())


def test_maps_have_the_size_of_their_drawings_and_are_flat_off_the_object(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawings = draw(tmp_path / "in", square=(100, 100), wide=(120, 60), tall=(40, 90))
    out = tmp_path / "deep" / "out"
    assert predict(drawings, out, 16) == [f"{n}_normal.png" for n in ("square", "tall", "wide")]
    assert str(out) in capsys.readouterr().out
    tilted, flat = encode(TILTED.numpy(), 16), encode(np.array([0.0, 0, 1]), 16)
    for name, (width, height) in {"square": (100, 100), "wide": (120, 60), "tall": (40, 90)}.items():
        raw = cv2.imread(str(out / f"{name}_normal.png"), cv2.IMREAD_UNCHANGED)
        assert raw is not None
        assert raw.dtype == np.uint16
        assert raw.shape == (height, width, 3)
        upper, lower = raw[height // 4, width // 2, ::-1], raw[3 * height // 4, width // 2, ::-1]
        np.testing.assert_allclose(upper.astype(int), tilted.astype(int), atol=1)
        assert lower.tolist() == flat.tolist()
        inside = raw[height // 4 : 3 * height // 4, width // 2, 2] == flat[0]
        edge = height // 4 + int(inside.argmax())
        assert abs(edge - height / 2) <= max(width, height) / 32  # a pixel of the model


def test_hints_of_the_user_are_respected(tmp_path: Path) -> None:
    drawings = draw(tmp_path / "in", a=(100, 100), b=(100, 100))
    (tmp_path / "hints").mkdir()
    given = np.zeros((100, 100, 4), np.uint8)
    given[60:90, 40:70] = (*encode(np.array([-0.6, 0.8, 0.0])), 255)
    Image.fromarray(given).save(tmp_path / "hints" / "a_hints.png")
    predict(drawings, tmp_path / "out", hints=str(tmp_path / "hints"))
    hinted, _ = read_png(tmp_path / "out" / "a_normal.png")
    plain, _ = read_png(tmp_path / "out" / "b_normal.png")
    np.testing.assert_allclose(hinted[75, 55], [-0.6, 0.8, 0], atol=0.05)
    np.testing.assert_allclose(plain[75, 55], [0, 0, 1], atol=0.01)
    np.testing.assert_allclose(hinted[25, 50], plain[25, 50], atol=0.01)


def test_a_failure_leaves_only_whole_maps(tmp_path: Path) -> None:
    drawings = draw(tmp_path / "in", a=(40, 40), b=(40, 40), c=(40, 40))
    model = gan(generator=Failing(size=32, width=4))
    with pytest.raises(MemoryError):
        predict(drawings, tmp_path / "out", model=model, batch_size=2)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a_normal.png", "b_normal.png"]
    assert read_png(tmp_path / "out" / "b_normal.png")[0].shape == (40, 40, 3)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="there is no folder that root cannot write to")
def test_an_unwritable_folder_is_reported_before_inference(tmp_path: Path) -> None:
    model = gan(generator=Failing(size=32, width=4))
    run = trainer(tmp_path, callbacks=[NormalMapWriter("/proc/self")])
    module = data(tmp_path, tmp_path, prediction=Prediction(str(draw(tmp_path / "in", a=(40, 40)))))
    with pytest.raises(InputError, match="the normal maps cannot be written to /proc/self: "):
        run.predict(model, module)
    assert model.generator.calls == 0


class Blind(Half):
    """Paints nothing where a hint says so; else as it does."""

    def forward(self, condition: Tensor) -> Tensor:
        return super().forward(condition) * (0 if (condition[:, 3] > 0.5).any() else 1)


def test_a_drawing_without_an_object_is_named_and_the_others_are_predicted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawings = draw(tmp_path / "in", a=(40, 40), b=(40, 40), c=(40, 40))
    (tmp_path / "hints").mkdir()
    (tmp_path / "hints" / "b_hints.json").write_text('[{"x": 20, "y": 20, "normal": [0, 0, 1]}]')
    model = gan(generator=Blind(size=32, width=4))
    with pytest.raises(RunError, match=r"^1 of 3 sketches could not be used\.$"):
        predict(drawings, tmp_path / "out", model=model, hints=str(tmp_path / "hints"))
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a_normal.png", "c_normal.png"]
    assert f"normalgan: {drawings / 'b.png'}: the model sees no object in it" in capsys.readouterr().err


def test_a_drawing_is_not_written_over(tmp_path: Path) -> None:
    drawings = draw(tmp_path / "in", a=(40, 40))
    run = trainer(tmp_path, callbacks=[NormalMapWriter(drawings, Outputs(Normal(suffix="")))])
    module = data(drawings, drawings, prediction=Prediction(str(drawings)))
    with pytest.raises(InputError, match=r"a\.png is an input and would be overwritten"):
        run.predict(gan(), module)


def test_predict_writes_the_outputs_of_generate(tmp_path: Path) -> None:
    drawings = draw(tmp_path / "in", a=(40, 40))
    writer = NormalMapWriter(
        tmp_path / "out", Outputs(Normal("exr", y="down", suffix="_n"), (ModelInput(), Height("tiff")))
    )
    run = trainer(tmp_path, callbacks=[writer])
    module = data(drawings, drawings, prediction=Prediction(str(drawings), map_size=80))
    run.predict(gan(generator=Half(size=32, width=4)), module, return_predictions=False)
    left = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert left == ["a_height.tiff", "a_input.png", "a_n.exr"]
    height = cv2.imread(str(tmp_path / "out" / "a_height.tiff"), cv2.IMREAD_UNCHANGED)
    assert height is not None
    assert height.shape == (80, 80)
