"""The node of ComfyUI, loaded and called as ComfyUI does it."""

import builtins
import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from add_ons import DOG, install
from PIL import Image

import normalgan


@pytest.fixture
def node(tmp_path: Path) -> Any:
    """The node, from where the installer puts it in ComfyUI."""
    install("comfyui", tmp_path, "--to", str(tmp_path / "custom_nodes"))
    folder = tmp_path / "custom_nodes" / "normalgan_nodes"
    spec = importlib.util.spec_from_file_location("custom_nodes.normalgan_nodes", folder / "__init__.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    (name,) = module.NODE_CLASS_MAPPINGS
    assert set(module.NODE_DISPLAY_NAME_MAPPINGS) == {name}
    return module.NODE_CLASS_MAPPINGS[name]


def fox() -> tuple[np.ndarray[Any, np.dtype[np.uint8]], torch.Tensor]:
    """A drawing as an array and as ComfyUI's LoadImage gives it."""
    with Image.open(DOG) as image:
        drawing = np.asarray(image.convert("RGB"))
    return drawing, torch.from_numpy(drawing.astype(np.float32) / 255)[None]


def call(node: Any, **given: Any) -> Any:
    """Call a node as the host does: by the names of its inputs, the method that FUNCTION names."""
    inputs = node.INPUT_TYPES()
    assert set(given) <= set(inputs["required"]) | set(inputs["optional"])
    assert set(inputs["required"]) <= set(given)
    result = getattr(node(), node.FUNCTION)(**given)
    assert len(result) == len(node.RETURN_TYPES) == len(node.RETURN_NAMES)
    return result


def test_a_batch_becomes_normal_maps_and_masks(node: Any) -> None:
    drawing, image = fox()
    maps, masks = call(node, image=image.repeat(2, 1, 1, 1), green="up")
    assert maps.shape == (2, *drawing.shape)
    assert maps.dtype == masks.dtype == torch.float32
    assert torch.equal(maps[0], maps[1])
    predicted = normalgan.load()(drawing)
    np.testing.assert_array_equal(masks[0].numpy() > 0.5, predicted.mask)
    np.testing.assert_allclose(
        maps[0].numpy()[predicted.mask] * 2 - 1, predicted.normal[predicted.mask], atol=1e-5
    )
    np.testing.assert_allclose(
        maps[0].numpy()[~predicted.mask], [[0.5, 0.5, 1.0]] * int((~predicted.mask).sum())
    )


def test_green_down_and_a_mask(node: Any) -> None:
    drawing, image = fox()
    mask = torch.zeros(1, *drawing.shape[:2])
    mask[:, 60:200, 60:200] = 1
    (up, where), (down, _) = (call(node, image=image, green=green, mask=mask) for green in ("up", "down"))
    torch.testing.assert_close(down[..., 1], 1 - up[..., 1])
    torch.testing.assert_close(where, mask)


def test_an_image_with_alpha_has_its_opacity_as_mask(node: Any) -> None:
    _, image = fox()
    rows, columns = torch.meshgrid(*(torch.arange(side) for side in image.shape[1:3]), indexing="ij")
    # A disc, because an opaque rectangle around lines is their paper.
    alpha = (torch.hypot(rows - 130.0, columns - 130.0) < 70).float()[None, ..., None]
    ((_, where),) = [call(node, image=torch.cat([image, alpha], -1), green="up")]
    torch.testing.assert_close(where, alpha[..., 0])


@pytest.mark.parametrize("shows", ["auto", "background"])
def test_the_mask_of_load_image_is_white_on_the_background(node: Any, shows: str) -> None:
    _, image = fox()
    object_ = torch.zeros(1, *image.shape[1:3])
    object_[:, 60:200, 60:200] = 1
    _, where = call(node, image=image, green="up", mask=1 - object_, mask_shows=shows)
    torch.testing.assert_close(where, object_)


def test_the_empty_mask_of_load_image_counts_as_none(node: Any) -> None:
    _, image = fox()
    (maps, where), (wanted, own) = (
        call(node, image=image, green="up", **more) for more in ({"mask": torch.zeros(1, 64, 64)}, {})
    )
    assert torch.equal(maps, wanted)
    assert torch.equal(where, own)


def test_one_mask_serves_a_batch_and_other_counts_are_refused(node: Any) -> None:
    _, image = fox()
    batch = image.repeat(3, 1, 1, 1)
    mask = torch.zeros(1, *image.shape[1:3])
    mask[:, 60:200, 60:200] = 1
    _, where = call(node, image=batch, green="up", mask=mask)
    torch.testing.assert_close(where, mask.repeat(3, 1, 1))
    with pytest.raises(RuntimeError, match=r"^normalgan: there are 2 masks for 3 images; give one for each"):
        call(node, image=batch, green="up", mask=mask.repeat(2, 1, 1))


def test_what_cannot_be_used_is_one_sentence(node: Any, tmp_path: Path) -> None:
    _, image = fox()
    with pytest.raises(RuntimeError, match=r"^normalgan: .*nothere\.onnx"):
        call(node, image=image, green="up", model=str(tmp_path / "nothere.onnx"))


def test_without_normalgan_one_sentence_says_what_to_do(node: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    _, image = fox()
    original = builtins.__import__

    def without(name: str, *more: Any, **named: Any) -> Any:
        if name == "normalgan":
            raise ImportError(name)
        return original(name, *more, **named)

    monkeypatch.delitem(sys.modules, "normalgan")
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(RuntimeError, match="install it into the Python that runs ComfyUI"):
        call(node, image=image, green="up")
