"""NormalPainter: paints normal maps from sketches and hints, and measures what it painted."""

from abc import ABC

import torch
from lightning.pytorch import LightningModule
from torch import Tensor, nn

from normalgan.batch import Batch, Sketches
from normalgan.hints import ErrorHintSampler, HintSampler
from normalgan.hints.draw import draw_hints, draw_hints_by_name
from normalgan.metrics import StageMetrics, angular_error, without_hints
from normalgan.models import Generator
from normalgan.models.condition import make_condition

__all__ = ["NormalPainter"]


class NormalPainter(LightningModule, ABC):
    """The half of the module that validates, tests and predicts; how it learns is for a subclass to say.

    Args:
        generator: paints the map.
        hint_sampler: plays the designer who gives hints.
        noise_at_test: keep the noise z (dropout) on when testing and predicting.
        seed: of the hints and the noise.
    """

    def __init__(
        self, generator: Generator, hint_sampler: HintSampler, noise_at_test: bool, seed: int
    ) -> None:
        super().__init__()
        self.generator = generator
        self.hint_sampler = hint_sampler
        self.noise_at_test = noise_at_test
        self.seed = seed
        self.val_metrics = StageMetrics("val", ("hints", "no_hints"))
        self.test_metrics = StageMetrics("test", ("hints", "unhinted", "no_hints"))

    def forward(self, sketch: Tensor, hints: Tensor | None = None) -> Tensor:
        """Paint normal maps.

        Args:
            sketch: (N, 1, H, W) in [0, 1], ink 1.
            hints: (N, 4, H, W) normals at the hints and where they are; None for none.

        Returns:
            (N, 3, H, W) in [-1, 1], of about unit length on the object and of none off it.
        """
        return self.paint_with_confidence(sketch, hints)[:, :3]

    def paint_with_confidence(self, sketch: Tensor, hints: Tensor | None = None) -> Tensor:
        """Return what `forward` does, (N, 3, H, W), or (N, 4, H, W) if the generator paints a confidence."""
        if hints is None:
            hints = sketch.new_zeros(len(sketch), 4, *sketch.shape[2:])
        painted: Tensor = self.generator(make_condition(sketch, hints))
        return painted

    def training_hints(self, batch: Batch, seed: int) -> Tensor:
        """Return the hints (N, 4, H, W) of a batch: its own, or else the sampler's under a seed."""
        if "hints" in batch:
            return batch["hints"]
        return draw_hints(self.hint_sampler, batch["normal"], batch["mask"], seed, self._error(batch))

    def measured_hints(self, batch: Batch) -> Tensor:
        """Return the hints (N, 4, H, W) that validation and testing give with a batch.

        A sample always gets the same, whatever the epoch, the size of the batch and the number of processes.
        """
        if "hints" in batch:
            return batch["hints"]
        names = batch.get("name") or [str(i) for i in range(len(batch["normal"]))]
        given = batch["normal"], batch["mask"], names, self.seed, self._error(batch)
        return draw_hints_by_name(self.hint_sampler, *given)

    @torch.no_grad()
    def _error(self, batch: Batch) -> Tensor | None:
        """Return the error without hints (N, 1, H, W), for a sampler that asks for it.

        It is painted as in testing, so that statistics of norms stay as they are and no noise is drawn.
        """
        if not isinstance(self.hint_sampler, ErrorHintSampler):
            return None
        modes = {module: module.training for module in self.generator.modules()}
        self.generator.eval()
        painted = self._paint(batch, None)
        for module, training in modes.items():
            module.training = training
        return angular_error(painted, batch["normal"])

    def validation_step(self, batch: Batch, batch_idx: int) -> None:
        """Measure with the sampler's hints, the same ones every epoch, and with none."""
        target, mask = batch["normal"], batch["mask"]
        hints = self.measured_hints(batch)
        self.val_metrics.update("hints", self._paint(batch, hints), target, mask)
        self.val_metrics.update("no_hints", self._paint(batch, None), target, mask)

    def on_validation_epoch_end(self) -> None:
        """Log the metrics of the validation split."""
        self._log_figures(self.val_metrics.pop())

    def test_step(self, batch: Batch, batch_idx: int) -> dict[str, tuple[Tensor, Tensor]]:
        """Measure with the sampler's hints, also without the hinted pixels, and with no hints.

        Returns:
            What was measured, for callbacks: by row, the maps (N, 3, H, W) and the pixels (N, 1, H, W).
        """
        mask = batch["mask"]
        hints = self.measured_hints(batch)
        preds = self._paint(batch, hints)
        measured = {
            "hints": (preds, mask),
            "unhinted": (preds, without_hints(mask, hints[:, 3:])),
            "no_hints": (self._paint(batch, None), mask),
        }
        for row, (painted, where) in measured.items():
            self.test_metrics.update(row, painted, batch["normal"], where)
        return measured

    def on_test_epoch_end(self) -> None:
        """Log the metrics of the test split."""
        self._log_figures(self.test_metrics.pop())

    def _log_figures(self, figures: dict[str, Tensor]) -> None:
        # They are over all processes already; sync_dist averages equal numbers, and keeps Lightning quiet.
        self.log_dict(figures, sync_dist=True)

    def predict_step(self, batch: Sketches, batch_idx: int) -> Tensor:
        """Return painted normals (N, 3, H, W), with the user's hints if there are any.

        One at a time: in a batch the last bits of a map would depend on its neighbours.
        """
        hints = batch.get("hints")
        return torch.cat(
            [
                self._paint({"sketch": sketch[None]}, None if hints is None else hints[i : i + 1])
                for i, sketch in enumerate(batch["sketch"])
            ]
        )

    def _paint(self, batch: Sketches, hints: Tensor | None) -> Tensor:
        painted: Tensor = self(batch["sketch"], hints)
        return painted.float()  # under bf16, figures and files are still made of full precision

    def on_test_model_eval(self) -> None:
        """Switch to evaluation, but keep the noise on if asked."""
        super().on_test_model_eval()
        self._keep_noise()

    def on_predict_model_eval(self) -> None:
        """Switch to evaluation, but keep the noise on if asked."""
        super().on_predict_model_eval()
        self._keep_noise()

    def _keep_noise(self) -> None:
        if self.noise_at_test:
            for module in self.generator.modules():
                if isinstance(module, nn.Dropout):
                    module.train()
