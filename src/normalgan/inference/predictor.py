"""Predictor: predict the normal map of a drawing."""

from normalgan.inference.inputs import AnyHints, AnyMask, AnyPicture, check_any, prepare_any
from normalgan.inference.network.backend import Backend
from normalgan.inference.network.tile import Tile, check_tile
from normalgan.inference.network.upsampling import Upsampler
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.pipeline import predict
from normalgan.inference.tiling import predict_tile


class Predictor:
    """Predicts drawings. Several threads may call it.

    Args:
        backend: the network.
        upsample: enlarges predictions to the drawing's size; None uses the network's own upsampler.
    """

    def __init__(self, backend: Backend, upsample: Upsampler | None = None) -> None:
        self.backend = backend
        self.upsample = upsample or backend.upsample

    @property
    def size(self) -> int:
        """Side of the network's input in pixels."""
        return self.backend.size

    def __call__(
        self,
        image: AnyPicture,
        hints: AnyHints = None,
        mask: AnyMask = None,
        size: int | None = None,
        tile: Tile | None = None,
    ) -> NormalMap:
        """Return the normal map of a drawing.

        Args:
            image: a path; a Pillow image; or an array (H, W), (H, W, 3) or (H, W, 4) of uint8, uint16, or
                floats from 0 to 1. Lines may be dark on light or light on dark. NumPy must be able to read
                the array, as it reads a tensor of PyTorch on the CPU.
            hints: a path; a list of ``{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}`` in pixels from the
                drawing's upper left corner; or an array (H, W, 4) with a unit normal and 1 at each hint, and
                0 elsewhere.
            mask: the object, as a path, an image or an array of the drawing's size, either bool or white on
                black; or a source: ``outline`` fills the areas that lines enclose, ``reader`` lets a small
                network decide on each of these areas, ``model`` uses the network's own segmentation. None
                uses the drawing's opacity if it shows the object, otherwise the reader.
            size: longer side of the map in pixels, 8 to 8192; None keeps the drawing's size.
            tile: directions in which the drawing repeats: ``x`` (horizontally), ``y`` or ``both``; the map
                then repeats too. None for a drawing that does not repeat.

        Raises:
            InputError: if an argument is invalid, or the network sees no object.
        """
        if tile is not None:
            check_tile(tile)
            picture, found_mask, found_hints = check_any(image, hints, mask, size)
            return predict_tile(self.backend, picture, tile, found_mask, found_hints, size, self.upsample)
        return predict(
            self.backend,
            prepare_any(image, self.size, hints, mask, size, self.backend.line_widths),
            self.upsample,
        )
