"""Packed maps: what is in their channels."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from normalgan.__main__ import main
from pens import blob, outline


def pixels(name: str) -> NDArray[np.uint8]:
    return np.asarray(Image.open(name))


def generate(*arguments: str) -> int:
    return main(["generate", "fox.png", "--model", "model.onnx", *arguments])


@pytest.fixture
def here(here: Path) -> Path:
    Image.fromarray(np.rint(255 * (1 - outline(blob()))).astype(np.uint8)).save("fox.png")
    return here


def test_channels_hold_what_single_maps_do(here: Path) -> None:
    assert generate("--ao", "--specular", "--roughness", "--orm", "-o", "a") == 0
    ao, specular, rough, orm = (
        pixels(f"a/fox_{each}.png").astype(int) for each in ("ao", "specular", "roughness", "orm")
    )
    assert np.abs(rough - (255 - specular)).max() <= 1
    assert np.abs(orm - np.dstack([ao, rough, np.zeros_like(ao)])).max() <= 1
    assert specular.max() > 50


def test_specular_goes_into_the_alpha_of_the_map(here: Path) -> None:
    assert generate("--specular", "--show-mask", "-o", "a") == 0
    for y in ("up", "down"):
        assert generate("-o", f"{y}_alone", "--y", y) == 0
        assert generate("--pack", "normal_specular", "--pad", "0", "-o", y, "--y", y) == 0
        packed = pixels(f"{y}/fox_normal.png")
        assert np.abs(packed[..., 3].astype(int) - pixels("a/fox_specular.png")).max() <= 1
        assert np.array_equal(packed[..., :3], pixels(f"{y}_alone/fox_normal.png"))
    assert generate("--pack", "normal_specular", "--format", "tiff", "-o", "floats") == 0
    found = cv2.imread("floats/fox_normal.tiff", cv2.IMREAD_UNCHANGED)
    assert found is not None
    assert np.abs(255 * found[..., 3] - pixels("a/fox_specular.png")).max() <= 1.5


def test_a_packed_animation_is_written_frame_by_frame(here: Path) -> None:
    frame = Image.open("fox.png").convert("RGB")
    frame.save("walk.gif", save_all=True, append_images=[frame.rotate(5, fillcolor="white")])
    assert (
        main(["generate", "walk.gif", "--model", "model.onnx", "--pack", "normal_specular", "-o", "a"]) == 0
    )
    assert [pixels(f"a/walk_000{n}_normal.png").shape[2] for n in (1, 2)] == [4, 4]


def test_two_things_in_one_channel_are_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert generate("--pack", "normal_specular", "--alpha") == 2
    assert "both write the alpha channel; leave one out." in capsys.readouterr().err
    assert generate("--pack", "orm") == 2
    said = capsys.readouterr().err
    assert "normal_specular" in said
    assert len(said.splitlines()) == 1
