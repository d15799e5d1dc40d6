"""TorchBackend: a generator as a torch module; the one module of this package that knows torch."""

import numpy as np
import torch
from torch import Tensor, nn

from normalgan.arrays import Floats
from normalgan.inference.network.upsampling import upsampler
from normalgan.line_widths import USUAL_WIDTHS, LineWidths
from normalgan.models.base import check_generated
from normalgan.models.condition import make_condition

__all__ = ["TorchBackend", "channels_last"]


class TorchBackend:
    """A generator in torch: sketches and hints in, normals and an optional confidence out. A `Backend`.

    Args:
        generator: predicts (N, 3, S, S), or 4 channels of which the last is the confidence. It is put into
            evaluation: dropout is off, statistics are fixed.
        size: side of its pictures in pixels.
        device: where it predicts.
        refined: whether the refiner of the package was trained for it.
        line_widths: the lines that it is shown as they were drawn, in its pixels.
    """

    def __init__(
        self,
        generator: nn.Module,
        size: int,
        device: str | torch.device = "cpu",
        *,
        refined: bool = False,
        line_widths: LineWidths = USUAL_WIDTHS,
    ) -> None:
        self.size = size
        self.line_widths = line_widths
        self.upsample = upsampler(refined=refined, threads=torch.get_num_threads())
        self._generator = generator.eval().to(device)
        self._device = device

    def predict(self, sketch: Floats, hints: Floats | None = None) -> tuple[Floats, Floats | None]:
        """Return the normals predicted for one sketch, (S, S, 3), and the confidence (S, S) if there is one.

        Args:
            sketch: (S, S) ink in [0, 1].
            hints: (4, S, S) unit normals at the hints, and where they are; None for no hints.

        Raises:
            InputError: if the generator predicts other than 3 or 4 channels, or maps of another size.
        """
        if hints is None:
            hints = np.zeros((4, self.size, self.size), np.float32)
        given = torch.from_numpy(sketch)[None, None].to(self._device)
        with torch.no_grad():
            condition = make_condition(given, torch.from_numpy(hints)[None].to(self._device))
            preds: Tensor = self._generator(condition)
        check_generated(self._generator, preds, condition)
        return channels_last(preds[0, :3]), preds[0, 3].float().cpu().numpy() if preds.shape[1] > 3 else None


def channels_last(preds: Tensor) -> Floats:
    """Return normals (3, S, S) of any device and precision as an array (S, S, 3) of float32."""
    return np.ascontiguousarray(preds.float().cpu().numpy().transpose(1, 2, 0))
