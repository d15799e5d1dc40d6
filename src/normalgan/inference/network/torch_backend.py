"""TorchBackend: run a generator as a torch module; the only module of this package that imports torch."""

import numpy as np
import torch
from torch import Tensor, nn

from normalgan.arrays import Floats
from normalgan.inference.network.upsampling import upsampler
from normalgan.line_widths import USUAL_WIDTHS, LineWidths
from normalgan.models.base import check_generated
from normalgan.models.condition import make_condition


class TorchBackend:
    """A `Backend` that runs a torch module.

    Args:
        generator: network with outputs (N, 3, S, S), or (N, 4, S, S) with the confidence as last channel. It
            is set to evaluation mode.
        size: side of the input and the output in pixels.
        refined: whether the package's refiner was trained for this generator.
        line_widths: range of line widths, in pixels of the input, that are kept as drawn.
    """

    def __init__(
        self,
        generator: nn.Module,
        size: int,
        *,
        refined: bool = False,
        line_widths: LineWidths = USUAL_WIDTHS,
    ) -> None:
        self.size = size
        self.line_widths = line_widths
        self.upsample = upsampler(refined=refined, threads=torch.get_num_threads())
        self._generator = generator.eval().cpu()

    def predict(self, sketch: Floats, hints: Floats | None = None) -> tuple[Floats, Floats | None]:
        """Return the normals (S, S, 3) predicted for a sketch, and the confidence (S, S) or None.

        Args:
            sketch: (S, S), ink in [0, 1].
            hints: (4, S, S), unit normals at the hints and the mask of the hints; None for no hints.

        Raises:
            InputError: if the output does not have 3 or 4 channels of the input's size.
        """
        if hints is None:
            hints = np.zeros((4, self.size, self.size), np.float32)
        given = torch.from_numpy(sketch)[None, None]
        with torch.no_grad():
            condition = make_condition(given, torch.from_numpy(hints)[None])
            preds: Tensor = self._generator(condition)
        check_generated(self._generator, preds, condition)
        return channels_last(preds[0, :3]), preds[0, 3].float().numpy() if preds.shape[1] > 3 else None


def channels_last(preds: Tensor) -> Floats:
    """Return a tensor (3, S, S) of any device and precision as a float32 array (S, S, 3)."""
    return np.ascontiguousarray(preds.float().cpu().numpy().transpose(1, 2, 0))
