"""A drawing's file is decoded once in a job, whatever the job asks of it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from normalgan.__main__ import main
from normalgan.decoding import DecodedLayer
from normalgan.decoding.decoders.worker import needed
from normalgan.inference.composites.layers import encode_layers
from pens import blob, outline

SHAPE = (80, 120)


@pytest.fixture
def decoded(monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """The files that are decoded, each as often as it is: each time it is asked which libraries it needs."""
    found: list[bytes] = []

    def noted(content: bytes, *others: Any) -> str:
        found.append(content)
        return needed(content, *others)

    monkeypatch.setattr("normalgan.decoding.process.needed", noted)
    return found


def pen(x: int) -> Image.Image:
    return Image.fromarray(np.rint(255 * (1 - outline(blob(SHAPE, (x, 44), 20)))).astype(np.uint8))


def write_walk(name: str) -> None:
    pen(40).save(name, save_all=True, append_images=[pen(48), pen(56)], duration=100)


def write_layers(name: str) -> None:
    layers = []
    for number, x in enumerate((40, 80)):
        filled = blob(SHAPE, (x, 44), 20)
        shade = np.rint(255 * (1 - outline(filled)))
        pixels = np.dstack([shade, shade, shade, 255 * (filled > 0.5)]).astype(np.uint8)
        layers.append(DecodedLayer(f"part {number}", (), 255, 0, 0, number, 0, pixels))
    Path(name).write_bytes(encode_layers("psd", SHAPE, layers))


def write_figures(name: str) -> None:
    """Two sprites on a transparent ground: each is predicted separately."""
    alpha = np.zeros((96, 240), np.float32)
    for x in (60, 180):
        alpha = np.maximum(alpha, blob((96, 240), (x, 48), 40))
    shade = np.rint(255 * (1 - outline(alpha)))
    Image.fromarray(np.dstack([shade, shade, shade, 255 * (alpha > 0.5)]).astype(np.uint8)).save(name)


@pytest.mark.parametrize(
    ("write", "arguments"),
    [
        (write_walk, ["walk.gif", "--bits", "16"]),
        (write_layers, ["parts.psd"]),
        (write_layers, ["parts.psd", "--layers", "--bits", "16"]),
        (write_figures, ["figures.png"]),
        (write_figures, ["figures.png", "--split", "auto"]),
    ],
    ids=lambda each: " ".join(each) if isinstance(each, list) else "",
)
def test_a_job_decodes_its_drawing_once(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    decoded: list[bytes],
    model: Path,
    write: Any,
    arguments: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    write(arguments[0])
    assert main(["generate", *arguments, "--model", str(model)]) == 0
    assert decoded == [Path(arguments[0]).read_bytes()]


def test_sprites_of_one_picture_are_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], model: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    write_figures("figures.png")
    assert main(["generate", "figures.png", "--model", str(model)]) == 0
    assert "it shows 2 separate figures" in capsys.readouterr().err
