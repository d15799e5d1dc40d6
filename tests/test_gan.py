import csv
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import torch
import yaml
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.callbacks import GradientAccumulationScheduler, StochasticWeightAveraging
from lightning.pytorch.loggers import CSVLogger
from torch import Tensor, nn
from torch.optim import Adam, RMSprop
from torch.optim.lr_scheduler import ExponentialLR
from torchmetrics import Metric

from normalgan.errors import InputError
from normalgan.gan import NormalGAN
from normalgan.hints import NoHints, UniformHints, WorstErrorHints
from normalgan.losses import (
    AngularLikelihood,
    CrossEntropy,
    L1AndHints,
    Wasserstein,
    WassersteinGradientPenalty,
)
from normalgan.losses.distractor_consistency import add_distractor_strokes, distractor_inconsistency
from normalgan.metrics import angular_error
from normalgan.models import (
    Discriminator,
    Generator,
    PatchDiscriminator,
    ResidualUNetGenerator,
    UNetDiscriminator,
    UNetGenerator,
)
from normalgan.models.condition import make_condition, paste_hints
from normalgan.weights.checkpoint import Checkpoint, read_checkpoint
from small import gan as make
from small import trainer
from spheres import batch, loader

# What Lightning says of settings that are meant: no workers for eight spheres, few batches.
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*does not have many workers.*",
    "ignore:.*have no `val_dataloader`.*",
    "ignore:.*smaller than the logging interval.*",
    "ignore:.*removed from hparams because it cannot be pickled.*",  # tests hand in local classes and lambdas
    "ignore:.*LeafSpec.*is deprecated.*",
)


class Steps(Callback):
    """Notes what each batch changed."""

    def __init__(self) -> None:
        self.generator: list[bool] = []
        self.discriminator: list[bool] = []
        self._before: dict[str, Tensor] = {}

    def on_train_batch_start(self, trainer: Trainer, pl_module: LightningModule, *_: object) -> None:
        self._before = {name: p.detach().clone() for name, p in pl_module.named_parameters()}

    def on_train_batch_end(self, trainer: Trainer, pl_module: LightningModule, *_: object) -> None:
        for network in ("generator", "discriminator"):
            changed = any(
                not torch.equal(p, self._before[name])
                for name, p in pl_module.named_parameters()
                if name.startswith(network)
            )
            getattr(self, network).append(changed)


def weights(module: nn.Module) -> dict[str, Tensor]:
    return {name: value.clone() for name, value in module.state_dict().items()}


def same(a: dict[str, Tensor], b: dict[str, Tensor]) -> bool:
    return all(torch.equal(a[name], b[name]) for name in a)


def test_n_critic_counts_through_epochs(tmp_path: Path) -> None:
    # Four batches an epoch and every third generates: counted by batch_idx it would start anew each epoch.
    steps = Steps()
    trainer(tmp_path, max_epochs=3, callbacks=[steps]).fit(make(n_critic=3), loader())
    assert steps.discriminator == [True] * 12
    assert steps.generator == [True, False, False] * 4


def test_a_fast_dev_run_tries_both_networks(tmp_path: Path) -> None:
    steps = Steps()
    trainer(tmp_path, fast_dev_run=True, callbacks=[steps]).fit(make(n_critic=5), loader())
    assert (steps.discriminator, steps.generator) == ([True], [True])


def test_hints_are_painted_into_the_sketch_and_marked() -> None:
    sketch = torch.zeros(1, 1, 4, 4)
    sketch[0, 0, 0] = 1
    hints = torch.zeros(1, 4, 4, 4)
    hints[0, :, 2, 3] = torch.tensor([0.6, 0.0, 0.8, 1.0])
    condition = make_condition(sketch, hints)
    assert condition[0, :, 0, 0].tolist() == [-1, -1, -1, 0]  # ink is black
    assert condition[0, :, 1, 1].tolist() == [1, 1, 1, 0]  # paper is white
    torch.testing.assert_close(condition[0, :, 2, 3], torch.tensor([0.6, 0.0, 0.8, 1.0]))


def test_truth_is_pasted_at_the_hints_alone() -> None:
    preds, hints = torch.full((1, 3, 4, 4), 0.5), torch.zeros(1, 4, 4, 4)
    hints[0, :, 2, 3] = torch.tensor([0.6, 0.0, 0.8, 1.0])
    pasted = paste_hints(preds, hints)
    torch.testing.assert_close(pasted[0, :, 2, 3], torch.tensor([0.6, 0.0, 0.8]))
    assert (pasted != preds).any(1).sum() == 1


def test_the_discriminator_sees_the_truth_at_the_hints(tmp_path: Path) -> None:
    seen: list[tuple[Tensor, Tensor]] = []

    class Watched(UNetDiscriminator):
        def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
            seen.append((condition.detach(), normal.detach()))
            return super().forward(condition, normal)

    trainer(tmp_path, max_steps=1, limit_train_batches=1).fit(
        make(discriminator=Watched(size=32, width=4)), loader()
    )
    assert len(seen) == 3  # true, painted, and painted again for the generator: never mixed in one batch
    truth = batch()["normal"]
    condition, _ = seen[0]
    hinted = condition[:, 3:].expand(-1, 3, -1, -1) > 0
    assert hinted.sum() == 2 * 3 * 3
    assert torch.equal(seen[0][1], truth)
    for _, fake in seen[1:]:
        assert torch.equal(fake[hinted], truth[hinted])
        assert not torch.equal(fake, truth)


def test_the_generators_loss_leaves_no_gradient_on_the_discriminator(tmp_path: Path) -> None:
    gradients = []
    for adversarial_weight in (0.0, 1000.0):
        gan = make(adversarial_weight=adversarial_weight)
        trainer(tmp_path, limit_train_batches=1).fit(gan, loader())
        assert gan.discriminator is not None
        gradients.append([p.grad for p in gan.discriminator.parameters()])
    for without, strong in zip(*gradients, strict=True):
        assert without is not None
        assert torch.equal(without, strong)


def test_clipping_holds_after_training(tmp_path: Path) -> None:
    gan = make(objective=Wasserstein(weight_clip=0.02))
    trainer(tmp_path).fit(gan, loader())
    assert gan.discriminator is not None
    assert max(float(p.detach().abs().max()) for p in gan.discriminator.parameters()) <= 0.02


@pytest.mark.parametrize(
    "settings",
    [
        {
            "objective": WassersteinGradientPenalty(),
            "discriminator": UNetDiscriminator(size=32, width=4, norm="none"),
        },
        {
            "objective": CrossEntropy(),
            "discriminator": PatchDiscriminator(width=4, layers=2),
            "hint_sampler": NoHints(),
        },
        {"discriminator": UNetDiscriminator(size=32, width=4, encoder_head=True)},
        {"discriminator": None},
        {"distractor_consistency": 1.0},
        {
            "generator": ResidualUNetGenerator((8, 8), (1, 1)),
            "discriminator": None,
            "reconstruction": AngularLikelihood(),
            "gradient_clip": 1.0,
        },
    ],
    ids=["penalty", "pix2pix", "two heads", "no discriminator", "steady", "ours"],
)
def test_every_objective_trains(tmp_path: Path, settings: dict[str, Any]) -> None:
    gan = make(**settings)
    before = weights(gan.generator)
    trainer(tmp_path).fit(gan, loader())
    assert not same(before, weights(gan.generator))
    assert all(value.isfinite().all() for value in gan.state_dict().values())


def test_training_lowers_the_error(tmp_path: Path) -> None:
    gan = make(
        generator=UNetGenerator(size=32, width=8),
        generator_optimizer=lambda parameters: Adam(parameters, lr=4e-3),
        reconstruction=L1AndHints(l1_weight=100.0),
    )
    run = trainer(tmp_path, max_epochs=12, check_val_every_n_epoch=12)
    before = run.validate(gan, loader(), verbose=False)[0]["val/no_hints/angular_mean"]
    run.fit(gan, loader())
    after = run.validate(gan, loader(), verbose=False)[0]["val/no_hints/angular_mean"]
    assert before > 60
    assert after < 25


@pytest.mark.slow  # trains twice
def test_steadiness_holds_the_map_against_strokes_that_say_nothing(tmp_path: Path) -> None:
    """Two runs of the same network, seed and batches."""
    unseen = batch(64)
    turned: list[float] = []
    for name, weight in (("without", 0.0), ("with", 10.0)):
        torch.manual_seed(0)
        model = make(
            generator=ResidualUNetGenerator((8, 12, 16), (1, 1, 1), 2),
            discriminator=None,
            reconstruction=AngularLikelihood(angle_weight=3.0),
            generator_optimizer=partial(Adam, lr=3e-3),
            distractor_consistency=weight,
        )
        trainer(tmp_path / name, max_epochs=20).fit(model, loader(16, 32, 8))
        model.eval()
        torch.manual_seed(1)
        with torch.no_grad():
            marked = add_distractor_strokes(unseen["sketch"], unseen["mask"], 1.0)
            plain, other = (
                model.generator.predict(make_condition(s, s.new_zeros(len(s), 4, 32, 32))).direction
                for s in (unseen["sketch"], marked)
            )
            turned.append(float(distractor_inconsistency(plain, other, unseen["mask"])))
    assert turned[1] < 0.8 * turned[0]


def test_a_run_resumed_ends_in_the_same_weights_to_the_bit(tmp_path: Path) -> None:
    def optimizer(parameters: Any) -> RMSprop:
        return RMSprop(parameters, lr=1e-3)

    def schedule(given: Any) -> ExponentialLR:
        return ExponentialLR(given, 0.5)

    settings = {"generator_optimizer": optimizer, "n_critic": 3, "lr_scheduler": schedule}
    unbroken = make(**settings)
    trainer(tmp_path, max_epochs=4).fit(unbroken, loader())
    first = make(**settings)
    run = trainer(tmp_path, max_epochs=2)
    run.fit(first, loader())
    run.save_checkpoint(tmp_path / "two.ckpt")
    torch.manual_seed(12345)  # global state is not in a checkpoint, and must not matter
    resumed = make(**settings)
    torch.manual_seed(54321)
    trainer(tmp_path, max_epochs=4).fit(
        resumed, loader(), ckpt_path=tmp_path / "two.ckpt", weights_only=False
    )
    assert not same(weights(first), weights(unbroken))
    assert same(weights(resumed), weights(unbroken))


def test_learning_rates_follow_the_schedule(tmp_path: Path) -> None:
    gan = make(lr_scheduler=lambda optimizer: ExponentialLR(optimizer, 0.1))
    run = trainer(tmp_path, max_epochs=2)
    run.fit(gan, loader())
    assert [o.param_groups[0]["lr"] for o in run.optimizers] == pytest.approx([5e-7, 5e-7])


def test_validation_hints_are_the_same_every_time(tmp_path: Path) -> None:
    gan = make()
    run = trainer(tmp_path)
    first, again = (run.validate(gan, loader(), verbose=False)[0] for _ in range(2))
    assert first == again


def test_validation_measures_where_the_object_is(tmp_path: Path) -> None:
    # The error of directions alone does not show a network that predicts only background.
    gan = make()
    with torch.no_grad():
        for parameter in gan.generator.parameters():
            parameter.zero_()
    (figures,) = trainer(tmp_path).validate(gan, loader(), verbose=False)
    assert figures["val/hints/mask_iou"] == figures["val/no_hints/coverage"] == 0


def test_hints_of_the_batch_are_not_asked_for_again() -> None:
    gan = make(hint_sampler=NoHints())
    given = batch()
    given["hints"] = torch.ones(2, 4, 32, 32)
    assert gan.training_hints(given, 0) is given["hints"]


def test_hinted_pixels_can_be_left_out_of_the_figures(tmp_path: Path) -> None:
    class Cheat(UNetGenerator):
        """Paints the hints and nothing else."""

        def forward(self, condition: Tensor) -> Tensor:
            return condition[:, :3] * condition[:, 3:] + 0 * super().forward(condition)

    gan = make(generator=Cheat(size=32, width=4), hint_sampler=UniformHints(50, 50))
    result = trainer(tmp_path).test(gan, loader(), verbose=False)[0]
    assert result["test/hints/below_5"] > 0.05
    assert result["test/off_hints/below_5"] == 0
    assert result["test/no_hints/below_5"] == 0


def test_noise_at_test_is_off_unless_asked(tmp_path: Path) -> None:
    def predict(gan: NormalGAN) -> Tensor:
        run = trainer(tmp_path)
        pages = run.predict(gan, loader())
        assert pages is not None
        return torch.cat([page for page in pages if isinstance(page, Tensor)])

    def builder(noise: bool) -> NormalGAN:
        return make(generator=UNetGenerator(size=64, width=4), noise_at_test=noise)

    large: Callable[..., Any] = lambda: loader(size=64)  # noqa: E731  # wide enough for dropout layers
    for noise in (False, True):
        gan = builder(noise)
        run = trainer(tmp_path)
        first, again = (run.predict(gan, large()) for _ in range(2))
        assert first is not None
        assert again is not None
        assert torch.equal(first[0], again[0]) is not noise  # type: ignore[arg-type]


def test_bf16_trains_and_measures_in_full_precision(tmp_path: Path) -> None:
    gan = make()
    trainer(tmp_path, precision="bf16-mixed", limit_val_batches=1).fit(gan, loader(), loader())
    assert all(p.dtype == torch.float32 for p in gan.parameters())


@pytest.mark.parametrize("precision", ["16-true", "bf16-true", "64-true"])
def test_a_precision_that_converts_the_weights_is_one_sentence(tmp_path: Path, precision: Any) -> None:
    for measure in ("validate", "test", "predict"):
        with pytest.raises(
            InputError, match=rf"precision is {precision}.* use 32-true, 16-mixed or bf16-mixed"
        ):
            getattr(trainer(tmp_path, precision=precision), measure)(make(), loader())
    with pytest.raises(InputError, match=f"precision is {precision}"):
        trainer(tmp_path, precision=precision).fit(make(), loader(), loader())


def test_accumulating_gradients_by_a_callback_is_refused_in_a_whole_sentence(tmp_path: Path) -> None:
    run = trainer(tmp_path, callbacks=[GradientAccumulationScheduler({0: 2})])
    with pytest.raises(
        InputError, match=r"Scheduler cannot be used, .* by hand; use a larger data\.batch_size"
    ):
        run.fit(make(), loader())


def test_the_average_of_lightning_is_refused_as_its_last_epoch_would_train(tmp_path: Path) -> None:
    run = trainer(tmp_path, max_epochs=2, callbacks=[StochasticWeightAveraging(1e-3)])
    with pytest.raises(InputError, match=r"StochasticWeightAveraging cannot be used, .*; use WarmAverage\.$"):
        run.fit(make(discriminator=None), loader())
    assert run.global_step == 0


def dropping(dropout: nn.Module) -> Generator:
    """Return a convolution and a dropout of some kind, in three and four dimensions."""

    class Dropping(Generator):
        def __init__(self) -> None:
            super().__init__()
            self.body = nn.Conv2d(4, 8, 1)
            self.dropout = dropout
            self.head = nn.Conv2d(8, 3, 1)

        def forward(self, condition: Tensor) -> Tensor:
            features: Tensor = self.body(condition)
            if isinstance(self.dropout, nn.Dropout1d):
                noisy = self.dropout(features.flatten(2)).view_as(features)
            elif isinstance(self.dropout, nn.Dropout3d):
                noisy = self.dropout(features[..., None])[..., 0]
            else:
                noisy = self.dropout(features)
            return torch.tanh(self.head(noisy))

    return Dropping()


@pytest.mark.parametrize(
    "kind", [nn.Dropout, nn.Dropout1d, nn.Dropout2d, nn.Dropout3d, nn.AlphaDropout, nn.FeatureAlphaDropout]
)
def test_noise_at_test_keeps_every_kind_of_dropout_on(kind: Callable[[float], nn.Module]) -> None:
    for noise in (False, True):
        gan = make(generator=dropping(kind(0.5)), noise_at_test=noise)
        gan.eval()
        gan.keep_noise()
        sketch = torch.rand(2, 1, 32, 32)
        with torch.no_grad():
            assert torch.equal(gan(sketch), gan(sketch)) is not noise


def test_an_objective_that_the_discriminator_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="without batch norm"):
        make(objective=WassersteinGradientPenalty())


class Mean(Discriminator):
    """Scores a map by the mean of its numbers, times a weight."""

    def __init__(self) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.ones(()))

    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        return (self.weight * normal.mean((1, 2, 3)),)


@pytest.mark.parametrize("weight", [1.0, 100.0])
def test_the_share_of_the_adversarial_gradient_is_that_of_the_formula(tmp_path: Path, weight: float) -> None:
    """Of a mean and of L1 the gradients are the same number at every pixel, here 0.01 and 500 a count."""
    gan = make(
        discriminator=Mean(),
        hint_sampler=NoHints(),
        objective=Wasserstein(weight_clip=0.01),
        reconstruction=L1AndHints(500.0, 0.0),
        adversarial_weight=weight,
        share_every=1,
    )
    run = trainer(tmp_path, max_steps=2)
    run.fit(gan, loader())
    share = run.callback_metrics["train/adversarial_share_output"]
    assert float(share) == pytest.approx(weight * 0.01 / 500, rel=1e-4)
    assert 0 < float(run.callback_metrics["train/adversarial_share"]) < 0.1


def test_two_loaders_are_measured_as_one_set(tmp_path: Path) -> None:
    gan = make()
    (one,) = trainer(tmp_path).test(gan, loader(), verbose=False)
    (both, _) = trainer(tmp_path).test(gan, [loader(), loader()], verbose=False)
    angle = next(name for name in one if name.startswith("test/no_hints") or "angle" in name)
    assert both[angle] == pytest.approx(one[angle], rel=1e-4)


def test_a_share_that_is_logged_changes_nothing(tmp_path: Path) -> None:
    logged, plain = make(share_every=2), make()
    for gan in (logged, plain):
        trainer(tmp_path).fit(gan, loader())
    assert same(weights(logged), weights(plain))


def test_the_worst_places_are_those_of_the_generator_and_looking_changes_nothing() -> None:
    gan = make(generator=UNetGenerator(size=64, width=4), hint_sampler=WorstErrorHints(4), noise_at_test=True)
    given, before = batch(size=64), weights(gan)
    gan.train()
    modes = {name: module.training for name, module in gan.named_modules()}
    for name, module in gan.generator.named_modules():  # as noise at test leaves them
        module.train("drop" in name.lower() or isinstance(module, nn.Dropout))
        modes[f"generator.{name}".rstrip(".")] = module.training
    hints = gan.training_hints(given, 0)
    assert {name: module.training for name, module in gan.named_modules()} == modes
    assert same(weights(gan), before)  # statistics of norms too
    gan.eval()
    error = angular_error(gan(given["sketch"]), given["normal"])
    wanted = WorstErrorHints(4).sample_by_error(error, given["mask"], torch.Generator())
    assert torch.equal(hints[:, 3:], wanted)
    assert torch.equal(gan.measured_hints(given)[:, 3:], wanted)


def test_a_share_of_the_batch_gets_pins_and_predicting_them_changes_nothing() -> None:
    gan = make(generator=UNetGenerator(size=64, width=4), hint_sampler=NoHints(), pinned=0.5)
    given, before = batch(size=64), weights(gan)
    gan.train()
    counts = torch.stack([gan.training_hints(given, seed)[:, 3].flatten(1).sum(1) for seed in range(12)])
    assert (counts[:, 0] == 0).all()
    assert set(counts[:, 1].tolist()) == {0, 1, 2, 3}
    assert same(weights(gan), before)  # statistics of norms too
    assert all(module.training for module in gan.modules())


def saved(folder: Path, **settings: Any) -> Checkpoint:
    """Return what is in a checkpoint of a model that was made in Python, read without running anything."""
    model = make(**settings)
    content: dict[str, Any] = {"state_dict": model.state_dict(), "pytorch-lightning_version": "2.6.0"}
    model.on_save_checkpoint(content)
    torch.save(content, folder / "python.ckpt")
    return read_checkpoint(folder / "python.ckpt")


def test_a_checkpoint_made_in_python_names_what_it_is_made_of(tmp_path: Path) -> None:
    checkpoint = saved(
        tmp_path,
        generator_optimizer=partial(torch.optim.RAdam, lr=1e-3, betas=(0.9, 0.98)),
        discriminator_optimizer=torch.optim.SGD,
        lr_scheduler=partial(torch.optim.lr_scheduler.StepLR, step_size=2),
    )
    settings = checkpoint.training_settings()
    expected = {
        "size": 32,
        "width": 4,
        "depth": None,
        "kernel": 4,
        "norm": "batch",
        "bias": False,
        "dropout": 0.5,
    }
    assert settings["generator"]["init_args"].items() >= expected.items()
    assert settings["hint_sampler"]["init_args"].items() >= {"minimum": 3, "maximum": 3}.items()
    assert settings["generator_optimizer"] == {
        "class_path": "torch.optim.radam.RAdam",
        "init_args": {"lr": 1e-3, "betas": [0.9, 0.98]},
    }
    assert settings["discriminator_optimizer"]["class_path"] == "torch.optim.sgd.SGD"
    assert settings["lr_scheduler"]["init_args"] == {"step_size": 2}
    predicted = checkpoint.weights(32).generator().state_dict()
    assert all(torch.equal(tensor, predicted[name]) for name, tensor in make().generator.state_dict().items())
    again = NormalGAN.load_from_checkpoint(checkpoint.path, weights_only=True)
    assert again.hint_sampler == make().hint_sampler


def test_what_no_file_can_say_is_left_to_python(tmp_path: Path) -> None:
    checkpoint = saved(tmp_path, generator_optimizer=lambda parameters: torch.optim.SGD(parameters, lr=1.0))
    assert checkpoint.weights(32).generator()  # painting needs no optimiser
    with pytest.raises(InputError, match=r"its generator_optimizer, .*lambda.*, was made in Python of more"):
        checkpoint.training_settings()


def test_what_lightning_drops_from_the_settings_is_in_the_checkpoint(tmp_path: Path) -> None:
    """A run drops what cannot be pickled; going on with RMSprop's default ended in Adam's KeyError."""
    run = trainer(tmp_path, limit_train_batches=1, limit_val_batches=0)
    run.fit(make(generator_optimizer=lambda parameters: Adam(parameters, lr=1e-3)), loader())
    run.save_checkpoint(tmp_path / "trained.ckpt")
    checkpoint = read_checkpoint(tmp_path / "trained.ckpt")
    with pytest.raises(
        InputError, match=r"its generator_optimizer, 'test_gan\..*, was made in Python of more"
    ):
        checkpoint.training_settings()


def test_losses_are_read_while_backward_is_at_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A GPU that is asked for a value before it is given more work stands still."""
    gan = make()
    assert gan.discriminator is not None
    networks = [gan.discriminator, gan.generator]
    reads: list[bool] = []

    def watched(values: Tensor) -> Callable[[], list[float]]:
        network = networks[len(reads) % 2]
        network.zero_grad()

        def read() -> list[float]:
            reads.append(all(p.grad is not None for p in network.parameters()))
            return list(values.tolist())

        return read

    monkeypatch.setattr("normalgan.losses.finite.async_to_cpu", watched)
    trainer(tmp_path).fit(gan, loader())
    assert reads == [True] * 8  # four batches, a step of each network


def test_figures_of_training_are_logged_from_the_cpu(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """To log one that is on a GPU would wait for it."""
    logged: dict[str, Any] = {}
    gan = make()
    monkeypatch.setattr(gan, "log", lambda name, value, **more: logged.update({name: value}))
    monkeypatch.setattr(gan, "log_dict", lambda values, **more: logged.update(values))
    monkeypatch.setattr("normalgan.losses.finite.async_to_cpu", lambda values: lambda: [7.0] * len(values))
    trainer(tmp_path, limit_train_batches=1).fit(gan, loader())
    assert {"train/discriminator", "train/l1", "train/adversarial", "l1"} <= logged.keys()
    assert {float(value) for value in logged.values()} == {7.0}  # what was read, not what is on the device


@pytest.mark.parametrize("n_critic", [1, 3])
def test_losses_are_logged_when_a_logger_takes_them_and_are_of_the_last_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, n_critic: int
) -> None:
    gan, shown = make(n_critic=n_critic), set()
    log = gan.log

    def numbered(values: Tensor) -> Callable[[], list[float]]:
        return lambda: [float(gan.trainer.fit_loop.total_batch_idx)] * len(values)

    def counted(name: str, *args: Any, **kwargs: Any) -> None:
        shown.add(gan.trainer.fit_loop.total_batch_idx)
        log(name, *args, **kwargs)

    monkeypatch.setattr("normalgan.losses.finite.async_to_cpu", numbered)
    monkeypatch.setattr(gan, "log", counted)
    logger = CSVLogger(tmp_path)
    trainer(tmp_path, logger=logger, log_every_n_steps=5, limit_val_batches=0).fit(gan, loader(24))
    with (Path(logger.log_dir) / "metrics.csv").open(newline="") as table:
        rows = [row for row in csv.DictReader(table) if row.get("train/l1")]
    assert [int(row["step"]) for row in rows] == [4, 9]
    assert [float(row["train/discriminator"]) for row in rows] == [4, 9]
    assert [float(row["train/l1"]) for row in rows] == [4 - 4 % n_critic, 9 - 9 % n_critic]
    assert len(shown) < 6  # of twelve batches


def test_metrics_are_made_when_their_stage_begins(tmp_path: Path) -> None:
    def measured(gan: NormalGAN) -> set[str]:
        return {name.partition(".")[0] for name, part in gan.named_modules() if isinstance(part, Metric)}

    gan = make()
    assert measured(gan) == set()  # they take longer to make than the networks
    trainer(tmp_path).validate(gan, loader(), verbose=False)
    assert measured(gan) == {"val_metrics"}


def test_loggers_write_down_classes_and_settings_not_weights(tmp_path: Path) -> None:
    logger = CSVLogger(tmp_path)
    trainer(tmp_path, logger=logger, limit_train_batches=1, limit_val_batches=0).fit(make(), loader())
    settings = yaml.safe_load((Path(logger.log_dir) / "hparams.yaml").read_text())
    assert settings["generator"]["class_path"] == "normalgan.models.unet.UNetGenerator"
    assert settings["generator"]["init_args"]["width"] == 4
    assert settings["n_critic"] == 1


def test_the_progress_bar_has_losses_from_the_first_batch_on(tmp_path: Path) -> None:
    run = trainer(tmp_path, log_every_n_steps=50, max_epochs=1)
    run.fit(make(), loader())
    assert {"train/discriminator", "l1"} <= run.progress_bar_metrics.keys()
