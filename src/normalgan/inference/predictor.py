"""Predictor: predicts the normal map of a drawing."""

from normalgan.inference.inputs import AnyHints, AnyMask, AnyPicture, check_any, prepare_any
from normalgan.inference.network.backend import Backend
from normalgan.inference.network.tile import Tile, check_tile
from normalgan.inference.network.upsampling import Upsampler
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.pipeline import predict
from normalgan.inference.tiling import predict_tile

__all__ = ["Predictor"]


class Predictor:
    """Predicts drawings. Several threads may call it.

    Args:
        backend: the network.
        upsample: the step from the network's size to the drawing's; None uses the network's.
    """

    def __init__(self, backend: Backend, upsample: Upsampler | None = None) -> None:
        self.backend = backend
        self.upsample = upsample or backend.upsample

    @property
    def size(self) -> int:
        """Side in pixels of the pictures that the network is shown."""
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
            image: a path; an image of Pillow; or an array (H, W), (H, W, 3) or (H, W, 4) of uint8, uint16, or
                floats from 0 to 1, dark lines on light paper or light ones on dark.
            hints: a path; a list of ``{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}`` in pixels of the drawing
                from its upper left; or an array (H, W, 4), a unit normal and 1 at each hint, and 0 elsewhere.
            mask: where the object is: a path, an image or an array of the drawing's size, bool, or white on
                black; ``outline`` fills what lines enclose, ``reader`` lets a small network vote on that,
                ``model`` leaves it to the network of normals; None takes the drawing's opacity if it shows
                the object, else the reader.
            size: longer side of the map in pixels, 8 to 8192; None is the drawing's.
            tile: the directions in which the drawing repeats, ``both``, ``x`` (side by side) or ``y``; the
                map then repeats too. None for a drawing that ends at its edges.

        Raises:
            InputError: if something cannot be used, or the network sees no object.
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
