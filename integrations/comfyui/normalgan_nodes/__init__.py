"""ComfyUI: a node that paints the normal maps of drawings, by ONNX Runtime and without the command.

It runs in ComfyUI's own Python: install normalgan there.
"""

from typing import Any

MISSING = (
    "normalgan was not found: install it into the Python that runs ComfyUI, with that Python's own pip, "
    "and start ComfyUI anew."
)


class NormalganNormalMap:
    """From a batch of drawings to their normal maps and masks."""

    CATEGORY = "image/normalgan"
    FUNCTION = "predict"
    RETURN_TYPES = ("IMAGE", "MASK")
    RETURN_NAMES = ("normal map", "object")

    @classmethod
    def INPUT_TYPES(cls) -> dict[str, Any]:  # noqa: N802 - ComfyUI's name
        """Return what the node takes."""
        return {
            "required": {
                "image": ("IMAGE",),
                "green": (["up", "down"], {"tooltip": "down for DirectX and Unreal"}),
            },
            "optional": {
                "mask": ("MASK", {"tooltip": "white where the object is"}),
                "model": (
                    "STRING",
                    {"default": "", "tooltip": "a file of normalgan export; empty: the shipped one"},
                ),
            },
        }

    def predict(self, image: Any, green: str = "up", mask: Any = None, model: str = "") -> tuple[Any, Any]:
        """Paint.

        Args:
            image: drawings (N, H, W, 3) of floats from 0 to 1, as ComfyUI has them.
            green: "up" or "down".
            mask: where the objects are (N, H, W), or one (1, H, W) for all, or None.
            model: the path of a model, or nothing.

        Returns:
            Normal maps (N, H, W, 3), colours (n + 1) / 2 without gamma, and masks (N, H, W), 1 on the object.

        Raises:
            RuntimeError: with one sentence, which ComfyUI shows at the node.
        """
        import torch  # ComfyUI brings it

        try:
            import normalgan
        except ImportError as error:
            raise RuntimeError(MISSING) from error
        maps, objects = [], []
        try:
            predictor = normalgan.load(model or "shipped")
            for number, drawing in enumerate(image.cpu().numpy()):
                given = None if mask is None else mask[min(number, len(mask) - 1)].cpu().numpy() > 0.5
                predicted = predictor(drawing[..., :3].clip(0, 1), mask=given)
                normals = torch.from_numpy(predicted.normal.copy())
                object_ = torch.from_numpy(predicted.mask.copy())
                normals[~object_] = torch.tensor([0.0, 0.0, 1.0])  # flat
                if green == "down":
                    normals[..., 1] *= -1
                maps.append((normals + 1) / 2)
                objects.append(object_.float())
        except normalgan.InputError as error:
            raise RuntimeError(f"normalgan: {error}") from error
        return torch.stack(maps), torch.stack(objects)


NODE_CLASS_MAPPINGS = {"NormalganNormalMap": NormalganNormalMap}
NODE_DISPLAY_NAME_MAPPINGS = {"NormalganNormalMap": "Normal map of a drawing (normalgan)"}
