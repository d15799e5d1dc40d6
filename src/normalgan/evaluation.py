"""EvaluationSteps: prediction, validation and testing of a generator."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

import torch
from lightning.pytorch import LightningModule
from torch import Tensor, nn

from normalgan.batch import Batch, Sketches
from normalgan.errors import InputError, did_you_mean
from normalgan.hints import ErrorHintSampler, HintSampler
from normalgan.hints.draw import draw_hints_by_name
from normalgan.metrics import StageMetrics, angular_error, without_hints
from normalgan.models import Generator
from normalgan.models.base import check_generated
from normalgan.models.condition import make_condition

_DROPOUTS = (
    nn.Dropout,
    nn.Dropout1d,
    nn.Dropout2d,
    nn.Dropout3d,
    nn.AlphaDropout,
    nn.FeatureAlphaDropout,
)  # their common base is private in PyTorch
_PRECISIONS = ("32-true", "16-mixed", "bf16-mixed")


class EvaluationSteps(LightningModule):
    """LightningModule that predicts with a generator and measures it; subclasses add the training.

    Attributes:
        generator: network that predicts normal maps.
        hint_sampler: sampler that stands in for the designer, unless a batch has its own hints. Prediction
            uses only a batch's own hints.
        seed: seed of the hint sampler.
        noise_at_test: whether dropout stays active in testing and prediction.
    """

    generator: Generator
    hint_sampler: HintSampler
    seed: int
    noise_at_test: bool

    def check_precision(self) -> None:
        """Check that the trainer leaves weights and batches in single precision.

        Raises:
            InputError: if it converts them; normals and metrics need single precision.
        """
        precision = str(self.trainer.precision)
        if precision not in _PRECISIONS:
            raise InputError(
                f"trainer.precision is {precision}, but weights must stay in single precision; use "
                f"{', '.join(_PRECISIONS[:-1])} or {_PRECISIONS[-1]}."
            )

    def make_metrics(self, stage: str) -> None:
        """Create the metrics of a stage.

        Raises:
            InputError: if a callback of a training run monitors a metric that validation does not log, or
                takes its worst for its best.
        """
        if stage in {"fit", "validate"}:
            self.val_metrics = StageMetrics("val", ("hints", "no_hints"))
            if stage == "fit":
                _check_monitors(getattr(self.trainer, "callbacks", []), self.val_metrics.higher_is_better())
        elif stage == "test":
            self.test_metrics = StageMetrics("test", ("hints", "off_hints", "no_hints"))

    def forward(self, sketch: Tensor, hints: Tensor | None = None) -> Tensor:
        """Predict normal maps.

        Args:
            sketch: (N, 1, H, W) in [0, 1], ink 1.
            hints: (N, 4, H, W), as in `Sketches`; None for no hints.

        Returns:
            (N, 3, H, W) in [-1, 1]: close to unit length on the object and to zero elsewhere.
        """
        return self.predict_with_confidence(sketch, hints)[:, :3]

    def predict_with_confidence(self, sketch: Tensor, hints: Tensor | None = None) -> Tensor:
        """Return `forward`'s output, (N, 3, H, W), or (N, 4, H, W) if the generator predicts confidence."""
        if hints is None:
            hints = sketch.new_zeros(len(sketch), 4, *sketch.shape[2:])
        condition = make_condition(sketch, hints)
        predicted: Tensor = self.generator(condition)
        check_generated(self.generator, predicted, condition)
        return predicted

    def measured_hints(self, batch: Batch) -> Tensor:
        """Return a batch's hints (N, 4, H, W) for validation and testing.

        They depend only on the sample, not on epoch, batch size or number of processes.
        """
        if "hints" in batch:
            return batch["hints"]
        names = batch.get("name") or [str(i) for i in range(len(batch["normal"]))]
        given = batch["normal"], batch["mask"], names, self.seed, self._error(batch)
        return draw_hints_by_name(self.hint_sampler, *given)

    def _error(self, batch: Batch) -> Tensor | None:
        """Return the error of the hint-free prediction (N, 1, H, W), if the sampler needs it."""
        if not isinstance(self.hint_sampler, ErrorHintSampler):
            return None
        with self._eval_mode():
            return angular_error(self._float32_maps(batch, None), batch["normal"])

    @contextmanager
    def _eval_mode(self) -> Iterator[None]:
        """Switch the generator to evaluation mode without gradients, then restore each module's mode."""
        modes = {module: module.training for module in self.generator.modules()}
        self.generator.eval()
        try:
            with torch.no_grad():
                yield
        finally:
            for module, training in modes.items():
                module.training = training

    @torch.compiler.disable  # type: ignore[untyped-decorator]
    def validation_step(self, batch: Batch, batch_idx: int, dataloader_idx: int = 0) -> None:
        """Update the metrics, without hints and with the sampler's hints, which are the same in every epoch.

        Multiple loaders are treated as one set.
        """
        target, mask = batch["normal"], batch["mask"]
        hints = self.measured_hints(batch)
        self.val_metrics.update("hints", self._float32_maps(batch, hints), target, mask)
        self.val_metrics.update("no_hints", self._float32_maps(batch, None), target, mask)

    def on_validation_epoch_end(self) -> None:
        """Log the metrics of the validation split."""
        self._log_figures(self.val_metrics.pop())

    @torch.compiler.disable  # type: ignore[untyped-decorator]
    def test_step(
        self, batch: Batch, batch_idx: int, dataloader_idx: int = 0
    ) -> dict[str, tuple[Tensor, Tensor]]:
        """Update the metrics: without hints, with sampled hints, and with these but without hinted pixels.

        Multiple loaders are treated as one set.

        Returns:
            For callbacks: the maps (N, 3, H, W) and the measured pixels (N, 1, H, W) of each row.
        """
        mask = batch["mask"]
        hints = self.measured_hints(batch)
        preds = self._float32_maps(batch, hints)
        measured = {
            "hints": (preds, mask),
            "off_hints": (preds, without_hints(mask, hints[:, 3:])),
            "no_hints": (self._float32_maps(batch, None), mask),
        }
        for row, (predicted, where) in measured.items():
            self.test_metrics.update(row, predicted, batch["normal"], where)
        return measured

    def on_test_epoch_end(self) -> None:
        """Log the metrics of the test split."""
        self._log_figures(self.test_metrics.pop())

    def _log_figures(self, figures: dict[str, Tensor]) -> None:
        # The values are already reduced; sync_dist only avoids a warning from Lightning.
        self.log_dict(figures, sync_dist=True)

    @torch.compiler.disable  # type: ignore[untyped-decorator]
    def predict_step(self, batch: Sketches, batch_idx: int, dataloader_idx: int = 0) -> Tensor:
        """Return predicted normals (N, 3, H, W), with the user's hints if there are any.

        Drawings are predicted one at a time, because in a batch the last bits depend on the other
        drawings.
        """
        hints = batch.get("hints")
        return torch.cat(
            [
                self._float32_maps({"sketch": sketch[None]}, None if hints is None else hints[i : i + 1])
                for i, sketch in enumerate(batch["sketch"])
            ]
        )

    def _float32_maps(self, batch: Sketches, hints: Tensor | None) -> Tensor:
        predicted: Tensor = self(batch["sketch"], hints)
        return predicted.float()  # under bf16, metrics and files still get full precision

    def on_test_model_eval(self) -> None:
        """Switch to evaluation mode, but keep the noise on if requested."""
        super().on_test_model_eval()
        self.keep_noise()

    def on_predict_model_eval(self) -> None:
        """Switch to evaluation mode, but keep the noise on if requested."""
        super().on_predict_model_eval()
        self.keep_noise()

    def keep_noise(self) -> None:
        """Switch the noise back on after `eval` if ``noise_at_test`` is set."""
        if self.noise_at_test:
            for module in self.generator.modules():
                if isinstance(module, _DROPOUTS):
                    module.train()


def _check_monitors(callbacks: Iterable[object], known: Mapping[str, bool | None]) -> None:
    """Check that the metrics by which callbacks stop or save are those that validation logs.

    Names outside the rows of validation are not checked, because callbacks may log metrics of their own.

    Args:
        callbacks: callbacks of the run.
        known: whether higher is better, by name of metric.

    Raises:
        InputError: if a name is unknown, which Lightning finds only after the first epoch, or if a callback
            takes the lowest of a metric for its best where higher is better, as Lightning does by default.
    """
    rows = tuple(dict.fromkeys(name.rpartition("/")[0] + "/" for name in known))
    figures = dict.fromkeys(name.rpartition("/")[2] for name in known)
    for callback in callbacks:
        name = getattr(callback, "monitor", None)
        if isinstance(name, str) and name.startswith(rows) and name not in known:
            raise InputError(
                f"{type(callback).__name__} monitors {name}, which validation does not log."
                f"{did_you_mean(name, known)} It logs, after {' and '.join(rows)}, {', '.join(figures)}."
            )
        higher = known.get(name) if isinstance(name, str) else None
        better, right, wrong = ("higher", "max", "min") if higher else ("lower", "min", "max")
        if higher is not None and getattr(callback, "mode", None) == wrong:
            raise InputError(
                f"{type(callback).__name__} monitors {name} with the mode {wrong}, but {better} is better; "
                f"set its mode to {right}."
            )
