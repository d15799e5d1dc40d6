"""NormalGAN: the LightningModule, with the optimisation of both networks by hand."""

import warnings
from collections.abc import Callable
from typing import cast

import torch
from lightning.pytorch import LightningModule
from lightning.pytorch.cli import OptimizerCallable
from lightning.pytorch.core.optimizer import LightningOptimizer
from torch import Tensor, nn
from torch.optim import Optimizer, RMSprop
from torch.optim.lr_scheduler import LRScheduler

from normalgan.batch import Batch, Sketches
from normalgan.errors import InputError
from normalgan.hints import HintSampler
from normalgan.hints.draw import draw_hints, draw_hints_by_name
from normalgan.metrics import StageMetrics, without_hints
from normalgan.models import Discriminator, Generator
from normalgan.models.condition import make_condition, paste_hints
from normalgan.models.statistics import average_statistics
from normalgan.objectives import AdversarialObjective, L1AndHints, Reconstruction, Term
from normalgan.seeds import derive_seed


def _rmsprop(parameters: object) -> Optimizer:
    return RMSprop(cast("list[Tensor]", parameters), lr=5e-5, alpha=0.9)


class NormalGAN(LightningModule):
    """Paints a normal map from a sketch and hints, and learns to against a discriminator.

    All randomness of a training step (dropout, hints, the gradient penalty) is seeded by the number of the
    step, so that a run that was killed and resumed ends in the same weights as one that was not.

    Args:
        generator: paints the map.
        discriminator: tells painted maps from true ones; None trains on the reconstruction loss alone.
        hint_sampler: plays the designer who gives hints, in training and testing. A batch that brings hints
            of its own is not asked again; when predicting there are no others.
        objective: what discriminator and generator want of the scores.
        generator_optimizer: optimiser of the generator.
        discriminator_optimizer: optimiser of the discriminator.
        lr_scheduler: schedule of both learning rates, stepped after each epoch; None keeps them constant.
        adversarial_weight: weight of the objective's generator loss.
        reconstruction: what the generator is to be right about, pixel by pixel.
        gradient_clip: largest norm of the generator's gradient; None leaves it as it is.
        n_critic: discriminator steps to each generator step; one batch each.
        noise_at_test: keep the noise z (dropout) on when testing and predicting, as pix2pix does.
        seed: of the hints and the noise.

    References:
        He et al. 2021, "Sketch-based Normal Map Generation with Geometric Sampling".
    """

    def __init__(
        self,
        generator: Generator,
        discriminator: Discriminator | None,
        hint_sampler: HintSampler,
        objective: AdversarialObjective,
        generator_optimizer: OptimizerCallable = _rmsprop,
        discriminator_optimizer: OptimizerCallable = _rmsprop,
        lr_scheduler: Callable[[Optimizer], LRScheduler] | None = None,
        adversarial_weight: float = 1.0,
        reconstruction: Reconstruction = L1AndHints(),  # noqa: B008  # frozen
        gradient_clip: float | None = None,
        n_critic: int = 5,
        noise_at_test: bool = False,
        seed: int = 0,
    ) -> None:
        super().__init__()
        if n_critic < 1:
            raise InputError(f"n_critic must be 1 or more, not {n_critic}.")
        if gradient_clip is not None and gradient_clip <= 0:
            raise InputError(f"gradient_clip must be greater than 0, or null, not {gradient_clip}.")
        if adversarial_weight < 0:
            raise InputError(f"adversarial_weight must be 0 or more, not {adversarial_weight}.")
        if discriminator is not None:
            objective.check(discriminator)
        with warnings.catch_warnings():
            # From the command line the settings are saved; in Python the objects themselves, which is meant.
            warnings.filterwarnings("ignore", message=".*is an instance of `nn.Module`.*")
            self.save_hyperparameters()
        self.automatic_optimization = False
        self.generator = generator
        self.discriminator = discriminator
        self.hint_sampler = hint_sampler
        self.objective = objective
        self.generator_optimizer = generator_optimizer
        self.discriminator_optimizer = discriminator_optimizer
        self.lr_scheduler = lr_scheduler
        self.adversarial_weight = adversarial_weight
        self.reconstruction = reconstruction
        self.gradient_clip = gradient_clip
        self.n_critic = n_critic
        self.noise_at_test = noise_at_test
        self.seed = seed
        self.val_metrics = StageMetrics("val", ("hints", "no_hints"))
        self.test_metrics = StageMetrics("test", ("hints", "unhinted", "no_hints"))

    # --- painting -------------------------------------------------------------------------------------

    def forward(self, sketch: Tensor, hints: Tensor | None = None) -> Tensor:
        """Paint normal maps.

        Args:
            sketch: (N, 1, H, W) in [0, 1], ink 1.
            hints: (N, 4, H, W) normals at the hints and where they are; None for none.

        Returns:
            (N, 3, H, W) in [-1, 1], of about unit length on the object and of none off it.
        """
        if hints is None:
            hints = sketch.new_zeros(len(sketch), 4, *sketch.shape[2:])
        painted: Tensor = self.generator(make_condition(sketch, hints))
        return painted[:, :3]

    def training_hints(self, batch: Batch, seed: int) -> Tensor:
        """Return the hints (N, 4, H, W) of a batch: its own, or else the sampler's under a seed."""
        if "hints" in batch:
            return batch["hints"]
        return draw_hints(self.hint_sampler, batch["normal"], batch["mask"], seed)

    def measured_hints(self, batch: Batch) -> Tensor:
        """Return the hints (N, 4, H, W) that validation and testing give with a batch.

        A sample always gets the same, whatever the epoch, the size of the batch and the number of processes.
        """
        if "hints" in batch:
            return batch["hints"]
        names = batch.get("name") or [str(i) for i in range(len(batch["normal"]))]
        return draw_hints_by_name(self.hint_sampler, batch["normal"], batch["mask"], names, self.seed)

    # --- training -------------------------------------------------------------------------------------

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """Step the discriminator, and with every n-th batch the generator."""
        step = self.trainer.fit_loop.total_batch_idx  # goes on counting through epochs; batch_idx does not
        seed = derive_seed("train", self.seed, step, self.global_rank)
        torch.manual_seed(seed)
        hints = self.training_hints(batch, seed)
        condition = make_condition(batch["sketch"], hints)
        generates = self.discriminator is None or step % self.n_critic == 0  # so that fast_dev_run tries both
        with torch.set_grad_enabled(generates):
            painted: Tensor = self.generator(condition)
        fake = paste_hints(painted[:, :3], hints)
        if self.discriminator is not None:
            self._step_discriminator(self.discriminator, condition, batch["normal"], fake.detach())
        if generates:
            terms = self.reconstruction.terms(painted, batch["normal"], batch["mask"], hints[:, 3:])
            self._step_generator(condition, terms, fake)

    def _step_discriminator(
        self, discriminator: Discriminator, condition: Tensor, real: Tensor, fake: Tensor
    ) -> None:
        optimizer = self._optimizers()[1]
        with self.toggled_optimizer(optimizer):
            # Two passes: in one, batch norm would mix the statistics of true and painted maps.
            loss = self.objective.discriminator_loss(
                discriminator(condition, real), discriminator(condition, fake)
            )
            penalty = self.objective.penalty(lambda normal: discriminator(condition, normal), real, fake)
            optimizer.zero_grad()
            self.manual_backward(loss + penalty)
            optimizer.step()
            self.objective.after_discriminator_step(discriminator)
        self.log("train/discriminator", loss.detach(), prog_bar=True)

    def _step_generator(self, condition: Tensor, terms: dict[str, Term], fake: Tensor) -> None:
        optimizer = self._optimizers()[0]
        with self.toggled_optimizer(optimizer):
            if self.discriminator is not None:
                score = self.objective.generator_loss(self.discriminator(condition, fake))
                terms = {**terms, "adversarial": Term(score, self.adversarial_weight)}
            optimizer.zero_grad()
            self.manual_backward(torch.stack([term.weight * term.value for term in terms.values()]).sum())
            optimizer.step()
        self.log_dict({f"train/{name}": term.value.detach() for name, term in terms.items()})
        first = next(iter(terms))
        self.log(first, terms[first].value.detach(), prog_bar=True, logger=False)

    def on_before_optimizer_step(self, optimizer: Optimizer) -> None:
        """Clip the generator's gradient: here that of mixed precision is no longer scaled."""
        if self.gradient_clip is not None and optimizer is self.trainer.optimizers[0]:
            nn.utils.clip_grad_norm_(self.generator.parameters(), self.gradient_clip)

    def on_validation_start(self) -> None:
        """Average the statistics of batch norm over the processes, so that all measure the same network."""
        self._average_statistics()

    def _average_statistics(self) -> None:
        if self.trainer.world_size > 1:
            strategy = self.trainer.strategy
            average_statistics(self, lambda buffer: cast(Tensor, strategy.reduce(buffer, reduce_op="mean")))

    def on_train_epoch_end(self) -> None:
        """Step the learning rates: Lightning leaves that to manual optimisation."""
        self._average_statistics()  # for the checkpoint, should there be no validation
        schedulers = self.lr_schedulers()
        for scheduler in schedulers if isinstance(schedulers, list) else [schedulers]:
            if scheduler is not None:
                scheduler.step()

    def configure_optimizers(self) -> tuple[list[Optimizer], list[LRScheduler]]:
        """Return the optimisers of the generator and of the discriminator, in this order."""
        optimizers = [self.generator_optimizer(self.generator.parameters())]
        if self.discriminator is not None:
            optimizers.append(self.discriminator_optimizer(self.discriminator.parameters()))
        return optimizers, [self.lr_scheduler(o) for o in optimizers] if self.lr_scheduler else []

    def _optimizers(self) -> list[LightningOptimizer]:
        optimizers = self.optimizers()
        return cast(list[LightningOptimizer], optimizers if isinstance(optimizers, list) else [optimizers])

    # --- measuring and predicting ---------------------------------------------------------------------

    def validation_step(self, batch: Batch, batch_idx: int) -> None:
        """Measure with the sampler's hints, the same ones every epoch, and with none."""
        target, mask = batch["normal"], batch["mask"]
        hints = self.measured_hints(batch)
        self.val_metrics.update("hints", self._paint(batch, hints), target, mask)
        self.val_metrics.update("no_hints", self._paint(batch, None), target, mask)

    def on_validation_epoch_end(self) -> None:
        """Log the metrics of the validation split."""
        self._log_figures(self.val_metrics.pop())

    def test_step(self, batch: Batch, batch_idx: int) -> None:
        """Measure with the sampler's hints, also without the hinted pixels, and with no hints."""
        target, mask = batch["normal"], batch["mask"]
        hints = self.measured_hints(batch)
        preds = self._paint(batch, hints)
        self.test_metrics.update("hints", preds, target, mask)
        self.test_metrics.update("unhinted", preds, target, without_hints(mask, hints[:, 3:]))
        self.test_metrics.update("no_hints", self._paint(batch, None), target, mask)

    def on_test_epoch_end(self) -> None:
        """Log the metrics of the test split."""
        self._log_figures(self.test_metrics.pop())

    def _log_figures(self, figures: dict[str, Tensor]) -> None:
        # They are over all processes already; sync_dist averages equal numbers, and keeps Lightning quiet.
        self.log_dict(figures, sync_dist=True)

    def predict_step(self, batch: Sketches, batch_idx: int) -> Tensor:
        """Return painted normals (N, 3, H, W), with the user's hints if there are any."""
        return self._paint(batch, batch.get("hints"))

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
