"""Add-on for ComfyUI: a node that predicts normal maps of drawings with ONNX Runtime, without the command.

It runs in ComfyUI's own Python: install normalgan there.
"""

from typing import Any

MISSING = (
    "normalgan was not found: install it into the Python that runs ComfyUI, with that Python's own pip, "
    "and restart ComfyUI."
)

SHOWN = ("auto", "object", "background")


class NormalganNormalMap:
    """From a batch of drawings to their normal maps and masks."""

    CATEGORY = "image/normalgan"
    FUNCTION = "predict"
    RETURN_TYPES = ("IMAGE", "MASK")
    RETURN_NAMES = ("normal map", "object")

    @classmethod
    def INPUT_TYPES(cls) -> dict[str, Any]:  # noqa: N802 - ComfyUI's name
        """Return the inputs of the node."""
        return {
            "required": {
                "image": ("IMAGE",),
                "green": (["up", "down"], {"tooltip": "down for DirectX and Unreal"}),
            },
            "optional": {
                "mask": (
                    "MASK",
                    {"tooltip": "one for each image, or one for all; an empty one counts as none"},
                ),
                "mask_shows": (
                    list(SHOWN),
                    {
                        "tooltip": "what is white in the mask; LoadImage makes the background white. auto: "
                        "the background if most of the mask's edge is white"
                    },
                ),
                "model": (
                    "STRING",
                    {"default": "", "tooltip": "a file of normalgan export; empty: the shipped one"},
                ),
            },
        }

    def predict(
        self, image: Any, green: str = "up", mask: Any = None, mask_shows: str = "auto", model: str = ""
    ) -> tuple[Any, Any]:
        """Predict normal maps and masks.

        Args:
            image: drawings (N, H, W, 3) or (N, H, W, 4) of floats from 0 to 1, as ComfyUI has them.
            green: "up" or "down".
            mask: where the objects are (N, H, W), or one mask (1, H, W) or (H, W) for all, or None. A mask
                without a white pixel counts as None: LoadImage gives a black 64 x 64 mask for an image
                without alpha.
            mask_shows: what is white in the mask, one of `SHOWN`.
            model: the path of a model, or empty for the shipped one.

        Returns:
            Normal maps (N, H, W, 3), colours (n + 1) / 2 without gamma, and masks (N, H, W), 1 on the object.

        Raises:
            RuntimeError: with one sentence, which ComfyUI shows on the node.
        """
        import torch  # ComfyUI provides it

        try:
            import normalgan
        except ImportError as error:
            raise RuntimeError(MISSING) from error
        maps, objects = [], []
        masks = None if mask is None else mask.reshape(-1, *mask.shape[-2:]).cpu().numpy()
        if masks is not None and len(masks) not in {1, len(image)}:
            raise RuntimeError(
                f"normalgan: there are {len(masks)} masks for {len(image)} images; give one for each, or one "
                "for all."
            )
        try:
            predictor = normalgan.load(model or "shipped")
            for number, drawing in enumerate(image.cpu().numpy()):
                given = None if masks is None else _object(masks[number if len(masks) > 1 else 0], mask_shows)
                predicted = predictor(drawing.clip(0, 1), mask=given)
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


def _object(mask: Any, shows: str) -> Any:
    """Return where the object is, (H, W) bool, or None for an empty mask.

    Args:
        mask: (H, W) of floats from 0 to 1.
        shows: what is white in it, one of `SHOWN`.
    """
    white = mask > 0.5
    if not white.any():
        return None
    if shows == "auto":
        edge = [*white[0], *white[-1], *white[1:-1, 0], *white[1:-1, -1]]
        shows = "background" if sum(edge) > len(edge) / 2 and not white.all() else "object"
    return ~white if shows == "background" else white


NODE_CLASS_MAPPINGS = {"NormalganNormalMap": NormalganNormalMap}
NODE_DISPLAY_NAME_MAPPINGS = {"NormalganNormalMap": "Normal map of a drawing (normalgan)"}
