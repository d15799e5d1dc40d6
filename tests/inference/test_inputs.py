"""A drawing, its mask and its hints as files, arrays and images: the same in every form, or refused."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from PIL import Image

from normalgan.errors import InputError
from normalgan.inference.inputs import prepare_any
from normalgan.inference.preparation import Prepared
from pens import blob, outline

GREY = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
FILLED = blob() > 0.5


def assert_same(one: Prepared, other: Prepared) -> None:
    np.testing.assert_array_equal(one.model_input, other.model_input)
    np.testing.assert_array_equal(one.ink, other.ink)
    np.testing.assert_array_equal(one.mask, other.mask)
    assert (one.hints is None) == (other.hints is None)
    if one.hints is not None:
        np.testing.assert_array_equal(one.hints, other.hints)


@pytest.fixture
def sketch(tmp_path: Path) -> Path:
    """A drawing's file."""
    Image.fromarray(GREY).save(tmp_path / "sketch.png")
    return tmp_path / "sketch.png"


@pytest.mark.parametrize(
    "image",
    [
        GREY,
        np.dstack([GREY] * 3),
        np.dstack([*[GREY] * 3, np.full_like(GREY, 255)]),
        GREY.astype(np.uint16) * 257,
        (GREY / np.float32(255)).astype(np.float32),
        Image.fromarray(GREY),
        Image.fromarray(GREY).convert("RGB"),
        torch.from_numpy(GREY),
        torch.from_numpy(GREY / np.float32(255)),
    ],
    ids=[
        "grey",
        "RGB",
        "RGBA",
        "uint16",
        "floats",
        "Pillow's grey",
        "Pillow's RGB",
        "tensor",
        "floats' tensor",
    ],
)
def test_a_drawing_in_any_form_is_the_file(sketch: Path, image: Any) -> None:
    assert_same(prepare_any(image, 64), prepare_any(sketch, 64))
    assert_same(prepare_any(image, 64, size=450), prepare_any(str(sketch), 64, size=450))


@pytest.mark.parametrize(
    "mask",
    [
        FILLED,
        FILLED.astype(np.uint8) * 255,
        FILLED.astype(float),
        Image.fromarray(FILLED),
        torch.from_numpy(FILLED),
    ],
    ids=["bool", "uint8", "floats", "Pillow", "tensor"],
)
def test_a_mask_in_any_form_is_the_file(sketch: Path, tmp_path: Path, mask: Any) -> None:
    Image.fromarray(FILLED).save(tmp_path / "mask.png")
    found = prepare_any(sketch, 64, mask=mask)
    np.testing.assert_array_equal(found.mask, FILLED)
    assert_same(found, prepare_any(sketch, 64, mask=tmp_path / "mask.png"))


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "I;16", "P", "1"])
def test_what_is_reduced_to_be_worked_on_is_reduced_alike(tmp_path: Path, mode: str) -> None:
    large = Image.fromarray(GREY).resize((2400, 600), Image.Resampling.BICUBIC)  # flat, to be quick
    if mode == "RGBA":
        large.putalpha(Image.fromarray(FILLED).resize(large.size))
    image = Image.fromarray(np.asarray(large, np.uint16) * 257) if mode == "I;16" else large.convert(mode)
    mask = Image.fromarray(FILLED).resize(large.size)
    image.save(tmp_path / "large.png")
    mask.save(tmp_path / "mask.png")
    wanted = prepare_any(tmp_path / "large.png", 64, mask=tmp_path / "mask.png")
    assert wanted.ink.shape == (512, 2048)
    assert_same(prepare_any(image, 64, mask=mask), wanted)
    if mode not in {"P", "1"}:  # the first holds numbers of colours, and a drawing is no array of bool
        assert_same(prepare_any(np.asarray(image), 64, mask=np.asarray(mask)), wanted)


def test_premultiplied_greys_are_read(sketch: Path) -> None:
    assert_same(prepare_any(Image.fromarray(GREY).convert("LA").convert("La"), 64), prepare_any(sketch, 64))


def test_hints_may_have_the_numbers_of_numpy(sketch: Path) -> None:
    listed = [{"x": 170, "y": 90, "normal": [0.6, 0.0, 0.8]}]
    computed = [{"x": np.int64(170), "y": np.float32(90), "normal": np.array([0.6, 0.0, 0.8])}]
    assert_same(prepare_any(sketch, 64, computed), prepare_any(sketch, 64, listed))


def test_hints_may_have_the_numbers_of_torch(sketch: Path) -> None:
    listed = [{"x": 170, "y": 90, "normal": [0.6, 0.0, 0.8]}]
    tensors = [{"x": torch.tensor(170), "y": torch.tensor(90.0), "normal": torch.tensor([0.6, 0.0, 0.8])}]
    assert_same(prepare_any(sketch, 64, tensors), prepare_any(sketch, 64, listed))


def test_hints_in_any_form_are_the_file(sketch: Path, tmp_path: Path) -> None:
    listed = [{"x": 170, "y": 90, "normal": [0.6, 0.0, 0.8]}]
    (tmp_path / "hints.json").write_text(json.dumps(listed))
    array = np.zeros((*GREY.shape, 4), np.float32)
    array[90, 170] = (0.6, 0.0, 0.8, 1)
    wanted = prepare_any(sketch, 64, tmp_path / "hints.json")
    assert wanted.hints is not None
    assert wanted.hints[3].sum() == 1
    assert_same(prepare_any(sketch, 64, listed), wanted)
    assert_same(prepare_any(sketch, 64, array), wanted)
    assert_same(prepare_any(sketch, 64, torch.from_numpy(array)), wanted)
    assert prepare_any(sketch, 64, []).hints is None


def cut(array: NDArray[Any]) -> NDArray[Any]:
    return np.ascontiguousarray(array[:-1])


BAD: dict[str, tuple[dict[str, Any], str]] = {
    "whole numbers": ({"image": GREY.astype(int)}, r"^the image is an array of int64; give uint8 from 0 to"),
    "signed": ({"image": GREY / 127.5 - 1}, r"^the image has floats from -1 to 1; black is 0 and white is 1"),
    "no numbers": ({"image": np.full((30, 40), np.nan)}, r"^the image has floats from nan to nan; black"),
    "channels first": (
        {"image": np.zeros((3, 30, 40), np.uint8)},
        r"^the image has the shape \(3, 30, 40\); an array has \(H, W\), \(H, W, 3\) or \(H, W, 4\), rows",
    ),
    "a tensor with channels first": (
        {"image": torch.zeros(1, 30, 40)},
        r"^the image has the shape \(1, 30, 40\); an array has \(H, W\)",
    ),
    "a tensor that needs gradients": (
        {"image": torch.ones(30, 40, requires_grad=True)},
        r"^the image cannot be read as an array of NumPy: .*detach\(\)\.numpy\(\) instead\.$",
    ),
    "a tensor of another precision": (
        {"mask": torch.ones(200, 300, dtype=torch.bfloat16)},
        r"^the mask cannot be read as an array of NumPy: .*BFloat16",
    ),
    "a dot": ({"image": GREY[:4, :9]}, r"^the image is 9 × 4 pixels; a drawing has 8 to 8192 a side"),
    "bool": ({"image": FILLED}, r"^the image is an array of bool; give uint8"),
    "a list": (
        {"image": GREY.tolist()},
        r"^the image is of the type list; give a path, an array or an image of Pil",
    ),
    "no file": ({"image": "gone.png"}, r"there is no file gone\.png"),
    "blank": ({"image": np.full_like(GREY, 255)}, r"no lines were found in it; a sketch needs lines"),
    "another mask": ({"mask": cut(FILLED)}, r"^the mask is 300 × 199 pixels, but its sketch 300 × 200\."),
    "an empty mask": ({"mask": np.zeros_like(FILLED)}, r"^the mask is empty; paint the object white"),
    "no mask": ({"mask": 7}, r"^the mask is of the type int; give a path, an array or an image of Pil"),
    "other hints": (
        {"hints": np.zeros((4, 200, 300), np.float32)},
        r"^the hints are an array of float32 with the shape \(4, 200, 300\); for this drawing they are "
        r"floats with the shape \(200, 300, 4\): x, y, z",
    ),
    "long hints": (
        {"hints": np.ones((*GREY.shape, 4))},
        r"^the hint at x 0, y 0 has length 1\.73; a normal has length 1\.$",
    ),
    "hints that look away": (
        {"hints": np.tile(np.array([0, 0.6, -0.8, 1]), (*GREY.shape, 1))},
        r"^the hint at x 0, y 0 has z -0\.8 and looks away from the viewer; the z of a normal must be 0",
    ),
    "listed wrongly": ({"hints": [{"x": 1}]}, r'^hint 1 of the list is {"x": 1}; a hint has x, y'),
    "no hints": ({"hints": 3}, r"^the hints are of the type int; give a path, a list or an array\.$"),
    "half hints": (
        {"hints": np.full((*GREY.shape, 4), [0, 0.6, 0.8, 0.3])},
        r"^the hints have 0\.3 at x 0, y 0 as their fourth value; it is 1 where there is a hint, and 0 els",
    ),
    "hints of objects": (
        {"hints": [{"x": 1, "y": 2, "normal": {1, 2}}]},
        r"^hint 1 of the list is .*; a hint has x, y",
    ),
    "a mask of ones": (
        {"mask": FILLED.astype(np.uint8)},
        r"^the mask is an array of uint8 whose largest value is 1; white is 255, or 1 in an array of floats",
    ),
    "a mask of layers": ({"mask": FILLED[..., None]}, r"^the mask has the shape \(200, 300, 1\); an array"),
    "a size in words": ({"size": "100"}, r"^size is '100'; it is a whole number of pixels, or None\.$"),
    "half a pixel": ({"size": 100.5}, r"^size is 100\.5; it is a whole number of pixels, or None\.$"),
    "too large": ({"size": 9000}, r"^size is 9000; a map has 8 to 8192 pixels a side\.$"),
}


@pytest.mark.parametrize("kind", BAD)
def test_what_cannot_be_used_is_refused_in_a_sentence(kind: str) -> None:
    given, sentence = BAD[kind]
    whole: dict[str, Any] = {"image": GREY, "network_size": 64}
    with pytest.raises(InputError, match=sentence):
        prepare_any(**(whole | given))
